"""A quick look at the results (map.png): relief, what passes, paths, deposits, barriers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.output.durable import swap
from warpdem.output.map_cover import cover, names
from warpdem.output.relief import Window, relief
from warpdem.rockfall.hazard import columns, spread

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray
    from warpdem.rockfall.site import Site
    from warpdem.rockfall.tally import Tally
    from warpdem.rockfall.trace import Trace

DOTS = 5000
"""Deposits that are drawn at most."""

_INK = "#202124"
_BARRIER = "#0b5fd0"
_MARGIN = 0.06  # of the longer side of what is shown
_PANEL = 7.2  # inches along a panel's longer side
_PER_UNIT = {"reach_probability": 100.0, "energy_q95": 1e-3}  # percent, kJ
_PANELS = (
    ("reach_probability", "Reach probability", "share of the trajectories [%]", "YlGnBu"),
    ("energy_q95", "Kinetic energy, 95 % quantile", "energy [kJ]", "YlOrRd"),
)
_TITLE, _HEADING, _SMALL = 13, 10.5, 8  # points


def write_map(
    path: Path,
    site: Site,
    tally: Tally,
    *,
    title: str,
    traces: Sequence[Trace],
    deposits: FloatArray,
) -> None:
    """Draw the map.

    Args:
        path: The PNG file, replaced once the new one is whole.
        site: The ground, its barriers and cells.
        tally: Of all trajectories.
        title: Of the scene.
        traces: Paths to draw.
        deposits: Where trajectories came to rest, local x, y [m], shape [n, 2]; the first ``DOTS``
            are drawn.

    Raises:
        OSError: The disk is full, or the folder cannot be written.
    """
    # a figure of its own: no window, no global state
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415 - takes a second
    from matplotlib.figure import Figure  # noqa: PLC0415 - the same

    window = _window(site, tally, traces)
    wide, high = window.east - window.west, window.north - window.south
    beside = high > 0.8 * wide
    scale = _PANEL / max(wide, high)
    one = np.array([wide * scale + 1.6, high * scale + 0.9])
    size = one * ([2, 1] if beside else [1, 2]) + [0.0, 0.8]
    figure = Figure(figsize=(float(size[0]), float(size[1])), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(*((1, 2) if beside else (2, 1)), sharex=True, sharey=True)
    shown = {name: values for name, values in columns(tally) if name in _PER_UNIT}
    for axes, (name, heading, label, colours) in zip(panels, _PANELS, strict=True):
        _ground(axes, site, window)
        values = spread(shown[name], tally, site.results) * _PER_UNIT[name]
        _colours(axes, values, site, label=label, colours=colours)
        cover(axes, site)
        _barriers(axes, site)
        names(axes, site, window, _BARRIER)
        axes.set_title(heading, fontsize=_HEADING, color=_INK)
        _frame(axes, site, window)
    _deposits(panels[0], site, deposits[:DOTS])
    _paths(panels[1], site, traces)
    _furniture(panels[0], site, window)
    _headings(figure, site, tally, title, len(deposits))
    swap(path, lambda part: figure.savefig(part, format="png", dpi=150))


def _window(site: Site, tally: Tally, traces: Sequence[Trace]) -> Window:
    """What rocks reached, and a margin, within the cells of results."""
    grid = site.results
    row, column = np.divmod(tally.cell, grid.columns)
    x = [grid.x + grid.cell * (column + 0.5), *(trace.position[:, 0] for trace in traces)]
    y = [grid.y + grid.cell * (row + 0.5), *(trace.position[:, 1] for trace in traces)]
    east, north = grid.x + grid.columns * grid.cell, grid.y + grid.rows * grid.cell
    across, along = np.concatenate(x), np.concatenate(y)
    if not len(across):
        return Window(grid.x, east, grid.y, north)
    longer = max(np.ptp(across), np.ptp(along), 10.0 * grid.cell)
    spare = _MARGIN * longer
    # a strip is hard to read: half as wide as long at least
    wide, high = (max(0.0, 0.5 * longer - np.ptp(each)) / 2.0 + spare for each in (across, along))
    return Window(
        float(max(grid.x, across.min() - wide)),
        float(min(east, across.max() + wide)),
        float(max(grid.y, along.min() - high)),
        float(min(north, along.max() + high)),
    )


def _ground(axes: Any, site: Site, window: Window) -> None:
    """Hillshade and contour lines."""
    ground = relief(site, window)
    if ground is None:
        return
    x, y = ground.x + site.origin[0], ground.y + site.origin[1]
    half_x, half_y = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    extent = (x[0] - half_x, x[-1] + half_x, y[0] - half_y, y[-1] + half_y)
    axes.imshow(
        ground.shade(), cmap="gray", vmin=-1.6, vmax=1.1, origin="lower", extent=extent,
        interpolation="bilinear", zorder=0,
    )  # fmt: skip
    heights = np.ma.masked_invalid(ground.heights)
    step = _round(float(np.ptp(heights)) / 12.0) if heights.count() else 0.0
    if step > 0.0:
        levels = np.arange(np.ceil(heights.min() / step), heights.max() / step) * step
        lines = axes.contour(
            x, y, heights, levels, colors=_INK, linewidths=0.35, alpha=0.45, zorder=2
        )
        axes.clabel(lines, lines.levels[::2], fontsize=6, fmt="%g")


def _colours(axes: Any, values: FloatArray, site: Site, *, label: str, colours: str) -> None:
    """A raster in colours by the root of its values, and what they mean."""
    from matplotlib.colors import PowerNorm  # noqa: PLC0415 - takes a second

    known = np.ma.masked_invalid(values)
    if not known.count() or not known.max() > 0.0:
        return
    norm = PowerNorm(0.5, 0.0, float(known.max()))
    grid = site.results
    west, south = site.origin[0] + grid.x, site.origin[1] + grid.y
    extent = (west, west + grid.columns * grid.cell, south, south + grid.rows * grid.cell)
    image = axes.imshow(
        known, cmap=colours, norm=norm, origin="lower", extent=extent, interpolation="nearest",
        alpha=0.78, zorder=1,
    )  # fmt: skip
    bar = axes.figure.colorbar(image, ax=axes, shrink=0.75, pad=0.015, aspect=32)
    bar.set_label(label, fontsize=_SMALL, color=_INK)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.tick_params(labelsize=_SMALL, width=0.5)
    bar.solids.set_alpha(1.0)
    bar.outline.set_linewidth(0.4)


def _barriers(axes: Any, site: Site) -> None:
    """Barriers that stop rocks as full lines, those that record as broken ones."""
    for barrier in site.barriers:
        x, y = (barrier.line + site.origin[:2]).T
        stops = barrier.capacity > 0.0
        axes.plot(x, y, color="white", linewidth=3.6, solid_capstyle="butt", zorder=4)
        axes.plot(
            x, y, color=_BARRIER, linewidth=1.8, linestyle="-" if stops else (0, (4, 2)), zorder=5,
            label="barrier" if stops else "recording line",
        )  # fmt: skip


def _deposits(axes: Any, site: Site, deposits: FloatArray) -> None:
    x, y = (deposits + site.origin[:2]).T
    size = float(np.clip(3000.0 / max(len(x), 1), 1.5, 14.0))
    dots = {"color": "#d81b60", "edgecolor": "white"}
    axes.scatter(x, y, s=size, linewidth=0.15, zorder=6, **dots)
    if len(x):  # a dot of its own for the legend: those of the map may be tiny
        axes.scatter([], [], s=16.0, linewidth=0.3, label="deposits", **dots)


def _paths(axes: Any, site: Site, traces: Sequence[Trace]) -> None:
    faint = float(np.clip(20.0 / max(len(traces), 1), 0.25, 0.9))
    for trace in traces:
        x, y = (trace.position[:, :2] + site.origin[:2]).T
        axes.plot(x, y, color=_INK, linewidth=0.6, alpha=faint, zorder=6, label="trajectories")
        axes.plot(
            *(x[:1], y[:1]), "o", color="white", markersize=3.2, markeredgecolor=_INK,
            markeredgewidth=0.5, zorder=7, label="starts",
        )  # fmt: skip


def _frame(axes: Any, site: Site, window: Window) -> None:
    from matplotlib.ticker import FuncFormatter, MaxNLocator  # noqa: PLC0415 - takes a second

    east, north = site.origin[0], site.origin[1]
    axes.set_xlim(window.west + east, window.east + east)
    axes.set_ylim(window.south + north, window.north + north)
    axes.set_aspect("equal")
    spaced = FuncFormatter(lambda value, _: f"{value:,.0f}".replace(",", "\u2009"))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10], integer=True))
        axis.set_major_formatter(spaced)
    axes.tick_params(labelsize=7, color=_INK, width=0.5, direction="in", top=True, right=True)
    axes.tick_params(axis="y", labelrotation=90)
    for label in axes.get_yticklabels():
        label.set_verticalalignment("center")
    for spine in axes.spines.values():
        spine.set_linewidth(0.6)


def _furniture(axes: Any, site: Site, window: Window) -> None:
    """Scale bar in the lower left corner and north arrow in the upper one."""
    from matplotlib.patheffects import withStroke  # noqa: PLC0415 - takes a second

    halo = [withStroke(linewidth=2.2, foreground="white", alpha=0.9)]
    wide, high = window.east - window.west, window.north - window.south
    length = _round(0.22 * wide)
    x = window.west + site.origin[0] + 0.04 * wide
    y = window.south + site.origin[1] + 0.035 * high
    thick = 0.008 * max(wide, high)
    for part, colour in enumerate((_INK, "white")):
        axes.fill(
            x + 0.5 * length * (part + np.array([0, 1, 1, 0])), y + thick * np.array([0, 0, 1, 1]),
            facecolor=colour, edgecolor=_INK, linewidth=0.6, zorder=9,
        )  # fmt: skip
    words = f"{length / 1000:g} km" if length >= 1000.0 else f"{length:g} m"
    text = axes.text(
        x + 0.5 * length, y + 1.8 * thick, words, ha="center", va="bottom", fontsize=8, zorder=9
    )
    arrow = axes.annotate(
        "N", (0.06, 0.97), (0.06, 0.89), xycoords="axes fraction", ha="center", va="center",
        fontsize=10, fontweight="bold", color=_INK, zorder=9,
        arrowprops={"arrowstyle": "-|>", "color": _INK, "linewidth": 1.2, "mutation_scale": 14},
    )  # fmt: skip
    for words_drawn in (text, arrow):
        words_drawn.set_path_effects(halo)


def _headings(figure: Any, site: Site, tally: Tally, title: str, deposits: int) -> None:
    """Title above, legend below; entries of the same words are one."""
    place = f", {site.crs}, in metres" if site.crs else ", in metres"
    some = f", the first {DOTS:,} deposits drawn" if deposits > DOTS else ""
    counted = f"{tally.trajectories:,} trajectories{some}{place}"
    figure.suptitle(f"{title}\n{counted}", fontsize=_TITLE, color=_INK)
    found = {}
    for axes in figure.axes:
        handles, labels = axes.get_legend_handles_labels()
        found |= dict(zip(labels, handles, strict=True))
    if found:
        legend = figure.legend(
            found.values(), found.keys(), loc="outside lower center", ncols=7, fontsize=_SMALL,
            frameon=False,
        )  # fmt: skip
        for handle in legend.legend_handles:
            handle.set_alpha(1.0)


def _round(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a value; 0 for 0."""
    if not value > 0.0:
        return 0.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * 1.0001))
