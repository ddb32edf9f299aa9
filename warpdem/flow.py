"""Grids of fluid velocities, from VTK image data or NumPy archives."""

from __future__ import annotations

import logging
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.errors import SceneError, WarpdemError
from warpdem.input.decode import problem_at
from warpdem.input.scene_force import Fluid

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from warpdem.arrays import FloatArray
    from warpdem.input.scene import Scene

_KEYS = ("velocity", "origin", "spacing")
_HEAD = 1000  # bytes within which a .vti says what it is


class FlowError(WarpdemError):
    """A file is no grid of velocities; the message names it and the cause."""


@dataclass(frozen=True)
class Flow:
    """Velocities of a fluid at the nodes of a regular grid along the world's axes.

    Attributes:
        velocity: [m/s], shape [nx, ny, nz, 3].
        origin: Position of the first node [m], shape [3].
        spacing: Distances between nodes [m], shape [3].
    """

    velocity: FloatArray
    origin: FloatArray
    spacing: FloatArray


def flow_of(scene: Scene) -> Flow | None:
    """The fluid of a scene; None where it has none.

    Raises:
        SceneError: Its file cannot be used.
    """
    for index, force in enumerate(scene.force):
        if isinstance(force, Fluid):
            try:
                return read_flow(scene.directory / force.file, force.array)
            except FlowError as error:
                problem = problem_at(scene, ("force", index, "file"), str(error), force.file)
                raise SceneError(str(scene.source or "scene"), [problem]) from None
    return None


def read_flow(path: Path, array: str | None = None) -> Flow:
    """Read a grid of velocities; vectors at cells count as those of nodes at their centres.

    Args:
        path: A .vti, or a .npz with velocity, origin and spacing.
        array: Name of the vectors in a .vti; default: the only ones.

    Raises:
        FlowError: The file cannot be read, or holds no such grid.
    """
    if not path.is_file():
        raise FlowError(f"{path}: there is no such file")
    flow = _read_npz(path) if path.suffix.lower() == ".npz" else _read_vti(path, array)
    shape = flow.velocity.shape
    if len(shape) != 4 or shape[3] != 3 or 0 in shape:
        raise FlowError(f"{path}: velocity has the shape {[*shape]}, it must be [nx, ny, nz, 3]")
    for name, values in (("origin", flow.origin), ("spacing", flow.spacing)):
        if values.shape != (3,):
            raise FlowError(f"{path}: {name} must be three numbers")
    if not all(np.isfinite(values).all() for values in (flow.velocity, flow.origin, flow.spacing)):
        raise FlowError(f"{path}: holds numbers that are not finite")
    if not (flow.spacing > 0.0).all():
        raise FlowError(f"{path}: spacing must be positive, it is {flow.spacing.tolist()}")
    return flow


def _read_npz(path: Path) -> Flow:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            missing = [key for key in _KEYS if key not in archive]
            values = [np.asarray(archive[key], np.float64) for key in _KEYS if not missing]
    except Exception as error:  # noqa: BLE001 - a broken archive trips its reader anywhere
        raise FlowError(f"{path}: cannot be read as a NumPy archive: {error}") from None
    if missing:
        raise FlowError(f"{path}: lacks {', '.join(missing)}; it needs {', '.join(_KEYS)}")
    return Flow(*values)


@contextmanager
def _silent() -> Iterator[None]:
    """Nothing is said of a broken file but by an exception: VTK logs, warns and goes on."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        logging.disable(logging.CRITICAL)
        try:
            yield
        finally:
            logging.disable(logging.NOTSET)


def _read_vti(path: Path, array: str | None) -> Flow:
    import pyvista  # noqa: PLC0415 - loads VTK, which a scene without such a file need not

    with path.open("rb") as file:
        if b"ImageData" not in file.read(_HEAD):
            raise FlowError(f"{path}: is no VTK image data")
    try:
        with _silent(), pyvista.vtk_verbosity("off"):
            grid: Any = pyvista.read(path)
    except (OSError, ValueError, RuntimeError, Warning):
        raise FlowError(f"{path}: cannot be read as VTK image data") from None
    if not isinstance(grid, pyvista.ImageData) or grid.n_points == 0:
        raise FlowError(f"{path}: is no VTK image data")
    if not np.allclose(grid.direction_matrix, np.eye(3)):
        raise FlowError(f"{path}: its axes must be those of the world")
    found = {
        name: (np.asarray(data[name], np.float64), at_cells)
        for data, at_cells in ((grid.cell_data, True), (grid.point_data, False))
        for name in data.keys()  # noqa: SIM118 - not a mapping
        if data[name].ndim == 2 and data[name].shape[1] == 3
    }
    names = ", ".join(sorted(found)) or "none"
    if array is not None and array not in found:
        raise FlowError(f'{path}: holds no vectors "{array}"; there are: {names}')
    if array is None and len(found) != 1:
        rule = f"set array to one of: {names}" if found else "it needs one, at points or cells"
        raise FlowError(f"{path}: holds {len(found)} arrays of vectors; {rule}")
    values, at_cells = found[array or names]
    count = np.array(grid.dimensions)
    spacing = np.array(grid.spacing, np.float64)
    origin = np.array(grid.bounds, np.float64)[::2]
    if at_cells:
        thick = count > 1
        count = np.maximum(count - 1, 1)
        origin = origin + np.where(thick, 0.5 * spacing, 0.0)
    return Flow(values.reshape(*count[::-1], 3).transpose(2, 1, 0, 3), origin, spacing)
