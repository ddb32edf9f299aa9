"""Cases, settings and programs of ``precision.py``: run time against error.

Scenes and closed forms are shared with the tests, which are found through the path.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path += [str(ROOT / "tests" / part) for part in (".", "physics", "rockfall")]

from precision_cases import hard, impacts, sliding, standing, tumbling, turning  # noqa: E402

PARTS = (impacts, turning, sliding, standing, tumbling, hard)
CASES = {case.name: case for part in PARTS for case in part.CASES}
