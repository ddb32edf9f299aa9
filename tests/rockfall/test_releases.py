import numpy as np
import pytest
from releasing import ORIGIN, SLOPE, scene, site

from warpdem.errors import SceneError
from warpdem.geometry.orientation import matrix, turned
from warpdem.rockfall.flights import Starts
from warpdem.rockfall.releases import Releases
from warpdem.rockfall.rocks import rocks_of

X, Y, Z = ORIGIN
POINTS = [[X, Y], [X + 10.0, Y - 5.0], [X - 20.25, Y + 8.5]]
AT = {"kind": "points", "points": POINTS, "rocks": ["block"]}
SQUARE = [[X - 5, Y - 5], [X + 5, Y - 5], [X + 5, Y + 5], [X - 5, Y + 5]]


def releases(*sections, **other):
    made = scene(sections, **other)
    return Releases(made, site(), rocks_of(made))


def starts(*sections, n=1000, **other):
    return releases(*sections, **other).starts(np.arange(n))


def clearance(start, rocks):
    """Of the lowest point of each rock above the plane, along the vertical [m]."""
    steepness = np.sqrt(1.0 + SLOPE @ SLOPE)
    least = np.empty(len(start.id))
    for row, number in enumerate(start.rock):
        rock = rocks[number]
        points = rock.vertices @ matrix(start.orientation[row]).T + start.position[row]
        height = points[:, 2] - rock.rounding * steepness - points[:, :2] @ SLOPE
        ground = points[:, 0] <= 30.0
        least[row] = height[ground].min()
    return least


def same(one, other):
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in Starts.__dataclass_fields__
    )


def uniform(numbers, low, high):
    """Mean and spread of numbers are those of a uniform distribution."""
    n, width = len(numbers), high - low
    assert numbers.min() >= low
    assert numbers.max() <= high
    assert abs(numbers.mean() - 0.5 * (low + high)) < 5.0 * width / np.sqrt(12.0 * n)
    assert numbers.std() == pytest.approx(width / np.sqrt(12.0), rel=5.0 / np.sqrt(n))


EVERYTHING = {
    "kind": "area",
    "polygon": SQUARE,
    "rocks": ["block", "plate", "ball"],
    "weights": [3, 1, 2],
    "height": [0.2, 1.0],
    "speed": [1, 4],
    "azimuth": [90, 180],
    "dip": [0, 20],
    "spin_rate": [0, 5],
}
LINE = {**EVERYTHING, "kind": "line", "line": SQUARE, "weight": 0.7}
del LINE["polygon"]


def test_starts_do_not_depend_on_how_they_are_asked_for():
    made = releases(EVERYTHING, LINE, AT, count=10)
    ids = np.arange(5000, 5700)
    whole = made.starts(ids)
    parts = [made.starts(part) for part in np.split(ids, [1, 60, 401])]
    joined = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in Starts.__dataclass_fields__
    }
    assert same(whole, Starts(**joined))
    mixed = np.random.default_rng(3).permutation(len(ids))
    back = made.starts(ids[mixed])
    assert all(np.array_equal(getattr(back, k), getattr(whole, k)[mixed]) for k in joined)
    assert len(made.starts(ids[:0]).id) == 0


def test_starts_do_not_depend_on_the_number_of_trajectories():
    one, other = (releases(EVERYTHING, LINE, count=count) for count in (100, 10**6))
    assert same(one.starts(np.arange(100)), other.starts(np.arange(100)))


def test_another_seed_draws_everything_anew():
    one, other = (starts(EVERYTHING, seed=seed) for seed in (1, 2))
    for name in ("position", "orientation", "velocity", "spin"):
        assert not (getattr(one, name) == getattr(other, name)).any()


@pytest.mark.parametrize(
    ("key", "alike"),
    [
        ("height", ["rock", "orientation", "velocity", "spin"]),
        ("speed", ["rock", "orientation", "position", "spin"]),
        ("azimuth", ["rock", "orientation", "position", "spin"]),
        ("spin_rate", ["rock", "orientation", "position", "velocity"]),
    ],
)
def test_a_range_for_one_key_leaves_what_others_draw(key, alike):
    one, other = starts(EVERYTHING), starts({**EVERYTHING, key: 0.5})
    assert all(np.array_equal(getattr(one, name), getattr(other, name)) for name in alike)


def test_the_lowest_point_of_each_rock_is_at_its_height():
    rocks = rocks_of(scene())
    found = starts({**EVERYTHING, "height": 0.75})
    assert clearance(found, rocks) == pytest.approx(np.full(1000, 0.75), abs=1e-12)
    assert {*found.rock.tolist()} == {0, 1, 2}
    uniform(clearance(starts(EVERYTHING), rocks), 0.2, 1.0)


def test_without_height_or_z_rocks_start_two_centimetres_above_ground():
    found = starts(AT, n=30)
    assert clearance(found, rocks_of(scene())) == pytest.approx(np.full(30, 0.02), abs=1e-12)


def test_vertices_beyond_the_terrain_do_not_count():
    found = starts({**AT, "points": [[X + 29.99, Y]], "height": 0.0}, n=40)
    assert clearance(found, rocks_of(scene())) == pytest.approx(np.zeros(40), abs=1e-12)


def test_points_are_taken_in_turn_in_local_coordinates():
    found = starts(AT, n=7)
    wanted = np.array(POINTS) - ORIGIN[:2]
    assert np.array_equal(found.position[:, :2], wanted[np.arange(7) % 3])
    assert releases(AT).count == 3
    assert releases(AT, count=50).count == 50


def test_a_given_z_is_that_of_the_centre_of_mass():
    points = [[X, Y, Z + 12.125], [X + 1, Y]]
    found = starts({**AT, "points": points}, n=4)
    assert found.position[[0, 2], 2].tolist() == [12.125, 12.125]
    assert found.position[1, 2] < 1.0
    raised = starts({**AT, "points": points, "height": 0.02}, n=4)
    assert raised.position[0, 2] < 1.0


def test_national_coordinates_lose_nothing():
    point = [2_600_000.123, 1_200_000.456, 1500.789]
    found = starts({**AT, "points": [point]}, n=1)
    assert found.position[0].tolist() == [a - b for a, b in zip(point, ORIGIN, strict=True)]


def test_random_orientations_are_isotropic_and_fixed_ones_turn_the_rocks_own_axes():
    found = starts(EVERYTHING, n=20_000)
    assert np.abs(matrix(found.orientation).mean(axis=0)).max() < 5.0 / np.sqrt(20_000)
    rocks = rocks_of(scene())
    half = np.sqrt(0.5)
    fixed = starts({**AT, "orientation": [half, 0.0, 0.0, half]}, n=3)
    plain = rocks[0].vertices @ matrix(rocks[0].frame_rotation).T
    wanted = turned(np.array([half, 0.0, 0.0, half]), plain)
    for row in range(3):
        assert turned(fixed.orientation[row], rocks[0].vertices) == pytest.approx(wanted, abs=1e-12)


def test_speed_points_along_azimuth_and_dip():
    east = starts({**AT, "speed": 3.0, "azimuth": 90.0, "dip": 30.0}, n=5).velocity
    assert east == pytest.approx(np.tile([1.5 * np.sqrt(3.0), 0.0, -1.5], (5, 1)), abs=1e-14)
    drawn = starts(EVERYTHING, n=20_000).velocity
    speed = np.linalg.norm(drawn, axis=1)
    uniform(speed, 1.0, 4.0)
    uniform(np.degrees(np.arctan2(drawn[:, 0], drawn[:, 1])), 90.0, 180.0)
    uniform(np.degrees(np.arcsin(-drawn[:, 2] / speed)), 0.0, 20.0)


def test_velocity_and_spin_are_as_given_and_none_by_default():
    found = starts({**AT, "velocity": [1, 2, 3], "spin": [4, 5, 6]}, n=2)
    assert found.velocity.tolist() == [[1, 2, 3]] * 2
    assert found.spin.tolist() == [[4, 5, 6]] * 2
    assert not np.any(starts(AT, n=2).velocity)
    assert not np.any(starts(AT, n=2).spin)


def test_a_spin_rate_has_no_preferred_axis():
    spin = starts(EVERYTHING, n=20_000).spin
    uniform(np.linalg.norm(spin, axis=1), 0.0, 5.0)
    assert np.abs(spin.mean(axis=0)).max() < 5.0 * 5.0 / 3.0 / np.sqrt(20_000)


def test_rocks_are_drawn_by_weight():
    number = np.bincount(starts(EVERYTHING, n=20_000).rock, minlength=3) / 20_000
    assert number == pytest.approx([1 / 2, 1 / 6, 1 / 3], abs=0.015)
    alike = starts({"kind": "points", "points": POINTS}, n=20_000).rock
    assert np.bincount(alike) / 20_000 == pytest.approx(np.full(3, 1 / 3), abs=0.015)


def test_a_z_within_the_ground_is_raised_to_it_and_one_above_is_kept():
    low = {**AT, "points": [[X, Y, Z - 3.0]]}
    made = scene([low])
    rocks = rocks_of(made)
    sunk = Releases(made, site(), rocks).starts(np.arange(20))
    assert clearance(sunk, rocks) == pytest.approx(0.0, abs=1e-9)
    above = starts({**AT, "points": [[X, Y, Z + 7.0]]}, n=20)
    assert above.position[:, 2] == pytest.approx(7.0, abs=1e-9)


def test_a_line_is_met_evenly_along_its_length():
    line = [[X, Y], [X, Y], [X + 10, Y], [X + 10, Y + 30], [X + 10, Y + 30]]
    found = starts({"kind": "line", "line": line}, n=20_000).position
    way = found[:, 0] + found[:, 1]
    uniform(way, 0.0, 40.0)
    assert np.all((found[:, 1] == 0.0) | (found[:, 0] == 10.0))


def test_an_area_is_met_evenly_whatever_its_form():
    polygon = [[X, Y], [X + 20, Y], [X + 20, Y + 20], [X + 10, Y + 20], [X + 10, Y + 10]]
    found = starts({"kind": "area", "polygon": polygon[::-1]}, n=40_000).position
    tall = found[:, 0] > 10.0
    assert tall.mean() == pytest.approx(200 / 250, abs=0.01)
    uniform(found[tall, 0], 10.0, 20.0)
    uniform(found[tall, 1], 0.0, 20.0)
    low = found[~tall]
    assert np.all(low[:, 1] <= low[:, 0])
    assert low.mean(axis=0)[:2] == pytest.approx([20 / 3, 10 / 3], abs=0.15)


def write_shapefile(path):
    shapefile = pytest.importorskip("shapefile")
    frame = [[X - 20, Y - 20], [X - 20, Y + 20], [X + 20, Y + 20], [X + 20, Y - 20]]
    hole = [[X - 10, Y - 10], [X + 10, Y - 10], [X + 10, Y + 10], [X - 10, Y + 10]]
    island = [[X - 40, Y - 40], [X - 40, Y - 30], [X - 30, Y - 30], [X - 30, Y - 40]]
    with shapefile.Writer(str(path), shapeType=shapefile.POLYGON) as writer:
        writer.field("name", "C")
        writer.poly([[*ring, ring[0]] for ring in (frame, hole, island)])
        writer.record("all")


def test_polygons_of_a_shapefile_keep_their_holes(tmp_path):
    write_shapefile(tmp_path / "a.shp")
    found = starts({"kind": "area", "file": "a.shp"}, n=13_000, directory=tmp_path).position
    island = found[:, 0] < -25.0
    assert island.mean() == pytest.approx(100 / 1300, abs=0.012)
    assert np.all((found[island, :2] > -40.0) & (found[island, :2] < -30.0))
    frame = np.abs(found[~island, :2]).max(axis=1)
    assert frame.min() > 10.0
    assert frame.max() < 20.0
    assert found[~island, :2].mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.6)


TABLE = f"""id;x_m;y_m;z_m;u;v;w;block_id
a;{X + 1};{Y};{Z + 9};0.5;0;-1;plate

b;{X + 2};{Y};{Z + 8};0;0.25;-2;block
"""
COLUMNS = {"x": "x_m", "y": "y_m", "z": "z_m", "vx": "u", "vy": "v", "vz": "w", "rock": "block_id"}


def test_a_table_says_where_how_and_what(tmp_path):
    (tmp_path / "a.csv").write_text(TABLE)
    section = {"kind": "table", "file": "a.csv", "columns": COLUMNS}
    found = starts(section, n=3, directory=tmp_path)
    assert found.rock.tolist() == [1, 0, 1]
    assert found.position.tolist() == [[1.0, 0.0, 9.0], [2.0, 0.0, 8.0], [1.0, 0.0, 9.0]]
    assert found.velocity.tolist() == [[0.5, 0.0, -1.0], [0.0, 0.25, -2.0], [0.5, 0.0, -1.0]]
    assert releases(section, directory=tmp_path).count == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TABLE.replace("plate", "plaet"), ":2: block_id = 'plaet': no .* did you mean \"plate\""),
        (TABLE.replace("-2", "two"), ":4: w = 'two': must be a finite number"),
        (TABLE.replace("0.25", "nan"), ":4: v = 'nan': must be a finite number"),
        (
            TABLE.replace(";block\n", "\n"),
            ":4: has 7 columns where the first line names 8: id",
        ),
        (TABLE.replace("y_m", "ym"), "has no column 'y_m'; it has id, x_m, ym"),
        (TABLE[:10], "needs a line of names and a row"),
        (TABLE.replace("a;", '"a;'), "cannot be read as a table"),
    ],
)
def test_faulty_tables_name_file_and_line(tmp_path, text, words):
    (tmp_path / "a.csv").write_text(text)
    section = {"kind": "table", "file": "a.csv", "columns": COLUMNS}
    with pytest.raises(SceneError, match=r"release\[0\].file: .*a.csv.*" + words):
        releases(section, directory=tmp_path)


def test_points_beyond_the_terrain_are_told_with_their_coordinates(tmp_path):
    far = [[X + 40 + k, Y] for k in range(12)]
    rows = "x,y\n" + "".join(f"{x},{y}\n" for x, y in (POINTS[0], [X, Y - 51]))
    (tmp_path / "a.csv").write_text(rows)
    with pytest.raises(SceneError) as caught:
        releases(
            {**AT, "points": [*POINTS, *far]},
            AT,
            {"kind": "line", "line": [POINTS[0], [X + 31, Y]]},
            {"kind": "table", "file": "a.csv"},
            directory=tmp_path,
        )
    points, line, table = caught.value.problems
    assert points.key == "release[0].points"
    assert "12 of 15 points lie outside the terrain" in points.message
    assert "(2600040, 1200000), (2600041, 1200000)" in points.message
    assert "(2600049, 1200000) and 2 more" in points.message
    assert (line.key, table.key) == ("release[2].line", "release[3].file")
    assert "1 of 2 points lies outside" in line.message
    assert "1 of 2 rows lies" in table.message
    assert "on line 3, (2600000, 1199949)" in table.message


def test_an_area_may_not_reach_where_there_is_no_ground():
    polygon = [[x + 27.0, y] for x, y in SQUARE]
    with pytest.raises(SceneError, match=r"release\[1\].polygon: .* keep the area on the terrain"):
        starts(AT, {"kind": "area", "polygon": polygon})


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ({"kind": "area", "polygon": [[X, Y], [X + 1, Y], [X + 2, Y]]}, "has no surface"),
        ({"kind": "line", "line": [[X, Y], [X, Y]]}, "all points are one"),
        ({"kind": "area", "file": "none.shp"}, "none.shp: cannot be read as a shapefile"),
        ({"kind": "table", "file": "none.csv"}, "none.csv: cannot be read: No such file"),
    ],
)
def test_places_that_are_none_are_refused(section, words):
    if section.get("file") == "none.shp":
        pytest.importorskip("shapefile")
    with pytest.raises(SceneError, match=words):
        releases(section)


def counts(found, n):
    return np.cumsum(found.release[:, None] == np.arange(n), axis=0)


def test_by_default_every_point_of_every_release_is_taken_once():
    many = {**AT, "points": [[X + 0.25 * k, Y] for k in range(40)]}
    made = releases(AT, many)
    found = made.starts(np.arange(made.count))
    assert made.count == 43
    assert np.bincount(found.release).tolist() == [3, 40]
    assert len(np.unique(found.position[found.release == 1, 0])) == 40


@pytest.mark.parametrize("weights", [[3.0, 1.0], [1.5, 0.3, 2.2], [1 / 3] * 7, [1e-3, 1.0, 1e3]])
def test_releases_have_their_share_at_any_number_of_trajectories(weights):
    found = starts(*({**AT, "weight": weight} for weight in weights), n=5000)
    wanted = np.arange(1, 5001)[:, None] * np.array(weights) / sum(weights)
    assert np.abs(counts(found, len(weights)) - wanted).max() < 0.5 * len(weights)


def test_shares_are_those_of_the_divisor_method():
    weights = [2.0, 5.0, 0.7]
    turns = sorted(((r + 0.5) / w, k) for k, w in enumerate(weights) for r in range(500))
    found = starts(*({**AT, "weight": weight} for weight in weights), n=600)
    assert found.release.tolist() == [k for _, k in turns[:600]]
