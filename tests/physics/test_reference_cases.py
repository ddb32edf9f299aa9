"""All analytic reference cases, where the folder beside the repository is there."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT.parent / "shared" / "reference" / "analytic"
sys.path.append(str(ROOT / "tools" / "bench"))

from analytic import FAMILIES, rows_of  # noqa: E402 - a program, found through the path above

pytestmark = pytest.mark.slow  # about three minutes in all


@pytest.mark.parametrize("family", FAMILIES)
def test_cases_of_the_reference_pass_their_gates(family):
    if not FOLDER.is_dir():
        pytest.skip(f"{FOLDER} is not there: the reference values of {family} are not at hand")
    failed = [row for row in rows_of(FOLDER, family) if row.verdict == "FAIL"]
    assert not failed, "\n".join(map(str, failed))
