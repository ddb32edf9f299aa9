import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import regress
import run
from speed import compare, counting, report, rest, scaling, scenes, skips
from speed.cases import CASES, Case, Recorded, case_named
from speed.peers import Peer, Run, Timing, liggghts, rockable
from speed.peers.engines import engines
from speed.problem import Law
from speed.timing import alternating, middle, paired_ratio

from warpdem.checks.check import build_shapes
from warpdem.converting.convert import convert
from warpdem.features import features_of
from warpdem.filling.placement import place
from warpdem.input.decode import load, loads


def timing(speed, **more):
    return Timing(wall=1.0, steps=1, bodies=speed, **more)


def few(problem, count=8):
    return problem.at(problem.position[:count], problem.orientation[:count])


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_case_holds_what_it_says(case):
    problem = case.make()
    scene = loads(scenes.text(few(problem)))
    grain = build_shapes(scene)["grain"]

    assert str(problem.count) in case.what
    assert grain.volume == pytest.approx(problem.solid.volume, rel=1e-12)
    assert grain.bound == pytest.approx(problem.solid.bound, rel=1e-12)
    assert len([body for body in scene.body if body.fixed]) == len(problem.walls)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_no_two_bodies_of_a_case_overlap_at_the_start(case):
    problem = few(case.make(), 500)
    apart = np.linalg.norm(problem.position[:, None] - problem.position[None], axis=-1)
    np.fill_diagonal(apart, np.inf)

    assert apart.min() > problem.solid.size
    for wall in problem.walls:
        depth = (problem.position - wall.point) @ wall.normal
        assert depth.min() > 0.5 * problem.solid.size


def test_a_dashpot_gives_the_restitution_that_is_asked():
    law = Law(en2=0.1)

    rebound = np.exp(-np.pi * law.damping_ratio / np.sqrt(1.0 - law.damping_ratio**2))

    assert rebound**2 == pytest.approx(0.1, rel=1e-12)


def test_ratios_are_medians_over_the_rounds():
    ours, theirs = (timing(6), timing(8), timing(30)), (timing(2), timing(4), timing(5))

    assert paired_ratio(ours, theirs) == 3.0
    assert middle(ours).speed == 8.0


def test_programs_run_in_turn_and_every_other_round_backwards():
    order = []
    runs = {name: lambda name=name: order.append(name) for name in "ab"}

    alternating(runs, 3)

    assert order == list("abbaab")


def peer(name, missing=None):
    return Peer(name, f"install {name}", lambda: missing, lambda asked: timing(1))


def test_a_program_that_is_not_there_is_named_and_skipped():
    present, skipped = compare.able([peer("A"), peer("B", "no command b")])

    assert [one.name for one in present] == ["A"]
    assert skipped == ["B: skipped, no command b; install B"]


def test_a_python_without_the_engines_is_named():
    mujoco, _ = engines("/nowhere/python")

    assert mujoco.missing() == "no Python /nowhere/python"
    assert rockable.rockable(None).missing() == "no path by --rockable"


def test_a_target_is_met_by_the_ratio_of_cpu_time_on_one_thread():
    case = Case(
        "c",
        "",
        lambda: None,
        0,
        0,
        1,
        "",
        recorded=(Recorded("R", 1, 2.0, "then"),),
        targets={("A", 1): 2.0, ("R", 1): 4.0},
    )
    found = {"warpdem": (timing(9, cpu=1.0),), "A": (timing(3, cpu=0.5),)}

    rows = {row[2]: row for row in compare.rows_of(case, 1, found)}

    ratio, cpu, target, word = rows["A"][6:]
    assert (ratio, cpu, target, word) == (3.0, 1.5, 2.0, "missed")
    assert rows["R (recorded)"][6:] == (4.5, 4.5, 4.0, "met")
    assert rows["warpdem"][6:] == (None, None, None, None)


def test_a_table_is_one_of_markdown_and_its_rows_are_in_the_json(tmp_path):
    table = report.Table(
        "speeds", ("who", "x", "y"), (("a", 1, None), ("b", 2, 1234.5)), ("a note",)
    )

    report.write_json(tmp_path / "t.json", [table])

    assert table.markdown() == (
        "### speeds\n\n"
        "| who | x | y        |\n"
        "|-----|---|----------|\n"
        "| a   | 1 | -        |\n"
        "| b   | 2 | 1.23e+03 |\n\n"
        "- a note\n"
    )
    found = json.loads((tmp_path / "t.json").read_text())
    assert found["tables"][0]["rows"][1] == {"who": "b", "x": 2, "y": 1234.5}


SAID = """
    Step    Atoms         KinEng  touching
     300     1000      1.5   40
Loop time of 2.5 on 1 procs for 300 steps with 1000 atoms, finish time
Neighbor list builds = 9
     500     1000      0.5   36
Loop time of 4 on 1 procs for 200 steps with 1000 atoms, finish time
Neighbor list builds = 3
"""


def test_liggghts_is_timed_by_its_own_last_loop(monkeypatch, tmp_path):
    monkeypatch.setattr(liggghts, "run", lambda command, cwd: SAID)
    problem = scenes.spheres(8, 2)

    found = liggghts.timed(Run(problem, tmp_path, 1, 300, 200))

    assert found.speed == 1000 * 200 / 4.0
    assert found.facts == {"pair_contacts": 18, "kinetic": 0.5, "rebuilds": 3}


def test_liggghts_walls_stand_where_the_problems_do():
    text = liggghts.text(scenes.spheres(8, 2), 1, 2)

    assert "primitive type 2 zplane 0.0" in text
    assert "primitive type 2 xplane 0.218" in text


@pytest.mark.parametrize("make", [scenes.spheres, scenes.cubes])
def test_rockables_input_is_the_same_problem(make, tmp_path):
    problem = make(8, 2)
    (tmp_path / "shapes.shp").write_text(rockable.shapes(problem))
    (tmp_path / "input.txt").write_text(rockable.conf(problem, 10))

    convert(tmp_path / "input.txt", tmp_path / "scene.toml")
    scene = load(tmp_path / "scene.toml")

    free = [body.position for body in scene.body if not body.fixed]
    assert free == pytest.approx(problem.position, abs=1e-15)
    assert len(scene.body) == problem.count + len(problem.walls)


def test_the_largest_step_is_the_first_whose_pile_is_that_of_its_eighth():
    def pile(dt):
        facts = {"height": 1.0 + 2.0 * dt, "speed_rms": 1.0 if dt > 0.03 else 0.0}
        return SimpleNamespace(facts=facts) if dt < 0.07 else None

    found = rest.largest_step(pile, 0.08)

    assert found == 0.005
    assert 2.0 * found * 7 / 8 <= rest.HEIGHT < 2.0 * (2.0 * found) * 7 / 8


def test_no_step_is_right_when_no_pile_comes_to_rest():
    moving = SimpleNamespace(facts={"height": 1.0, "speed_rms": 1.0})

    assert rest.largest_step(lambda dt: moving, 0.08) is None


def test_simulated_body_seconds_are_counted_per_second_of_cpu():
    found = Timing(wall=9.0, steps=100, bodies=10, cpu=2.0)

    assert rest.simulated(found, 0.01) == 5.0


@pytest.mark.parametrize("term", skips.TERMS, ids=lambda term: term.name)
def test_a_term_is_in_the_scene_that_does_not_use_it_and_not_in_the_one_without(term):
    found = {}
    for kind, text in term.scenes(scenes.spheres(2, 2)).items():
        scene = loads(text)
        shapes = build_shapes(scene)
        features = features_of(scene, place(scene, shapes), shapes)
        found[kind] = {name for name, value in vars(features).items() if value}

    assert found["without"] <= found["unused"]
    if "used" in found:
        assert found["used"] > found["without"]


def test_the_layer_of_the_scaling_is_ten_deep():
    scene = loads(scaling.layer(1000))
    placed = place(scene, build_shapes(scene))
    free = placed.position[~placed.fixed]

    assert len(free) == 1000
    assert len(np.unique(free[:, 2].round(6))) == 10


def test_an_unknown_case_is_an_error():
    with pytest.raises(KeyError):
        case_named("none")


def test_a_plot_has_a_file(tmp_path):
    pytest.importorskip("matplotlib")
    table = report.Table("s", ("x", "y", "k"), ((1, 2.0, "a"), (10, 3.0, "a")), (), ("x", "y", "k"))

    report.write_plot(Path(tmp_path / "p.png"), [table])

    assert (tmp_path / "p.png").stat().st_size > 1000


def test_instructions_are_counted_per_body_and_step():
    said = "version: 1\nsummary: 50000\n\ntotals: 50000\n"
    found = {"bodies": 10, "steps": 100, "contacts": 3, "candidates": 5, "height": 1.0}

    assert counting.per_body_step(said, found) == {
        "instructions": 50.0,
        "contacts": 3,
        "candidates": 5,
    }


@pytest.mark.parametrize(
    ("now", "word", "status"), [(102.0, "kept", 0), (104.0, "GREW", 1), (50.0, "kept", 0)]
)
def test_a_step_that_grew_by_more_than_the_tolerance_fails(now, word, status):
    counts = {"contacts": 1, "candidates": 2}
    row = counting.judged("c", {"instructions": now} | counts, {"instructions": 100.0} | counts)

    assert row[-1] == word
    assert regress.status([row[-1], "kept"]) == status


def test_a_case_that_the_file_lacks_has_no_verdict(tmp_path):
    counts = {"instructions": 1.0, "contacts": 1, "candidates": 2}
    counting.write(tmp_path / "r.json", {"a": counts})
    then = counting.read(tmp_path / "r.json")

    assert then == {"a": counts}
    assert regress.status([counting.judged("b", counts, then.get("b"))[-1]]) == 2


def test_the_regression_file_has_every_small_case():
    assert set(counting.read(regress.FILE)) == set(counting.SMALL)


@pytest.mark.parametrize("name", counting.SMALL)
def test_a_small_case_is_a_scene(name):
    problem = counting.SMALL[name].make()

    assert len(loads(scenes.text(problem)).body) == problem.count + len(problem.walls)


def test_rockable_runs_beside_the_cases_that_quote_it():
    asked = SimpleNamespace(rockable=None, threads=[2])

    beside = {name: run.chosen(name, asked).peers for name in ("spheres_rest", "octahedra")}

    assert "Rockable" in {one.name for one in beside["spheres_rest"]}
    assert "Rockable" not in {one.name for one in beside["octahedra"]}
    assert run.chosen("octahedra", asked).threads == (2,)
