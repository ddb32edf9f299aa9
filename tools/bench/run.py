"""Speed beside peers, scaling, and what a term costs that is not used.

    python tools/bench/run.py [CASE ...] [--repeats N] [--threads N ...] [--folder DIR]
    python tools/bench/run.py cubes_to_rest --peers-python PYTHON
    python tools/bench/run.py --scaling [--most N]
    python tools/bench/run.py --skips [TERM ...]
           each with [--json FILE] [--markdown FILE] [--plot FILE]

Cases are data in speed/cases.py. Each starts from a packing that warpdem settled once (kept in
--folder) and gives to all programs; these run in turn, then again, each timing its own loop.
cubes_to_rest compares programs at equal error instead (speed/rest.py). Programs that are not
installed are named and skipped: apt-get install yade liggghts; pip install mujoco pybullet, in a
Python of their own (PYTHON); Rockable by --rockable PATH.
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
from speed.cases import CASES, Case, case_named, with_peer  # noqa: E402 - the same
from speed.compare import compare  # noqa: E402 - the same
from speed.packings import Folder  # noqa: E402 - the same
from speed.peers.rockable import rockable  # noqa: E402 - the same
from speed.rest import to_rest  # noqa: E402 - the same
from speed.scaling import scaling  # noqa: E402 - the same
from speed.skips import TERMS, skips  # noqa: E402 - the same

REST = "cubes_to_rest"


def parser() -> argparse.ArgumentParser:
    """Of the command line."""
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    names = [*(case.name for case in CASES), REST]
    words.add_argument("case", nargs="*", metavar="CASE", help=", ".join(names))
    words.add_argument("--scaling", action="store_true", help="in bodies and threads instead")
    words.add_argument("--most", type=int, default=10**6, help="bodies of --scaling")
    terms = ", ".join(term.name for term in TERMS)
    words.add_argument("--skips", nargs="*", metavar="TERM", help=f"terms instead: {terms}")
    words.add_argument("--rockable", metavar="PATH", help="its command")
    words.add_argument("--peers-python", metavar="PYTHON", default=sys.executable)
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
    if asked.scaling:
        return [scaling(asked.threads or (1, 2), most=asked.most)]
    if asked.skips is not None:
        return [skips(folder, repeats=asked.repeats, names=asked.skips)]
    names = asked.case or [*(case.name for case in CASES), REST]
    cases = [chosen(name, asked) for name in names if name != REST]
    tables = [compare(cases, folder, repeats=asked.repeats, scale=asked.scale)] if cases else []
    return tables + ([to_rest(asked.peers_python)] if REST in names else [])


def chosen(name: str, asked: argparse.Namespace) -> Case:
    """A case as the command line has it."""
    case = case_named(name)
    if any(other.peer == "Rockable" for other in case.recorded):
        case = with_peer(case, rockable(asked.rockable))
    return replace(case, threads=tuple(asked.threads)) if asked.threads else case


if __name__ == "__main__":
    main()
