"""Cases, settings and programs of ``precision.py``: run time against error."""

from precision_cases import hard, impacts, sliding, standing, tumbling, turning

PARTS = (impacts, turning, sliding, standing, tumbling, hard)
CASES = {case.name: case for part in PARTS for case in part.CASES}
