"""Curves as a table and as pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
import matplotlib.pyplot as plt

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from precision_cases.case import Case
    from precision_cases.curves import Curve

LOOKS = {
    "default": ("#000000", "o", "-"),
    "lagged": ("#d55e00", "v", "-"),
    "rkmk4": ("#0072b2", "s", "-"),
    "taylor": ("#cc79a7", "^", "-"),
    "mixed": ("#009e73", "D", "-"),
    "sum": ("#56b4e9", "<", "-"),
    "pnorm": ("#e69f00", ">", "-"),
    "rockable": ("#b00000", "x", "-"),
    "nonsmooth": ("#7a4fbf", "P", "-"),
    "nonsmooth, stride .03": ("#7a4fbf", "*", ":"),
    "YADE": ("#666666", "1", "--"),
    "LIGGGHTS": ("#999999", "2", "--"),
    "MuJoCo": ("#1b7f3b", "3", "--"),
    "PyBullet": ("#8c564b", "4", "--"),
    "Kratos": ("#bcbd22", "+", "--"),
}
HEAD = f"{'case':16s} {'setting':22s} {'order':>5s}  {'ms at 1e-3':>10s} {'steps':>7s}"
HEAD += f"  {'ms at 1e-6':>10s} {'steps':>7s}  {'coarsest':>8s} {'finest':>8s}"


def row(curve: Curve) -> str:
    """A line of the table."""
    words = f"{curve.case:16s} {curve.name:22s} {_number(curve.order, '5.1f', 5)}"
    for wanted in (1e-3, 1e-6):
        words += f"  {_number(1e3 * curve.cost(wanted), '10.3g', 10)}"
        words += f" {_number(curve.steps_at(wanted), '7.0f', 7)}"
    least = min(curve.error)
    words += f"  {_number(curve.error[0], '8.1e', 8)} {_number(least, '8.1e', 8)}"
    return f"{words}  {curve.note}".rstrip()


def _number(value: float, form: str, width: int) -> str:
    return format(value, form) if np.isfinite(value) else "-".rjust(width)


def draw(case: Case, curves: Sequence[Curve], file: Path) -> None:
    """A log-log diagram of one case."""
    figure, axes = plt.subplots(figsize=(6.0, 4.2), layout="constrained")
    for curve in curves:
        e, s = np.array(curve.error), np.array(curve.seconds)
        good = np.isfinite(e) & np.isfinite(s)
        if not good.any():
            continue
        colour, marker, line = LOOKS.get(curve.name, ("#444444", ".", ":"))
        order = f" [{curve.order:.1f}]" if np.isfinite(curve.order) else ""
        axes.loglog(
            s[good],
            np.maximum(e[good], 1e-16),
            line,
            color=colour,
            marker=marker,
            markersize=5,
            linewidth=1.2,
            label=curve.name + order,
        )
    for level in (1e-3, 1e-6):
        axes.axhline(level, color="#cccccc", linewidth=0.8, zorder=0)
    axes.set_xlabel("run time [s]")
    axes.set_ylabel("error")
    axes.set_title(f"{case.name}: {case.what}", fontsize=7)
    axes.grid(visible=True, which="major", color="#eeeeee", linewidth=0.6)
    axes.legend(fontsize=7, title="[order]", title_fontsize=7)
    figure.savefig(file, dpi=100)
    plt.close(figure)
