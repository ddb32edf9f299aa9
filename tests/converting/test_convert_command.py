"""``python -m warpdem convert`` as a person meets it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conffiles import conf, write

import warpdem
from warpdem.__main__ import main
from warpdem.converting.toml import inline, toml
from warpdem.input import decode

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def source(tmp_path):
    return write(tmp_path, conf("Integrator Euler"))


def test_scene_is_written_checked_and_run(tmp_path, source, capsys):
    target = tmp_path / "scenes" / "two.toml"
    target.parent.mkdir()

    assert main(["convert", str(source), "-o", str(target)]) == 0

    told = capsys.readouterr()
    assert told.out == ""
    assert f"{target}: written" in told.err
    assert "Integrator Euler: not brought" in told.err
    scene = warpdem.load(target)
    assert scene.run.compat == "rockable"
    assert scene.shape[0].file == "../shapes.shp"
    simulation = warpdem.Simulation(scene, device="cpu", threads=1)
    simulation.advance(0.01)
    falls = 0.2 - 0.5 * 9.81 * 0.01**2
    assert simulation.snapshot().position[1, 2] == pytest.approx(falls, rel=1e-9)


def test_accurate_scene_has_no_compat(tmp_path, source):
    target = tmp_path / "two.toml"

    assert main(["convert", str(source), "-o", str(target), "--accurate"]) == 0
    assert decode.load(target).run.compat == "none"


def test_scene_that_is_there_is_kept_unless_forced(tmp_path, source, capsys):
    target = tmp_path / "two.toml"
    target.write_text("mine")

    assert main(["convert", str(source), "-o", str(target)]) == 2
    assert target.read_text() == "mine"
    assert "--force replaces it" in capsys.readouterr().err
    assert main(["convert", str(source), "-o", str(target), "--force"]) == 0
    assert "[[body]]" in target.read_text()


def test_input_is_never_overwritten(source, capsys):
    text = source.read_text()

    assert main(["convert", str(source), "-o", str(source), "--force"]) == 2
    assert source.read_text() == text
    assert "is the input" in capsys.readouterr().err


def test_problems_leave_nothing_behind(tmp_path, capsys):
    source = write(tmp_path, conf("nonsense 1", "knContact a"))

    assert main(["convert", str(source), "-o", str(tmp_path / "two.toml")]) == 2
    said = capsys.readouterr().err
    assert "2 problems" in said
    assert "nonsense" in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["input.txt", "shapes.shp"]


def test_scene_that_breaks_its_own_rules_is_not_written(tmp_path, capsys):
    source = write(tmp_path, conf("muContact 0 0 -1"))

    assert main(["convert", str(source), "-o", str(tmp_path / "two.toml")]) == 2
    assert "contact[0].mu = -1.0" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["input.txt", "shapes.shp"]


def test_folder_that_is_not_there(tmp_path, source, capsys):
    assert main(["convert", str(source), "-o", str(tmp_path / "no" / "two.toml")]) == 74
    assert "no such file or directory" in capsys.readouterr().err


def test_converting_does_not_load_warp(tmp_path, source):
    code = "import sys, warpdem.converting.convert; sys.exit('warp' in sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False, env=os.environ)

    assert result.returncode == 0


def test_mistyped_command_is_told_from_a_file(capsys):
    assert main(["convrt", "x"]) == 2
    assert 'did you mean "convert"?' in capsys.readouterr().err


@pytest.mark.parametrize("value", [0.1, 1e-300, -1.7976931348623157e308, 1 / 3, 5e-324, 2.0, 1e22])
def test_numbers_come_back_to_the_last_bit(value):
    assert decode._parse(f"x = {inline(value)}", "")["x"] == value


def test_texts_and_tables_come_back():
    tables = {
        "title": 'a "quoted" \\ name\n\x7f',
        "run": {"on": True, "list": [1, 2.5, "x"], "inner": {"a": 1.0}},
        "body": [{"name": "é"}, {"name": "b", "rows": [[1.0, 2.0], [3.0, 4.0]]}],
    }
    text = toml(tables, ["head\nwith a line"], {"run": "remark", "body": "bodies"})

    assert decode._parse(text, "") == tables
    assert text.startswith("# head with a line\n")
    assert "# remark\n[run]\n" in text
    assert text.count("# bodies") == 1
