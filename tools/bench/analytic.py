"""Runs the analytic reference cases through the simulator and holds the results to their gates.

    python tools/bench/analytic.py [FOLDER] [--family NAME ...] [--all]

FOLDER holds the JSON files of ../shared/reference/analytic (default). One line a case: the quantity
that comes nearest to its gate; with --all one line a quantity. Exits with 1 where one fails.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "physics"), str(Path(__file__).parent)]

import analytic_arches  # noqa: E402 - found through the path above
import analytic_bodies  # noqa: E402 - the same
import analytic_bonds  # noqa: E402 - the same
import analytic_impacts  # noqa: E402 - the same
import analytic_tops  # noqa: E402 - the same

if TYPE_CHECKING:
    from analytic_row import Row

DEFAULT = ROOT.parent / "shared" / "reference" / "analytic"
FAMILIES = {
    **analytic_impacts.FAMILIES,
    **analytic_bodies.FAMILIES,
    **analytic_tops.FAMILIES,
    **analytic_bonds.FAMILIES,
    **analytic_arches.FAMILIES,
}


def cases_of(folder: Path, family: str) -> list[dict[str, Any]]:
    return json.loads((folder / f"{family}.json").read_text())["cases"]


def rows_of(folder: Path, family: str) -> list[Row]:
    """Every quantity of every case of a family, and the family's own."""
    return list(FAMILIES[family](cases_of(folder, family), folder))


def line(row: Row, count: int) -> str:
    gate = "" if row.gate is None else f"{row.gate:9.1e}"
    more = f"  [worst of {count}]" if count > 1 else ""
    return (
        f"{row.case:24} {row.quantity:30} {row.got:18.10g} {row.expected:18.10g} "
        f"{row.error:9.1e} {gate:9}  {row.verdict}{more}{'  ' * bool(row.note)}{row.note}"
    )


def show(rows: list[Row], *, every: bool) -> None:
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.case, []).append(row)
    for group in groups.values():
        # the order belongs to the case; of what else was measured, the worst
        orders = [row for row in group if row.quantity.startswith("order")]
        others = [row for row in group if row not in orders]
        worst = sorted(others, key=lambda row: -row.strain)[:1]
        shown = group if every else worst + orders
        for row in shown:
            print(line(row, len(others) if row in worst and not every else 1), flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=DEFAULT)
    parser.add_argument("--family", nargs="*", choices=FAMILIES, default=list(FAMILIES))
    parser.add_argument("--all", action="store_true", help="one line a quantity")
    options = parser.parse_args()
    head = ("case", "quantity", "got", "expected", "error", "gate")
    print("{:24} {:30} {:>18} {:>18} {:>9} {:>9}".format(*head))
    failed = total = 0
    for family in options.family:
        since = time.perf_counter()
        rows = rows_of(options.folder, family)
        show(rows, every=options.all)
        print(f"# {family}: {time.perf_counter() - since:.1f} s", flush=True)
        total += len(rows)
        failed += sum(row.verdict == "FAIL" for row in rows)
    print(f"{total} quantities, {failed} FAIL")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
