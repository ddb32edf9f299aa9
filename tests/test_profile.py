"""A profile: nested times that add up, of the same run."""

import json
import threading
import time

import numpy as np
import pytest
from colliding import heap, same, scene
from test_memory import bonded, periodic, spheres

from warpdem.__main__ import main
from warpdem.profiled import ProfiledSimulation
from warpdem.running.profile import BESIDE, Profile, profile_text, without
from warpdem.simulation import Simulation

SCENE = """
run = {duration = 0.02, dt = 1e-3}
shape = [{name = "cube", kind = "box", size = [1.0, 1.0, 1.0]}]
body = [
    {shape = "cube", position = [0.0, 0.0, 1.0], density = 2.0},
    {shape = "cube", position = [0.0, 0.0, 0.0], fixed = true},
]
contact = [{groups = ["default", "default"], kn = 1e3, kt = 1e3, en2 = 0.5, mu = 0.5}]
output = {every = 0.01}
"""


def profiled(built, *, threads=1, steps=400):
    simulation = ProfiledSimulation(built, profile=Profile(), device="cpu", threads=threads)
    simulation.advance(steps * simulation.dt)
    return simulation


@pytest.mark.parametrize("built", [spheres, bonded, periodic, lambda: scene(heap(2, 8))])
def test_a_profiled_run_is_the_same_to_the_last_bit(built):
    plain = Simulation(built(), device="cpu", threads=1)
    plain.advance(400 * plain.dt)
    assert same(plain, profiled(built()))


def test_a_profiled_run_is_the_same_on_two_threads(monkeypatch):
    monkeypatch.setattr("warpdem.simulation.CREW_BODIES", 1)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    assert same(profiled(scene(heap(2, 8))), profiled(scene(heap(2, 8)), threads=2))


def test_parts_add_up_to_their_whole():
    simulation = profiled(scene(heap(2, 8)))
    facts = simulation._profile.facts(simulation.features, 1)
    seconds = {row["stage"]: row["seconds"] for row in facts["stages"]}
    wholes = {stage.rpartition("/")[0] for stage in seconds} - {""}
    assert {"steps", "steps/rebuild", "steps/rebuild/pairs"} <= wholes
    for whole in wholes:
        parts = [s for stage, s in seconds.items() if stage.rpartition("/")[0] == whole]
        assert sum(parts) == pytest.approx(seconds[whole], rel=1e-9)
        assert min(parts) >= 0.0


def test_each_stage_of_the_steps_is_counted():
    simulation = profiled(scene(heap(2, 8)))
    calls = {path[-1]: s.calls for path, s in simulation._profile.spans.items() if "steps" in path}
    for name in ("hot lists", "pair forces"):
        assert calls[name] == simulation.step_count
    assert calls["rebuild"] == simulation.report()["rebuilds"] - 1
    counts = simulation._profile.facts(simulation.features, 1)["counts"]
    assert counts["pairs"] == simulation._lists.pair_count
    assert 0 <= counts["touching"] <= counts["hot"] <= counts["candidates"]


def test_what_a_scene_does_without_is_named():
    few = without(Simulation(spheres(), device="cpu", threads=1).features)
    assert {"rolling", "bonds", "periodic cell", "hot lists", "orientations"} <= set(few)
    assert "contacts" not in few
    assert "friction" not in few


def test_time_on_another_thread_stands_beside():
    profile = Profile()

    def work():
        with profile.span("files"):
            time.sleep(0.002)

    with profile.span("steps"):
        thread = threading.Thread(target=work)
        thread.start()
        thread.join()
    assert set(profile.spans) == {("steps",), (BESIDE, "files")}


def test_laps_end_where_others_begin():
    profile = Profile()
    for text in ("shapes", "kernels 1/2: a", "kernels 2/2: b", "first forces", ""):
        profile.lap(text)
    assert [(path, span.calls) for path, span in profile.spans.items()] == [
        (("shapes",), 1),
        (("kernels",), 1),
        (("first forces",), 1),
    ]


def test_the_command_prints_a_profile_and_keeps_it(tmp_path, capsys):
    file, folder = tmp_path / "scene.toml", tmp_path / "run"
    file.write_text(SCENE)
    assert main([str(file), "--out", str(folder), "--profile", "--quiet"]) == 0
    printed = capsys.readouterr().out
    facts = json.loads((folder / "summary.json").read_text())["profile"]
    assert printed.startswith("profile of ")
    assert "without: rolling, cohesion" in printed
    stages = [row["stage"] for row in facts["stages"]]
    assert {"start-up/scene", "start-up/kernels", "steps/pair forces", "snapshots"} <= set(stages)
    assert np.sum([row["share"] for row in facts["stages"] if "/" not in row["stage"]]) >= 1.0
    assert profile_text(facts).splitlines()[1].split() == [
        *["seconds", "share", "calls", "ns", "a", "body-step"]
    ]


def test_an_ensemble_has_no_profile(tmp_path, capsys):
    status = main(["scenes/rockfall_valley.toml", "--out", str(tmp_path / "run"), "--profile"])
    assert status == 2
    assert "--profile times the stages" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
