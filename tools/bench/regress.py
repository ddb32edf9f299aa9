"""Whether a step has grown: instructions per body-step against those in regression.json.

    python tools/bench/regress.py [CASE ...] [--file FILE] [--write]

Small cases run under valgrind's callgrind (apt-get install valgrind), which counts the steps alone:
counts do not depend on what else the machine does. Exit status 1 where one grew by more than 3 %, 2
where there is no valgrind or nothing to compare with. --write keeps the counts, compares nothing.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

from speed import counting  # noqa: E402 - after the path
from speed.report import Table  # noqa: E402 - the same

FILE = Path(__file__).with_name("regression.json")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="*", metavar="CASE", help=", ".join(counting.SMALL))
    parser.add_argument("--file", type=Path, default=FILE)
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    if why := counting.missing():
        print(f"{why}: apt-get install valgrind")
        return 2
    names = asked.case or list(counting.SMALL)
    now = {name: counting.count(counting.SMALL[name]) for name in names}
    then = counting.read(asked.file)
    rows = tuple(counting.judged(name, counts, then.get(name)) for name, counts in now.items())
    print(Table("Instructions per body-step", counting.COLUMNS, rows).markdown())
    if asked.write:
        counting.write(asked.file, then | now)
        return 0
    return status([row[-1] for row in rows])


def status(words: list[object]) -> int:
    """Exit status of the verdicts of all cases."""
    if None in words:
        return 2
    return 1 if "GREW" in words else 0


if __name__ == "__main__":
    sys.exit(main())
