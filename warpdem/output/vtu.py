"""Unstructured grids as VTU files, by VTK's own writer: appended raw binary, compressed.

Importing this module loads VTK, which takes a third of a second: import it where a frame is
written.
"""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING, Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkCommand, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (
    VTK_POLY_LINE,
    VTK_POLYGON,
    VTK_VERTEX,
    vtkCellArray,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkFieldData

END = b"</VTKFile>\n"
"""The last bytes of a whole file."""

OUT_OF_DISK_SPACE = 20007
"""VTK's own error code, which it does not name in Python."""


def polygons(
    points: NDArray[np.floating],
    connectivity: NDArray[np.int32],
    offsets: NDArray[np.int32],
    cell_data: Mapping[str, NDArray[Any]],
    point_data: Mapping[str, NDArray[Any]] | None = None,
) -> vtkUnstructuredGrid:
    """Grid of polygons.

    Args:
        points: Corners [m], shape [point_count, 3].
        connectivity: Corners of all polygons, one polygon after the other.
        offsets: Where each polygon starts in ``connectivity`` and the last one ends,
            shape [polygon_count + 1].
        cell_data: Arrays by name, shape [polygon_count] or [polygon_count, component_count].
        point_data: Arrays by name, a row a corner.
    """
    grid = _grid(points, VTK_POLYGON, connectivity, offsets)
    _attach(grid.GetCellData(), cell_data)
    _attach(grid.GetPointData(), point_data or {})
    return grid


def polylines(
    points: NDArray[np.floating],
    offsets: NDArray[np.int32],
    point_data: Mapping[str, NDArray[Any]],
    cell_data: Mapping[str, NDArray[Any]],
) -> vtkUnstructuredGrid:
    """Grid of lines, each through the points that follow those of the line before.

    Args:
        points: [m], shape [point_count, 3].
        offsets: Where each line starts in ``points`` and the last one ends, shape
            [line_count + 1].
        point_data: Arrays by name, a row a point.
        cell_data: Arrays by name, a row a line.
    """
    grid = _grid(points, VTK_POLY_LINE, np.arange(len(points), dtype=np.int32), offsets)
    _attach(grid.GetPointData(), point_data)
    _attach(grid.GetCellData(), cell_data)
    return grid


def note(grid: vtkUnstructuredGrid, name: str, values: NDArray[Any] | Sequence[str]) -> None:
    """Give a grid values that belong to the whole of it: numbers, or words."""
    if isinstance(values, np.ndarray):
        _attach(grid.GetFieldData(), {name: values})
        return
    words = vtkStringArray()
    words.SetName(name)
    for word in values:
        words.InsertNextValue(word)
    grid.GetFieldData().AddArray(words)


def vertices(
    points: NDArray[np.floating], point_data: Mapping[str, NDArray[Any]]
) -> vtkUnstructuredGrid:
    """Grid of single points [m], shape [point_count, 3], with data by name for each."""
    numbers = np.arange(len(points) + 1, dtype=np.int32)
    grid = _grid(points, VTK_VERTEX, numbers[:-1], numbers)
    _attach(grid.GetPointData(), point_data)
    return grid


def write(path: Path, grid: vtkUnstructuredGrid, compression: str) -> None:
    """Write a grid.

    Args:
        path: File to write.
        grid: Points, cells and data.
        compression: ``lz4`` (fast), ``zlib`` (.6 of the size in 6 times the time, and read by
            meshio too) or ``none``.

    Raises:
        OSError: VTK could not write all of it; the disk is full, most likely.
    """
    writer = vtkXMLUnstructuredGridWriter()
    # VTK prints its own account of a fault where nobody observes it.
    for source in (writer, writer.GetExecutive()):
        source.AddObserver(vtkCommand.ErrorEvent, lambda *_: None)
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    _compress(writer, compression)
    if writer.Write() != 1 or not _is_whole(path):
        cause = _cause(writer.GetErrorCode())
        raise OSError(cause, os.strerror(cause), str(path))


def _compress(writer: vtkXMLUnstructuredGridWriter, compression: str) -> None:
    if compression == "none":
        writer.SetCompressorTypeToNone()
        return
    if compression == "lz4":
        writer.SetCompressorTypeToLZ4()
    else:
        writer.SetCompressorTypeToZLib()
    writer.SetCompressionLevel(1)


def _cause(code: int) -> int:
    """The system's error number for VTK's, which is the same, or one of its own, or 0."""
    if code == OUT_OF_DISK_SPACE:
        return errno.ENOSPC
    return code if code in errno.errorcode else errno.EIO


def _is_whole(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            file.seek(-len(END), os.SEEK_END)
            return file.read() == END
    except OSError:
        return False


def _grid(
    points: NDArray[np.floating],
    kind: int,
    connectivity: NDArray[np.int32],
    offsets: NDArray[np.int32],
) -> vtkUnstructuredGrid:
    corners = vtkPoints()
    corners.SetData(numpy_to_vtk(points))
    cells = vtkCellArray()
    cells.SetData(numpy_to_vtk(offsets), numpy_to_vtk(connectivity))
    grid = vtkUnstructuredGrid()
    grid.SetPoints(corners)
    grid.SetCells(kind, cells)
    return grid


def _attach(attributes: vtkFieldData, data: Mapping[str, NDArray[Any]]) -> None:
    for name, values in data.items():
        array = numpy_to_vtk(np.ascontiguousarray(values))
        array.SetName(name)
        attributes.AddArray(array)
