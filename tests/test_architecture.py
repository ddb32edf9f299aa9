"""The rules of the house, held by reading the code's own imports."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
HOST = sorted((ROOT / "warpdem").rglob("*.py"))
# what may import warp on the host: the modules that build, launch and read the device's arrays
DEVICE_SIDE = {
    "allocation",
    "bonding",
    "build",
    "compile",
    "crews",
    "device",
    "device_forces",
    "device_shapes",
    "devices",
    "drives",
    "energy_guard",
    "first_forces",
    "guards",
    "images",
    "lists",
    "loading",
    "materials",
    "model",
    "observe",
    "observe_bonds",
    "periodic",
    "profiled",
    "relaxing",
    "resume",
    "room",
    "search",
    "simulation",
    "sleeping",
    "stages",
    "state",
    "step_bound",
    "stepper",
    "trajectories",
}


def runtime_imports(path: Path) -> set[str]:
    """Modules imported when a file is, at its top level; type checking aside."""
    names: set[str] = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            if node.module == "warpdem":
                names.update(f"warpdem.{alias.name}" for alias in node.names)
    return names


def needs_warp(path: Path) -> bool:
    names = runtime_imports(path)
    # which precision kernels shall have is told before they are imported
    names = names - {"warpdem.kernels.choice"}
    return any(name == "warp" or name.startswith(("warp.", "warpdem.kernels")) for name in names)


def test_only_the_device_side_imports_warp():
    found = {path.stem for path in HOST if path.parent.name != "kernels" and needs_warp(path)}

    assert found <= DEVICE_SIDE


def test_input_geometry_and_output_never_reach_the_device_side():
    reached = {
        path.stem: name
        for path in HOST
        if path.stem not in DEVICE_SIDE
        for name in runtime_imports(path)
        if name.rpartition(".")[2] in DEVICE_SIDE and name.startswith("warpdem.")
    }

    assert reached == {}


def test_kernels_follow_their_rules():
    result = subprocess.run(
        [sys.executable, str(ROOT / "tools" / "lint_kernels.py")],
        capture_output=True,
        text=True,
        check=False,
    )

    assert result.returncode == 0, result.stdout


@pytest.mark.parametrize(
    "what", ["warpdem", "warpdem.checks.check", "warpdem.input.decode", "warpdem.output"]
)
def test_checking_a_scene_does_not_load_warp(what):
    code = f"import sys, {what}; sys.exit('warp' in sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False)

    assert result.returncode == 0


def test_no_file_grows_past_400_lines():
    files = [*HOST, *(ROOT / "kernels").glob("*.py"), *(ROOT / "tests").rglob("*.py")]
    long = {path.name: n for path in files if (n := len(path.read_text().splitlines())) > 400}

    assert long == {}
