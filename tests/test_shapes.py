"""Shapes of every kind, from a scene's keys and from files."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from solids import CUBE_CORNERS, CUBE_FACES, soup, split

from warpdem.errors import GeometryError
from warpdem.geometry.shapes import polyhedron_of
from warpdem.geometry.shp import read_shp
from warpdem.geometry.terrain import Raster, terrain
from warpdem.input.scene_shapes import (
    BoxShape,
    MeshShape,
    PolyhedronShape,
    ShpShape,
    SphereShape,
    TerrainShape,
)

SHARED = Path(__file__).resolve().parents[2] / "shared"
HERE = Path()
CUBE_SHP = """# a library
<
name cube
radius 0.1
preCompDone y
nv 8
-0.4 -0.4 -0.4
0.4 -0.4 -0.4
0.4 0.4 -0.4
-0.4 0.4 -0.4
-0.4 -0.4 0.4
0.4 -0.4 0.4
0.4 0.4 0.4
-0.4 0.4 0.4
ne 12
0 1
1 2
2 3
3 0
4 5
5 6
6 7
7 4
0 4
1 5
2 6
3 7
nf 6
4 0 1 2 3
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
obb.extent 0.5 0.5 0.5
obb.e1 1 0 0
obb.e2 0 1 0
obb.e3 0 0 1
obb.center 0 0 0
volume 0.98
I/m 0.16 0.16 0.16
>
<
name ball
radius 0.5
preCompDone n
nv 1
0 0 0
ne 0
nf 0
>
"""
HEIGHTS = """ncols 3
nrows 3
xllcorner 100.0
yllcorner 200.0
cellsize 2.0
NODATA_value -9999
1 1 1
1 2 1
1 1 -9999
"""


def box(size, rounding):
    return polyhedron_of(BoxShape(kind="box", name="b", size=size, rounding=rounding), HERE)


@pytest.mark.parametrize(
    ("size", "vertices", "edges", "faces"),
    [
        ((1.0, 2.0, 3.0), 8, 12, 6),
        ((1.0, 2.0, 0.2), 4, 4, 1),
        ((0.2, 2.0, 0.2), 2, 1, 0),
        ((0.2, 0.2, 0.2), 1, 0, 0),
    ],
)
def test_a_box_loses_the_dimensions_its_rounding_fills(size, vertices, edges, faces):
    solid = box(size, 0.1)

    assert (len(solid.vertices), len(solid.edges), len(solid.face_normals)) == (
        vertices,
        edges,
        faces,
    )
    assert 2.0 * (np.abs(solid.vertices).max(axis=0) + 0.1) == pytest.approx(size)
    assert solid.two_sided == (faces < 6)
    assert solid.frame_rotation.tolist() == [1.0, 0.0, 0.0, 0.0]


def test_half_the_size_fills_a_box_whatever_the_rounding_of_the_numbers():
    assert len(box((0.1 * 3, 0.6, 0.9), 0.15).vertices) == 4


def test_the_default_rounding_is_a_twentieth_of_the_smallest_size():
    solid = polyhedron_of(BoxShape(kind="box", name="b", size=(1.0, 2.0, 3.0)), HERE)

    assert solid.radius == pytest.approx(0.05)


def test_a_sphere_is_one_vertex():
    solid = polyhedron_of(SphereShape(kind="sphere", name="s", radius=0.3), HERE)

    assert solid.vertices.tolist() == [[0.0, 0.0, 0.0]]
    assert solid.volume == pytest.approx(4.0 / 3.0 * np.pi * 0.027, rel=1e-15)
    assert solid.inertia_over_mass == pytest.approx([0.4 * 0.09] * 3, rel=1e-15)


def test_a_declared_box_keeps_what_is_declared():
    shape = BoxShape(
        kind="box", name="b", size=(1.0, 1.0, 1.0), volume=1.0, inertia_over_mass=(0.1, 0.2, 0.3)
    )
    solid = polyhedron_of(shape, HERE)

    assert (solid.volume, solid.inertia_over_mass.tolist()) == (1.0, [0.1, 0.2, 0.3])


def test_a_polyhedron_takes_its_edges_from_its_faces():
    shape = PolyhedronShape(
        kind="polyhedron", name="p", vertices=CUBE_CORNERS, faces=split(CUBE_FACES), rounding=0.1
    )
    solid = polyhedron_of(shape, HERE)

    assert len(solid.edges) == 12
    assert solid.volume == pytest.approx(box((1.2, 1.2, 1.2), 0.1).volume, rel=1e-12)
    assert solid.frame_origin == pytest.approx([0.5, 0.5, 0.5])


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_meshes_are_read_and_scaled(tmp_path, suffix):
    points, triangles = soup(1000.0 * np.array(CUBE_CORNERS), split(CUBE_FACES))
    file = tmp_path / f"cube.{suffix}"
    meshio.write_points_cells(file, points, [("triangle", triangles)])
    shape = MeshShape(kind="mesh", name="m", file=file.name, scale=1e-3, rounding=0.1)
    solid = polyhedron_of(shape, tmp_path)

    assert len(solid.face_normals) == 6
    assert solid.volume == pytest.approx(box((1.2, 1.2, 1.2), 0.1).volume, rel=1e-6)


def test_a_mesh_that_cannot_be_read_is_named(tmp_path):
    (tmp_path / "rock.stl").write_text("nonsense")

    for file in ("rock.stl", "none.stl"):
        shape = MeshShape(kind="mesh", name="m", file=file, rounding=0.1)
        with pytest.raises(GeometryError, match=file):
            polyhedron_of(shape, tmp_path)


def test_a_library_shape_keeps_its_features_and_declared_mass(tmp_path):
    (tmp_path / "a.shp").write_text(CUBE_SHP)
    solid = polyhedron_of(ShpShape(kind="shp", name="cube", file="a.shp"), tmp_path)

    assert solid.radius == 0.1
    assert (solid.volume, solid.inertia_over_mass.tolist()) == (0.98, [0.16] * 3)
    assert solid.edges[:4].tolist() == [[0, 1], [1, 2], [2, 3], [3, 0]]
    assert np.all(solid.face_offsets > 0.0)
    assert solid.convex


def test_a_library_shape_without_mass_gets_its_exact_one(tmp_path):
    (tmp_path / "a.shp").write_text(CUBE_SHP)
    solid = polyhedron_of(ShpShape(kind="shp", name="grain", item="ball", file="a.shp"), tmp_path)

    assert solid.volume == pytest.approx(np.pi / 6.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (CUBE_SHP.replace("radius 0.1", "radius big"), r"a.shp:4: the radius .* not 'big'"),
        (CUBE_SHP.replace("name ball", "nom ball"), "a.shp:44: unknown keyword 'nom'"),
        (CUBE_SHP.replace("name ball", "name cube"), "a second shape named 'cube'"),
        (CUBE_SHP[:58], "ends where"),
        ("cube", "begins with '<'"),
    ],
)
def test_faults_of_a_library_have_a_line(tmp_path, text, message):
    file = tmp_path / "a.shp"
    file.write_text(text)

    with pytest.raises(GeometryError, match=message):
        read_shp(file)


def test_a_name_that_a_library_lacks_is_told_with_those_it_has(tmp_path):
    (tmp_path / "a.shp").write_text(CUBE_SHP)

    with pytest.raises(GeometryError, match="'brick' but cube, ball"):
        polyhedron_of(ShpShape(kind="shp", name="brick", file="a.shp"), tmp_path)


def test_every_reference_library_is_convex():
    files = sorted((SHARED / "reference").glob("**/*.shp"))
    if not files:
        pytest.skip(f"{SHARED / 'reference'} is not here")
    for file in files:
        for name in read_shp(file):
            assert polyhedron_of(ShpShape(kind="shp", name=name, file=str(file)), HERE).convex


def ground(heights, cell=1.0):
    rows, columns = np.shape(heights)
    x, y = cell * np.arange(columns, dtype=float), cell * np.arange(rows, dtype=float)[::-1]
    return terrain(Raster(x, y, np.array(heights, float), cell), name="ground", radius=0.0)


def test_a_raster_lies_where_its_header_says(tmp_path):
    (tmp_path / "dem.asc").write_text(HEIGHTS)
    shape = TerrainShape(kind="terrain", name="t", file="dem.asc", rounding=0.25)
    solid = polyhedron_of(shape, tmp_path)
    nodes = solid.vertices + solid.frame_origin

    assert solid.terrain
    assert not solid.two_sided
    assert not solid.mass_known
    assert solid.radius == 0.25
    assert len(solid.face_normals) == 6  # one cell has no data in a corner
    assert np.all(solid.face_normals[:, 2] > 0.0)
    assert nodes.min(axis=0).tolist() == [100.0, 200.0, 1.0]
    assert nodes.max(axis=0).tolist() == [104.0, 204.0, 2.0]
    assert nodes[np.argmax(nodes[:, 2])].tolist() == [102.0, 202.0, 2.0]
    assert solid.core_max == pytest.approx(-solid.core_min)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEIGHTS.replace("cellsize 2.0\n", ""), "header lacks cellsize"),
        (HEIGHTS.replace("cellsize 2.0", "cellsize x"), "dem.asc:5: cellsize needs a number"),
        (HEIGHTS.replace("nrows 3", "nrows 4"), "9 heights are there"),
        (HEIGHTS.replace("1 2 1", "1 high 1"), "high"),
    ],
)
def test_faults_of_a_raster_are_told(tmp_path, text, message):
    (tmp_path / "dem.asc").write_text(text)

    with pytest.raises(GeometryError, match=message):
        polyhedron_of(TerrainShape(kind="terrain", name="t", file="dem.asc"), tmp_path)


def test_flat_ground_is_touched_on_its_faces_alone():
    flat = ground(np.zeros((4, 4)))
    inner = np.all(np.abs(flat.vertices[:, :2]) < 1.4, axis=1)

    assert not flat.vertex_active[inner].any()
    assert np.sum(flat.edge_active) == 12  # its border


def test_a_ridge_is_touched_between_the_normals_of_its_slopes():
    ridge = ground([[0, 1, 0], [0, 1, 0], [0, 1, 0]])
    on_top = np.all(ridge.vertices[ridge.edges][:, :, 0] == 0.0, axis=1)
    count = len(ridge.vertices)

    assert ridge.edge_active[on_top].all()
    for edge in np.flatnonzero(on_top):
        planes = ridge.cone_planes[slice(*ridge.cone_start[count + edge : count + edge + 2])]
        assert len(planes) == 2
        for angle, inside in ((0.0, True), (0.77, True), (-0.77, True), (0.80, False)):
            direction = np.array([np.sin(angle), 0.0, np.cos(angle)])
            assert np.all(planes @ direction >= 0.0) == inside


def test_a_valley_is_never_touched_on_its_line():
    valley = ground([[1, 0, 1], [1, 0, 1], [1, 0, 1]])
    line = np.all(valley.vertices[valley.edges][:, :, 0] == 0.0, axis=1)

    assert not valley.edge_active[line].any()


def test_a_peak_is_touched_within_its_cone():
    peak = ground([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    top = int(np.argmax(peak.vertices[:, 2]))
    planes = peak.cone_planes[slice(*peak.cone_start[top : top + 2])]

    assert peak.vertex_active[top]
    assert np.all(planes @ [0.0, 0.0, 1.0] >= 0.0)
    assert not np.all(planes @ [1.0, 0.0, 0.1] >= 0.0)


def test_the_border_of_a_terrain_is_touched_from_above_only():
    flat = ground(np.zeros((3, 3)))
    border = np.flatnonzero(flat.edge_active)
    count = len(flat.vertices)

    for feature in [*(count + border), *np.flatnonzero(flat.vertex_active)]:
        planes = flat.cone_planes[slice(*flat.cone_start[feature : feature + 2])]
        assert not np.all(planes @ [0.0, 0.0, -1.0] >= 0.0)
        assert np.all(planes @ [0.0, 0.0, 1.0] >= -1e-15)


@pytest.mark.slow
def test_a_million_nodes_take_less_than_half_a_minute():
    rng = np.random.default_rng(1)

    assert len(ground(rng.random((1000, 1000))).face_normals) == 2 * 999**2


def test_the_tschamut_terrain():
    file = SHARED / "data" / "tschamut" / "terrain.asc"
    if not file.exists():
        pytest.skip(f"{file} is not here")
    shape = TerrainShape(kind="terrain", name="t", file=str(file))
    solid = polyhedron_of(shape, HERE)

    assert (len(solid.vertices), len(solid.face_normals)) == (43 * 46, 2 * 42 * 45)
    assert (solid.vertices + solid.frame_origin)[0] == pytest.approx([-35.0, 310.0, 125.494105])
