"""Cases, settings and programs of ``precision.py``: run time against error."""

from precision_cases import impacts, turning

CASES = {case.name: case for part in (impacts, turning) for case in part.CASES}
