"""What stands on the ground, on a map: forest, trunks and the names of barriers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from warpdem.output.relief import Window
    from warpdem.rockfall.site import Site

_FOREST = "#2e6b34"
_APART = 0.04  # of the longer side: names nearer to each other are drawn one above the other


def cover(axes: Any, site: Site) -> None:
    """Forest as dots within an outline, trunks as rings."""
    if site.stand_of is not None and (site.stand_of >= 0).any():
        _forest(axes, site, site.stand_of >= 0)
    if site.trees is not None:
        x, y = (site.trees.position + site.origin[:2]).T
        axes.scatter(
            x, y, s=16.0, facecolor="none", edgecolor=_FOREST, linewidth=1.1, zorder=3,
            label="trunks",
        )  # fmt: skip


def _forest(axes: Any, site: Site, inside: np.ndarray) -> None:
    grid = site.ground.grid
    # a border of its own, so that the outline is closed at the edge of the ground
    share = np.pad(inside, 1).astype(float)
    x = site.origin[0] + grid.x + grid.cell * (np.arange(grid.columns + 2) - 0.5)
    y = site.origin[1] + grid.y + grid.cell * (np.arange(grid.rows + 2) - 0.5)
    dots = axes.contourf(x, y, share, [0.5, 1.5], colors="none", hatches=[".."], zorder=3)
    dots.set(facecolor="none", edgecolor=(_FOREST, 0.6), linewidth=0.0)
    axes.contour(x, y, share, [0.5], colors=_FOREST, linewidths=1.0, zorder=3)
    axes.plot([], [], color=_FOREST, linewidth=1.0, label="forest")


def names(axes: Any, site: Site, window: Window, colour: str) -> None:
    """The name of each barrier beside the northern end of what is shown of its line."""
    from matplotlib.patheffects import withStroke  # noqa: PLC0415 - takes a second

    halo = [withStroke(linewidth=2.0, foreground="white", alpha=0.9)]
    apart = _APART * max(window.east - window.west, window.north - window.south)
    taken: list[np.ndarray] = []
    for barrier in site.barriers:
        place = barrier.line[np.argmax(barrier.line[:, 1])].copy()
        place[1] = min(place[1], window.north - apart)
        place[0] = np.clip(place[0], window.west, window.east)
        while any(np.abs(place - other).max() < apart for other in taken):
            place[1] -= apart
        taken.append(place)
        words = axes.annotate(
            barrier.name, place + site.origin[:2], (4, 0), textcoords="offset points",
            fontsize=7.5, color=colour, va="center", zorder=8, annotation_clip=True,
        )  # fmt: skip
        words.set_path_effects(halo)
