"""Bodies at the start: where they are put, and that generated ones overlap nothing."""

import numpy as np
import pytest

from warpdem.errors import SceneError
from warpdem.filling.clearance import Elements, Obstacle, distances
from warpdem.filling.curve import along_curve
from warpdem.filling.placement import place
from warpdem.filling.scatter import lattice
from warpdem.filling.sizes import drawn
from warpdem.geometry.orientation import from_matrix, matrix, principal_axes, product, turned
from warpdem.geometry.shapes import polyhedron_of
from warpdem.input.scene import Scene
from warpdem.input.scene_fill import ConstantSize, LognormalSize, NormalSize, PowerSize, UniformSize

CUBE = {"kind": "box", "name": "cube", "size": (1.0, 1.0, 1.0), "rounding": 0.1}
CONTACTS = [
    {"groups": (a, b), "kn": 1e5, "kt": 1e5, "en2": 0.5, "mu": 0.5}
    for a, b in (("default", "default"), ("default", "wall"), ("wall", "wall"))
]
TURN = (np.cos(0.4), np.sin(0.4), 0.0, 0.0)


def placed(shapes, *, body=(), fill=(), group=()):
    names = {"default", *(entry.get("group", "default") for entry in (*body, *fill, *group))}
    names |= {entry["name"] for entry in group}
    contact = [law for law in CONTACTS if {*law["groups"]} <= names]
    scene = Scene(
        run={"duration": 1.0}, shape=shapes, body=body, fill=fill, contact=contact, group=group
    )
    solids = {shape.name: polyhedron_of(shape, scene.directory) for shape in scene.shape}
    return place(scene, solids), solids


def fill(kind="random", **keys):
    return {
        "name": "heap",
        "shapes": ["cube"],
        "kind": kind,
        "density": 2500.0,
        "region": {"min": (0.0, 0.0, 0.0), "max": (10.0, 10.0, 10.0)},
        **keys,
    }


def smallest_gap(positions, radii):
    apart = np.linalg.norm(positions[:, None] - positions[None], axis=2)
    apart -= radii[:, None] + radii[None]
    return apart[np.triu_indices(len(radii), 1)].min()


def test_a_body_puts_its_files_origin_at_its_position():
    corner = {
        "kind": "polyhedron",
        "name": "corner",
        "vertices": [[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 0.5]],
        "faces": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        "rounding": 0.1,
    }
    body = {
        "shape": "corner",
        "position": (5.0, 6.0, 7.0),
        "orientation": TURN,
        "scale": 2.0,
        "density": 1.0,
    }
    bodies, solids = placed([corner], body=[body])
    vertices = turned(bodies.orientation[0], 2.0 * solids["corner"].vertices) + bodies.position[0]
    expected = 2.0 * np.array(corner["vertices"]) @ matrix(np.array(TURN)).T + [5.0, 6.0, 7.0]

    assert vertices == pytest.approx(expected, abs=1e-12)
    assert bodies.names == ("body[0]",)


def test_groups_and_densities_come_from_body_or_group():
    bodies, _ = placed(
        [CUBE],
        group=[{"name": "wall"}, {"name": "default", "density": 3.0}],
        body=[
            {"shape": "cube", "position": (0, 0, 0), "density": 2.0, "name": "mine"},
            {"shape": "cube", "position": (4, 0, 0)},
            {"shape": "cube", "position": (9, 0, 0), "group": "wall", "fixed": True},
        ],
    )

    assert bodies.groups == ("wall", "default")
    assert bodies.group.tolist() == [1, 1, 0]
    assert bodies.density.tolist() == [2.0, 3.0, 0.0]
    assert bodies.fixed.tolist() == [False, False, True]
    assert bodies.names == ("mine", "body[1]", "body[2]")


def test_a_lattice_fills_its_region_exactly():
    bodies, solids = placed([CUBE], fill=[fill("lattice", orientation="aligned")])
    bound = solids["cube"].bound

    assert len(bodies.names) == int(10.0 / (2.0 * bound)) ** 3
    assert bodies.position.min() == pytest.approx(bound)
    assert smallest_gap(bodies.position, np.full(len(bodies.names), bound)) >= 0.0
    assert np.all(bodies.orientation == [1.0, 0.0, 0.0, 0.0])


def test_a_lattice_of_exactly_so_many_balls_holds_them():
    sites = lattice(np.zeros(3), np.array([1.0, 0.7, 0.3]), 0.05, 0.0)

    assert len(sites) == 10 * 7 * 3
    assert sites[1] - sites[0] == pytest.approx([0.1, 0.0, 0.0])
    assert np.all(sites.max(axis=0) <= np.array([0.95, 0.65, 0.25]) + 1e-12)


def test_rounds_tried_together_give_the_places_of_rounds_one_by_one(monkeypatch):
    size = {"kind": "power", "min": 0.2, "max": 1.0, "exponent": -2.0}
    crowd = fill(count=900, size=size, must_fit=False)
    together, _ = placed([CUBE], fill=[crowd])
    monkeypatch.setattr("warpdem.filling.scatter._ROUNDS", 1)
    one_by_one, _ = placed([CUBE], fill=[crowd])

    assert np.array_equal(together.position, one_by_one.position)
    assert np.array_equal(together.orientation, one_by_one.orientation)


def test_a_random_fill_overlaps_nothing_and_stays_inside():
    size = {"kind": "power", "min": 0.2, "max": 1.0, "exponent": -2.0}
    bodies, solids = placed([CUBE], fill=[fill(count=400, size=size)])
    radii = bodies.scale * solids["cube"].bound

    assert len(bodies.names) == 400
    assert smallest_gap(bodies.position, radii) > 0.0
    assert np.all(bodies.position - radii[:, None] >= 0.0)
    assert np.all(bodies.position + radii[:, None] <= 10.0)
    assert bodies.names[7] == "heap[7]"


def test_the_same_seed_gives_the_same_bodies():
    first, again, other = (
        placed([CUBE], fill=[fill(count=50, seed=seed)])[0] for seed in (1, 1, 2)
    )

    assert np.array_equal(first.position, again.position)
    assert np.array_equal(first.orientation, again.orientation)
    assert not np.array_equal(first.position, other.position)


def test_fills_keep_clear_of_bodies_and_of_one_another():
    small = {"shape": "cube", "position": (5.0, 5.0, 5.0), "scale": 0.2, "density": 1.0}
    size = {"kind": "constant", "mean": 0.5}
    fills = [fill(count=100, size=size), fill(count=100, size=size, name="more")]
    bodies, solids = placed([CUBE], body=[small], fill=fills)

    assert len(bodies.names) == 201
    assert smallest_gap(bodies.position, bodies.scale * solids["cube"].bound) > 0.0


@pytest.mark.parametrize("kind", ["random", "lattice"])
def test_a_fill_keeps_clear_of_a_large_turned_wall(kind):
    wall = {"kind": "box", "name": "wall", "size": (30.0, 30.0, 2.0), "rounding": 0.2}
    body = {
        "shape": "wall",
        "position": (5.0, 5.0, 5.0),
        "orientation": TURN,
        "fixed": True,
        "group": "wall",
    }
    bodies, solids = placed([CUBE, wall], body=[body], fill=[fill(kind, count=60)])
    normal = matrix(np.array(TURN))[:, 2]
    height = np.abs((bodies.position[1:] - [5.0, 5.0, 5.0]) @ normal)

    assert len(height) > 30
    assert height.min() >= 1.0 + solids["cube"].bound


def test_a_fill_lies_above_a_terrain(tmp_path):
    rng = np.random.default_rng(3)
    heights = "\n".join(" ".join(f"{z:.3f}" for z in row) for row in 4.0 * rng.random((12, 12)))
    header = "ncols 12\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
    (tmp_path / "dem.asc").write_text(header + heights)
    ground = {"kind": "terrain", "name": "ground", "file": str(tmp_path / "dem.asc")}
    body = {"shape": "ground", "position": (0, 0, 0), "fixed": True, "group": "wall"}
    bodies, solids = placed([CUBE, ground], body=[body], fill=[fill(count=80)])
    terrain = solids["ground"]
    corners = (terrain.vertices + terrain.frame_origin)[terrain.triangles[0]]
    pairs = np.repeat(bodies.position[1:], len(corners), axis=0)
    gap = distances(pairs, np.tile(corners, (len(bodies.names) - 1, 1, 1)))

    assert len(bodies.names) > 20
    assert gap.min() >= solids["cube"].bound
    inside = np.all((bodies.position[1:, :2] > 0.0) & (bodies.position[1:, :2] < 11.0), axis=1)
    for x, y, z in bodies.position[1:][inside]:
        assert z > height_at(terrain, x, y)


def height_at(terrain, x, y):
    """Height of the ground under a point, from the plane of the triangle there."""
    for a, b, c in (terrain.vertices + terrain.frame_origin)[terrain.triangles[0]]:
        u, v = np.linalg.solve(np.array([b - a, c - a])[:, :2].T, [x - a[0], y - a[1]])
        if u >= 0.0 and v >= 0.0 and u + v <= 1.0:
            return a[2] + u * (b - a)[2] + v * (c - a)[2]
    raise AssertionError


def test_what_does_not_fit_is_counted():
    bodies, _ = placed([CUBE], fill=[fill(count=5000)])

    assert bodies.notes == (f'fill "heap": {len(bodies.names)} of 5000 fit',)


def test_what_must_fit_and_does_not_is_refused():
    with pytest.raises(SceneError, match=r"fill\[0\].count = 5000: .* of 5000 fit; enlarge"):
        placed([CUBE], fill=[fill(count=5000, must_fit=True)])


def test_free_bodies_need_a_mass():
    plate = {
        "kind": "polyhedron",
        "name": "roof",
        "vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 1]],
        "faces": [[0, 1, 2], [0, 1, 3], [1, 0, 2]],
        "edges": [[0, 1]],
        "rounding": 0.1,
    }
    with pytest.raises(SceneError, match="open surface, of unknown mass"):
        placed([plate], body=[{"shape": "roof", "position": (0, 0, 0), "density": 1.0}])


def test_orientations_at_random_have_no_preferred_direction():
    bodies, _ = placed([CUBE], fill=[fill(count=400, size={"kind": "constant", "mean": 0.3})])
    axis = turned(bodies.orientation, np.array([0.0, 0.0, 1.0]))

    assert np.linalg.norm(bodies.orientation, axis=1) == pytest.approx(np.ones(400))
    assert np.abs(axis.mean(axis=0)).max() < 4.0 / np.sqrt(3.0 * 400)


@pytest.mark.parametrize(
    ("size", "mean"),
    [
        (ConstantSize(mean=2.0), 2.0),
        (UniformSize(kind="uniform", min=1.0, max=3.0), 2.0),
        (NormalSize(kind="normal", mean=2.0, sd=0.1, min=1.0, max=3.0), 2.0),
        (NormalSize(kind="normal", mean=2.0, sd=1e6, min=1.0, max=3.0), 2.0),
        (LognormalSize(kind="lognormal", mean=2.0, sd=0.5, min=0.1, max=20.0), 2.0),
        (PowerSize(kind="power", min=1.0, max=3.0, exponent=1.0), 13.0 / 6.0),
        (PowerSize(kind="power", min=1.0, max=3.0, exponent=-1.0), 2.0 / np.log(3.0)),
        (PowerSize(kind="power", min=1.0, max=1.0, exponent=-400.0), 1.0),
    ],
)
def test_sizes_have_the_mean_of_their_distribution(size, mean):
    factors = drawn(size, 20_000, np.random.default_rng(1))

    assert factors.mean() == pytest.approx(mean, abs=5.0 * factors.std() / np.sqrt(20_000) + 1e-12)
    assert factors.min() >= getattr(size, "min", mean)
    assert factors.max() <= getattr(size, "max", mean)


def test_a_ball_inside_a_hollow_box_is_clear_and_one_in_its_wall_is_not():
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]
    hollow = {
        "kind": "polyhedron",
        "name": "hollow",
        "vertices": np.concatenate([2.0 * corners, corners]).tolist(),
        "faces": [*quads, *([corner + 8 for corner in quad] for quad in quads)],
        "rounding": 0.1,
    }
    _, solids = placed([hollow], body=[{"shape": "hollow", "position": (0, 0, 0), "fixed": True}])
    identity = np.array([1.0, 0.0, 0.0, 0.0])
    pose = Obstacle(solids["hollow"], Elements(solids["hollow"]), np.zeros(3), identity, 1.0)
    centres = np.array([[0.0, 0, 0], [0.75, 0, 0], [1.5, 0, 0], [2.2, 0, 0], [2.0, 2.0, 2.25]])

    assert pose.touched(centres, np.full(5, 0.2)).tolist() == [False, True, True, True, True]
    assert pose.touched(centres, np.full(5, 0.1)).tolist() == [False, False, True, False, False]


def test_quaternions_and_matrices_agree():
    rng = np.random.default_rng(2)
    for first, second in rng.standard_normal((20, 2, 4)):
        a, b = first / np.linalg.norm(first), second / np.linalg.norm(second)
        assert matrix(product(a, b)) == pytest.approx(matrix(a) @ matrix(b))
        back = from_matrix(matrix(a))
        assert back * np.sign(back @ a) == pytest.approx(a)


def test_principal_axes_are_the_nearest_ones():
    axes = matrix(np.array([np.cos(0.1), 0.0, 0.0, np.sin(0.1)]))
    moments, found = principal_axes(axes @ np.diag([3.0, 1.0, 2.0]) @ axes.T)

    assert moments == pytest.approx([3.0, 1.0, 2.0])
    assert found == pytest.approx(axes)


def test_neighbours_along_the_curve_are_neighbours_in_space():
    places = np.random.default_rng(2).uniform(-3.0, 7.0, (4096, 3))
    order = along_curve(places)
    assert sorted(order) == list(range(4096))
    step = np.linalg.norm(np.diff(places[order], axis=0), axis=1)
    assert step.mean() < 0.2 * np.linalg.norm(np.diff(places, axis=0), axis=1).mean()


def test_bodies_of_a_random_fill_are_numbered_along_the_curve():
    placement, _ = placed([CUBE], fill=[fill(count=200)])
    count = len(placement.position)
    assert count > 100
    assert list(along_curve(placement.position)) == list(range(count))
