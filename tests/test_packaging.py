"""The wheel holds what the checkout holds."""

import importlib.util
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def test_every_package_folder_is_listed():
    listed = set(
        tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    )
    folders = {
        ".".join(path.parent.relative_to(ROOT).parts)
        for path in (ROOT / "warpdem").rglob("__init__.py")
    }

    assert folders == listed


@pytest.mark.skipif(importlib.util.find_spec("setuptools") is None, reason="needs setuptools")
def test_wheel_holds_every_module_once(tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    for name in ("warpdem", "kernels"):
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source / name)
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check"]
    here = ["--no-deps", "--no-build-isolation", "-w", str(tmp_path), str(source)]
    subprocess.run([*pip, *here], check=True)
    with zipfile.ZipFile(next(tmp_path.glob("*.whl"))) as wheel:
        names = [name for name in wheel.namelist() if name.endswith(".py")]
    host = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "warpdem").rglob("*.py")
        if path.parent.name != "kernels"
    }
    device = {f"warpdem/kernels/{path.name}" for path in (ROOT / "kernels").glob("*.py")}

    assert sorted(names) == sorted(host | device)
