"""What a site, its rocks and their starts allow but probably do not mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix
from warpdem.rockfall.gaps import enclosed

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.rockfall.flights import Starts
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site, Trees


def gaps(site: Site) -> Iterator[str]:
    """Holes within the terrain."""
    known = site.ground.known
    count = 0 if known.all() else int(enclosed(known).sum())
    if count:
        yield (
            f"{count} cells without data lie amid the ground: a rock whose centre comes over one "
            'ends there as "left"; fill them in the terrain, or expect that'
        )


def large_rocks(site: Site, rocks: Sequence[Rock]) -> Iterator[str]:
    """Rocks for which the terrain is too fine."""
    ground = site.ground
    cell = ground.grid.cell
    kind = f"a terrain of {cell:g} m cells"
    if ground.facets is not None:
        kind = f"triangles of about {cell:g} m"
    for rock in rocks:
        if rock.bound <= cell:
            continue
        slow = (
            f", and every vertex is held against the ground at every step, as its slopes are known "
            f"for {ground.reach:g} m around alone, which is slow"
            if rock.bound > ground.reach
            else ""
        )
        yield (
            f'rock "{rock.name}" is {2.0 * rock.bound:.3g} m across on {kind}: what stands up '
            f"between its vertices is not seen{slow}; take a coarser terrain, or more vertices"
        )


def in_trunks(
    site: Site, rocks: Sequence[Rock], starts: Starts, *, releases: bool
) -> Iterator[str]:
    """Releases, or bodies, of which rocks start within a trunk.

    Args:
        site: With or without trunks.
        rocks: By number.
        starts: To be looked at.
        releases: Whether ``starts.release`` numbers the [[release]] sections of a scene.
    """
    if site.trees is None:
        return
    within = within_trunks(site.trees, rocks, starts)
    source = starts.release if releases else np.zeros_like(starts.release)
    for number in np.unique(source[within]):
        mine = np.flatnonzero(within & (source == number))
        x, y = starts.position[mine[0], :2] + site.origin[:2]
        name = f"release[{number}]" if releases else "[[body]]"
        yield (
            f"{name}: {len(mine)} of {int((source == number).sum())} rocks start within a trunk, "
            f"the first at ({x:.2f}, {y:.2f}); move them, or leave the [[tree]] out"
        )


def within_trunks(trees: Trees, rocks: Sequence[Rock], starts: Starts) -> BoolArray:
    """Whether each start overlaps a trunk, shape [n]."""
    order = np.argsort(trees.position[:, 0], kind="stable")
    place, radius, top = trees.position[order], trees.radius[order], trees.top[order]
    bound = np.array([rock.bound for rock in rocks])[starts.rock]
    reach = bound + radius.max()
    first = np.searchsorted(place[:, 0], starts.position[:, 0] - reach)
    last = np.searchsorted(place[:, 0], starts.position[:, 0] + reach, side="right")
    within = np.zeros(len(starts.id), bool)
    for row in np.flatnonzero(last > first):
        some = slice(first[row], last[row])
        away = np.linalg.norm(place[some] - starts.position[row, :2], axis=1)
        near = first[row] + np.flatnonzero(away < bound[row] + radius[some])
        rock, turn = rocks[starts.rock[row]], matrix(starts.orientation[row])
        points = rock.vertices @ turn.T + starts.position[row]
        within[row] = any(
            _overlaps(points - [*place[k], top[k]], rock, float(radius[k])) for k in near
        )
    return within


def _overlaps(points: FloatArray, rock: Rock, radius: float) -> bool:
    """Whether a rock overlaps a trunk whose upper end is the origin; its vertices, shape [n, 3].

    Seen from above a rock that does not cover the axis is nearest to it with one of its edges.
    """
    a, b = points[rock.edges.T]
    along = b - a
    length = (along[:, :2] ** 2).sum(axis=1)
    part = -(a[:, :2] * along[:, :2]).sum(axis=1) / np.where(length > 0.0, length, 1.0)
    nearest = a + np.clip(part, 0.0, 1.0)[:, None] * along
    distance = np.hypot(nearest[:, 0], nearest[:, 1])
    k = int(np.argmin(distance))
    if distance[k] < radius + rock.rounding:
        return bool(nearest[k, 2] <= 0.0)
    return _covers_origin(points[:, :2]) and bool(points[:, 2].min() - rock.rounding <= 0.0)


def _covers_origin(plan: FloatArray) -> bool:
    """Whether the origin lies within the hull of points, which no half plane then holds."""
    angle = np.sort(np.arctan2(plan[:, 1], plan[:, 0]))
    return bool(np.diff(angle, append=angle[0] + 2.0 * np.pi).max() < np.pi)
