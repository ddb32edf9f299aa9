"""Speed beside peers, scaling, and what a term costs that is not used.

    python tools/bench/run.py [CASE ...] [--repeats N] [--threads N ...] [--folder DIR]
                              [--json FILE] [--markdown FILE] [--plot FILE]

Cases are data in speed/cases.py. Each starts from a packing that warpdem settled once (kept in
--folder) and gives to all programs; these run in turn, then again, each timing its own loop.
Programs that are not installed are named and skipped.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

from speed import report  # noqa: E402 - after the path
from speed.cases import CASES, case_named  # noqa: E402 - the same
from speed.compare import compare  # noqa: E402 - the same
from speed.packings import Folder  # noqa: E402 - the same


def parser() -> argparse.ArgumentParser:
    """Of the command line."""
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [case.name for case in CASES]
    words.add_argument("case", nargs="*", choices=[[], *names], help="default: all")
    words.add_argument("--repeats", type=int, default=5)
    words.add_argument("--threads", type=int, nargs="+", help="default: those of the case")
    words.add_argument("--scale", type=float, default=1.0, help="of the number of steps")
    words.add_argument("--folder", type=Path, help="keeps settled packings; default: none kept")
    words.add_argument("--json", type=Path)
    words.add_argument("--markdown", type=Path)
    words.add_argument("--plot", type=Path)
    return words


def main() -> None:
    asked = parser().parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Folder(asked.folder or Path(place))
        folder.path.mkdir(parents=True, exist_ok=True)
        tables = measured(asked, folder)
    for table in tables:
        print(table.markdown())
    written = {"json": asked.json, "markdown": asked.markdown, "plot": asked.plot}
    for kind, file in written.items():
        if file:
            getattr(report, f"write_{kind}")(file, tables)


def measured(asked: argparse.Namespace, folder: Folder) -> list[report.Table]:
    """The tables that were asked for."""
    cases = [case_named(name) for name in asked.case] or list(CASES)
    if asked.threads:
        cases = [replace(case, threads=tuple(asked.threads)) for case in cases]
    return [compare(cases, folder, repeats=asked.repeats, scale=asked.scale)]


if __name__ == "__main__":
    main()
