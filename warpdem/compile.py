"""Builds every kernel of a scene before the first step, and says so."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import warp as wp

from warpdem.bonding import release_kernel
from warpdem.kernels.bond_bound import bond_bound
from warpdem.kernels.candidates import find_candidates
from warpdem.kernels.integrate import orient
from warpdem.kernels.matching import carry_history
from warpdem.kernels.measures import frequency_bound
from warpdem.kernels.neighbours import find_partners, incidence_keys
from warpdem.stages import cycle, kick

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import Share, State


def kernels_of(model: Model, state: State, lists: Lists, share: Share) -> dict[str, wp.Kernel]:
    """Every kernel that the scene will launch, by name."""
    has = model.features
    stages = cycle(model, state, lists, share, 0.0)
    kernels: dict[str, wp.Kernel] = {stage.name: stage.kernel for stage in stages}
    kernels["orient"] = orient
    if has.gravity_first:
        kernels["first kick"] = kick(model, state, lists, share, 0.0, contacts=False).kernel
    if not has.contacts:
        return kernels
    for fill in (False, True):
        word = "fill" if fill else "count"
        kernels[f"{word} pairs"] = find_partners(fill=fill, large=has.large, bonds=has.bonds)
        kernels[f"{word} candidates"] = find_candidates(
            fill=fill, polyhedra=has.polyhedra, trees=has.trees
        )
    kernels["history"] = carry_history(rolling=has.rolling)
    kernels["incidence"] = incidence_keys
    kernels["measures"] = frequency_bound
    if has.bonds:
        kernels["release"] = release_kernel(has)
        kernels["measures of bonds"] = bond_bound
    return kernels


def load(
    model: Model,
    state: State,
    lists: Lists,
    share: Share,
    progress: Callable[[str], None],
) -> float:
    """Load the modules of all kernels, compiling what the cache lacks; returns the seconds."""
    begin = time.perf_counter()
    kernels = kernels_of(model, state, lists, share)
    for number, (name, kernel) in enumerate(kernels.items(), 1):
        progress(f"kernels {number}/{len(kernels)}: {name}")
        wp.load_module(kernel.module, device=model.device)
    return time.perf_counter() - begin
