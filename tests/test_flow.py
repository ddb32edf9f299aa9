"""Grids of fluid velocities, and what is said about those that cannot be used."""

import numpy as np
import pytest
import pyvista

from warpdem.checks.check import check
from warpdem.errors import SceneError
from warpdem.flow import FlowError, read_flow
from warpdem.input.decode import load, loads

SHAPE = (3, 4, 2)
VELOCITY = np.random.default_rng(0).normal(size=(*SHAPE, 3))
ORIGIN, SPACING = [1.0, -2.0, 0.5], [0.5, 0.25, 2.0]
SCENE = """
run = {duration = 1.0}
shape = [{name = "ball", kind = "sphere", radius = 0.1}]
body = [{shape = "ball", position = [0.0, 0.0, 0.0], density = 1e3}]
"""


def image(folder, *, cells=False, names=("velocity",), **options):
    """A .vti with the velocities at its points or at its cells."""
    nodes = np.array(SHAPE) + (1 if cells else 0)
    grid = pyvista.ImageData(
        dimensions=nodes, spacing=SPACING, origin=np.array(ORIGIN) - 0.5 * cells * np.array(SPACING)
    )
    data = grid.cell_data if cells else grid.point_data
    for name in names:
        data[name] = VELOCITY.transpose(2, 1, 0, 3).reshape(-1, 3)
    data["pressure"] = np.zeros(len(data[names[0]]))
    grid.save(folder / "wind.vti", **options)
    return folder / "wind.vti"


def archive(folder, **arrays):
    path = folder / "wind.npz"
    np.savez(path, **{"velocity": VELOCITY, "origin": ORIGIN, "spacing": SPACING, **arrays})
    return path


@pytest.mark.parametrize("cells", [False, True])
def test_image_data_gives_the_velocities_of_its_points_or_of_its_cells(tmp_path, cells):
    flow = read_flow(image(tmp_path, cells=cells))
    assert np.array_equal(flow.velocity, VELOCITY)
    assert flow.origin == pytest.approx(np.array(ORIGIN))
    assert flow.spacing.tolist() == SPACING


def test_one_of_several_arrays_is_chosen_by_name(tmp_path):
    path = image(tmp_path, names=("velocity", "vorticity"))
    with pytest.raises(FlowError, match="set array to one of: velocity, vorticity"):
        read_flow(path)
    assert np.array_equal(read_flow(path, "velocity").velocity, VELOCITY)
    with pytest.raises(FlowError, match='no vectors "wind"; there are: velocity, vorticity'):
        read_flow(path, "wind")


def test_an_archive_gives_what_was_saved(tmp_path):
    flow = read_flow(archive(tmp_path))
    assert np.array_equal(flow.velocity, VELOCITY)
    assert flow.origin.tolist() == ORIGIN
    assert flow.spacing.tolist() == SPACING


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"velocity": VELOCITY[..., :2]}, r"shape \[3, 4, 2, 2\], it must be \[nx, ny, nz, 3\]"),
        ({"velocity": VELOCITY[:0]}, "it must be"),
        ({"velocity": VELOCITY * np.nan}, "not finite"),
        ({"spacing": [1.0, 0.0, 1.0]}, "spacing must be positive"),
        ({"origin": [1.0, 0.0]}, "origin must be three numbers"),
        ({"velocity": np.array([None])}, "cannot be read"),
    ],
)
def test_archives_that_are_no_grid_are_refused(tmp_path, arrays, message):
    with pytest.raises(FlowError, match=message):
        read_flow(archive(tmp_path, **arrays))


def test_files_that_are_something_else_are_refused(tmp_path):
    np.savez(tmp_path / "bare.npz", velocity=VELOCITY)
    (tmp_path / "text.npz").write_text("wind")
    (tmp_path / "text.vti").write_text("wind")
    with pytest.raises(FlowError, match="lacks origin, spacing"):
        read_flow(tmp_path / "bare.npz")
    for name in ("text.npz", "text.vti"):
        with pytest.raises(FlowError, match=name):
            read_flow(tmp_path / name)


def test_a_scene_names_the_line_of_a_grid_that_cannot_be_used(tmp_path):
    archive(tmp_path, spacing=[1.0, -1.0, 1.0])
    (tmp_path / "a.toml").write_text(SCENE + '[[force]]\nkind = "fluid"\nfile = "wind.npz"\n')
    with pytest.raises(SceneError, match=r"a\.toml:7  force\[0\]\.file.*spacing must be positive"):
        check(load(tmp_path / "a.toml"))


@pytest.mark.parametrize(
    ("forces", "message"),
    [
        ('kind = "fluid"\nfile = "none.vti"', "there is no such file"),
        ('kind = "fluid"\nfile = "wind.csv"', r"must be a \.vti or \.npz file"),
        ('kind = "fluid"\nfile = "a.npz"\narray = "v"', r"only a \.vti has named arrays"),
        ('kind = "fluid"', "missing"),
        ('kind = "drag"\ncoefficient = 0.1\ncx = 1.0', "leave one of the two out"),
        ('kind = "drag"\ngroups = ["defualt"]', 'did you mean "default"'),
        ('kind = "numerical_damping"', "missing"),
        ('kind = "numerical_damping"\ncoefficient = 1.0', r"must lie in \(0, 1\)"),
        ('kind = "velocity_barrier"', "a barrier needs velocity or spin"),
        ('kind = "velocity_barrier"\nspin = 1.0\nvelocity_exponent = 2.0', "without velocity"),
        (
            'kind = "velocity_barrier"\nspin = 1\n[[force]]\nkind = "velocity_barrier"\nspin = 2',
            r"force\[0\] is of this kind already",
        ),
        ('kind = "wind"', "drag"),
    ],
)
def test_what_a_force_lacks_is_said(forces, message):
    with pytest.raises(SceneError, match=message):
        loads(f"{SCENE}[[force]]\n{forces}\n")
