import subprocess
import sys
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from grids import write_asc

from warpdem.__main__ import main
from warpdem.checks.check import check
from warpdem.errors import Problem, SceneError
from warpdem.input.decode import load
from warpdem.rockfall import releases, rocks
from warpdem.rockfall.flights import Starts
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.task import prepared

EAST, NORTH = 2790000.0, 1180000.0
WEST = [[EAST, NORTH], [EAST + 5, NORTH], [EAST + 5, NORTH + 8], [EAST, NORTH + 8]]
TEXT = f"""
title = "a slope"
[run]
method = "nonsmooth"
duration = 30.0
[terrain]
file = "t.asc"
class = "hard"
nodes = "corner"
crs = "EPSG:2056"
[[ground]]
class = "soft"
polygon = {WEST}
[[forest]]
density = "open"
height = 20.0
polygon = {WEST}
[[barrier]]
name = "net"
line = [[0, 0], [1, 1]]
height = 3.0
capacity = 5e5
[ensemble]
chunk = 300
[[rock]]
name = "block"
kind = "builder"
form = "flat"
volume = 0.2
density = 2500.0
[[release]]
rocks = ["block"]
kind = "points"
points = [[{EAST + 4}, {NORTH + 4}]]
[[release]]
rocks = ["block"]
kind = "points"
points = [[{EAST + 4}, {NORTH + 4}]]
"""


class StandIn:
    """Releases at four places in turn."""

    count = 1000

    def __init__(self, scene, site, rocks):
        self.place = np.array([[5.0, 5.0], [1.0, 3.0], [2.5, 6.5], [4.0, 4.0]])

    def starts(self, ids):
        n = len(ids)
        place = np.column_stack([self.place[ids % 4], np.full(n, 9.0)])
        zero = np.zeros((n, 3))
        release = (ids % 4 >= 2).astype(np.int32)
        turn = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
        return Starts(ids, release, np.zeros(n, np.int32), place, turn, zero, zero)


def block(vertices=24):
    corners = np.random.default_rng(0).normal(size=(vertices, 3))
    none = np.zeros((0, 3))
    pairs = np.array([*combinations(range(vertices), 2)])
    return Rock("block", corners, 0.0, pairs, 500.0, np.ones(3), none, none)


@pytest.fixture
def scene(tmp_path, monkeypatch):
    heights = np.tile(1500.25 + 0.5 * np.arange(11.0), (9, 1))
    heights[0, 10] = np.nan
    heights[2, 8] = np.nan
    write_asc(tmp_path / "t.asc", heights, x=EAST, y=NORTH)
    (tmp_path / "s.toml").write_text(TEXT)
    monkeypatch.setattr(releases, "Releases", StandIn)
    monkeypatch.setattr(rocks, "rocks_of", lambda scene: (block(),))
    return load(tmp_path / "s.toml")


def test_check_tells_extent_classes_and_what_stands(scene):
    text = str(check(scene))
    assert "10 x 8 cells of 1 m, 6.25 % without data" in text
    assert "x 2790000.000 to 2790010.000, y 1180000.000 to 1180008.000" in text
    assert "z 1500.250 to 1505.250, slope at most 26.6 degrees" in text
    assert "reference system EPSG:2056" in text
    assert "50 % of the cells: 250 kg/s up to 20 m" in text
    assert "barrier net: 3 m high, takes 500000 J" in text


def test_check_marks_unverified_classes(scene):
    report = check(scene)
    (soft,) = [line for line in str(report).splitlines() if line.startswith("  soft")]
    assert "UNVERIFIED" in soft
    assert "53.3 %" in soft
    assert report.warnings[0].startswith("UNVERIFIED")
    assert "no part of it lies on the terrain" in report.warnings[1]


def test_check_estimates_time_memory_and_files(scene):
    report = check(scene)
    assert report.count == 1000
    assert "flights 1000, 4 chunks of 300" in str(report)
    assert report.seconds == pytest.approx(1000 * 2e-3 * (0.6 + 0.4 * 24 / 8))
    assert report.memory == 80 * (42 + 1500) + 1000 * 290
    assert report.disk == 27 * 80 * 10


def test_check_passes_on_why_releases_cannot_start(scene, monkeypatch):
    fault = Problem("s.toml:30", "release[0]", "no room")

    def refuse(self, ids):
        raise SceneError("s.toml", [fault])

    monkeypatch.setattr(StandIn, "starts", refuse)
    assert check(scene).problems == (fault,)


def test_check_goes_on_where_releases_are_refused_at_once(scene, monkeypatch):
    fault = Problem("s.toml:30", "release[0].points", "outside the terrain")

    def refuse(self, scene, site, rocks):
        raise SceneError("s.toml", [fault])

    monkeypatch.setattr(StandIn, "__init__", refuse)
    report = check(scene)
    assert report.problems == (fault,)
    assert "x 2790000.000 to 2790010.000" in str(report)


def test_check_tells_what_has_no_effect(scene):
    report = check(load(scene.source, ["output.table=true"]))
    assert report.warnings[0].startswith("output.table has no effect")


def test_check_misses_what_a_format_needs(scene, monkeypatch):
    monkeypatch.setattr("warpdem.rockfall.prepare.find_spec", lambda name: None)
    changed = load(scene.source, ['output.formats=["tif"]'])
    assert "pip install 'warpdem[geo]'" in str(check(changed).problems[-1])


@pytest.mark.parametrize("system", ["banana", "EPSG:99999999", "EPSG:one"])
def test_a_geotiff_needs_a_reference_system_there_is(scene, system):
    pytest.importorskip("rasterio")
    wanted = [f"terrain.crs={system}", 'output.formats=["asc", "tif"]']
    words = f'terrain.crs = "{system}": no known reference system'
    (problem,) = [p for p in check(load(scene.source, wanted)).problems if "crs" in str(p)]
    assert words in str(problem)
    assert 'give a code such as "EPSG:2056"' in str(problem)
    with pytest.raises(SceneError) as caught:
        prepared(load(scene.source, wanted), "cpu", "")
    assert words in str(caught.value)


def test_without_geotiff_no_reference_system_is_looked_up(scene):
    for other in ('output.formats=["asc"]', "output.rasters=false"):
        wanted = ["terrain.crs=banana", 'output.formats=["tif"]', other]
        assert "banana" not in str(check(load(scene.source, wanted)).problems)


def test_a_barrier_from_edge_to_edge_lies_on_the_terrain(scene):
    across = f"barrier.0.line=[[{EAST + 5}, {NORTH - 3}], [{EAST + 5}, {NORTH + 20}]]"
    assert not any("barrier" in text for text in check(load(scene.source, [across])).warnings)


def test_check_tells_which_wanted_trajectories_there_are_not(scene):
    report = check(load(scene.source, ["output.trajectories=[3, 1000]"]))
    assert "there is no trajectory 1000; they are numbered from 0 to 999" in report.warnings[-1]


def test_the_command_prints_the_report_and_fails_on_problems(scene, capsys, monkeypatch):
    assert main(["check", str(scene.source)]) == 0
    assert "a slope" in capsys.readouterr().out
    monkeypatch.setattr("warpdem.rockfall.prepare.find_spec", lambda name: None)
    assert main(["check", str(scene.source), "--set", 'output.formats=["tif"]']) == 2


def test_check_asks_only_for_what_there_is(scene, monkeypatch):
    asked = SimpleNamespace(most=0)
    starts = StandIn.starts

    def watched(self, ids):
        asked.most = max(asked.most, len(ids))
        return starts(self, ids)

    monkeypatch.setattr(StandIn, "starts", watched)
    monkeypatch.setattr(StandIn, "count", 10**9)
    assert check(scene).seconds == pytest.approx(3.6e6)
    assert asked.most == 10_000


def test_checking_rockfall_does_not_load_warp():
    code = "import sys, warpdem.checks.rockfall, warpdem.rockfall.bodies; "
    code += "sys.exit('warp' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_check_doubts_gaps_large_rocks_and_starts_within_trunks(scene):
    trunk = f"tree=[{{position=[{EAST + 5}, {NORTH + 5}], diameter=0.5, height=9, mu=0.4}}]"
    gap, size, *trunks = check(load(scene.source, [trunk])).warnings[-4:]
    assert gap.startswith("4 cells without data")
    assert size.startswith('rock "block" is')
    assert len(trunks) == 2
