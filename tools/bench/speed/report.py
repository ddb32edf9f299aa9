"""Results as one Markdown table, JSON and a plot."""

from __future__ import annotations

import json
import os
import platform
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

Cell = str | int | float | None


@dataclass(frozen=True)
class Table:
    """Rows under a title.

    Attributes:
        title: What was measured.
        columns: Their names.
        rows: Values; None is shown as a dash.
        notes: Sentences below: what differs, what was skipped.
        curve: Names of the columns x, y and of those that tell curves apart, for the plot.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()
    curve: tuple[str, str, str] | None = None

    def markdown(self) -> str:
        """As text."""
        shown = [self.columns, *([_shown(cell) for cell in row] for row in self.rows)]
        widths = [max(len(row[k]) for row in shown) for k in range(len(self.columns))]
        lines = [_line(row, widths) for row in shown]
        rule = "|" + "|".join("-" * (width + 2) for width in widths) + "|"
        notes = [f"- {note}" for note in self.notes]
        return "\n".join([f"### {self.title}", "", lines[0], rule, *lines[1:], "", *notes, ""])

    def records(self) -> list[dict[str, Cell]]:
        """Each row by the names of its columns."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
    return f"| {' | '.join(cells)} |"


def _shown(cell: Cell) -> str:
    if cell is None:
        return "-"
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)


def machine() -> dict[str, Any]:
    """What it was measured on."""
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "python": platform.python_version(),
        "cores": os.cpu_count(),
        "load": [round(load, 2) for load in os.getloadavg()],
    }


def write_json(file: Path, tables: Iterable[Table]) -> None:
    """All tables, with the machine."""
    found = [
        {"title": table.title, "rows": table.records(), "notes": table.notes} for table in tables
    ]
    whole = {"machine": machine(), "tables": found}
    file.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")


def write_markdown(file: Path, tables: Iterable[Table]) -> None:
    """All tables, one after the other."""
    file.write_text("\n".join(table.markdown() for table in tables), encoding="utf-8")


def write_plot(file: Path, tables: Iterable[Table]) -> None:
    """A panel for each table that has curves or bars; needs matplotlib (extra ``dev``)."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - an extra, for plots alone

    drawn = [table for table in tables if table.curve]
    figure = Figure(figsize=(7.0, 4.5 * max(1, len(drawn))), layout="constrained")
    for k, table in enumerate(drawn, 1):
        axes = figure.add_subplot(len(drawn), 1, k)
        axes.set_title(table.title)
        _draw(axes, table)
    figure.savefig(file, dpi=120)


def _draw(axes: Any, table: Table) -> None:
    x, y, kind = table.curve or ("", "", "")
    rows = [row for row in table.records() if row[y] is not None]
    for name in dict.fromkeys(str(row[kind]) for row in rows):
        mine = [row for row in rows if str(row[kind]) == name]
        axes.plot([row[x] for row in mine], [row[y] for row in mine], "o-", label=name)
    if rows and not isinstance(rows[0][x], str):
        axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
