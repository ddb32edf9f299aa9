"""Builds every kernel of a scene before the first step, and says so."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

from warpdem.bonding import release_kernel
from warpdem.kernels.bond_bound import bond_bound
from warpdem.kernels.driving import wall_frequency
from warpdem.kernels.guarding import measure_rush
from warpdem.kernels.images import find_images, wrap_bodies
from warpdem.kernels.integrate import orient
from warpdem.kernels.measures import frequency_bound
from warpdem.kernels.neighbours import find_partners, incidence_keys
from warpdem.kernels.sphere_forces import locate_contacts
from warpdem.lists import history_kernel
from warpdem.loading import load_kernels
from warpdem.materials import try_custom_laws
from warpdem.search import candidate_kernels
from warpdem.sleeping import sleep_kernels
from warpdem.stages import advance, after_drift, cell_drift, cycle, laws

if TYPE_CHECKING:
    from collections.abc import Callable

    import warp as wp

    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import Share, State

# kernels that take seconds to compile, and those of a module that every scene has and takes least
SLOW = ("pair forces", "bond forces", "count candidates", "fill candidates")
QUICK = ("halt", "orient")


def kernels_of(model: Model, state: State, lists: Lists, share: Share) -> dict[str, wp.Kernel]:
    """Every kernel that the scene will launch, by name."""
    has = model.features
    stages = cycle(model, state, lists, share, 0.0)
    if has.deforming:
        stages = (*stages, *cell_drift(model, state, share, 0.0))
        alone = after_drift(model, state, lists, share, 0.0)
        stages = (*stages, *(replace(s, name="cell alone") for s in alone if s.name == "cell"))
    kernels: dict[str, wp.Kernel] = {stage.name: stage.kernel for stage in stages}
    kernels["orient"] = orient
    if has.first_step == "gravity":
        kernels["first kick"] = advance(
            model, state, lists, share, 0.0, kicks=True, drifts=False, contacts=False
        ).kernel
    if not has.contacts:
        return kernels
    for fill in (False, True):
        word = "fill" if fill else "count"
        kernels[f"{word} pairs"] = find_partners(
            fill=fill, large=has.large, surfaces=has.surfaces, bonds=has.bonds
        )
        if has.periodic:
            kernels[f"{word} pairs"] = find_images(
                fill=fill, large=has.large, surfaces=has.surfaces, bonds=has.bonds
            )
            kernels["wrap"] = wrap_bodies
    for number, kernel in enumerate(candidate_kernels(has), 1):
        kernels[f"candidates {number}"] = kernel
    if has.single:
        kernels["locate"] = locate_contacts(laws(has))
    kernels["history"] = history_kernel(has)
    kernels["incidence"] = incidence_keys
    kernels |= sleep_kernels(has)
    kernels["measures of speed"] = measure_rush(periodic=has.periodic)
    kernels["measures"] = frequency_bound(has.partnership, periodic=has.periodic)
    if has.controlled:
        kernels["wall measures"] = wall_frequency
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
    """Load the modules of all kernels, compiling what the cache lacks; returns the seconds.

    Raises:
        SceneError: A custom law cannot be built.
    """
    begin = time.perf_counter()
    kernels = kernels_of(model, state, lists, share)
    ordered = sorted(kernels.items(), key=lambda named: (named[0] in QUICK, named[0] not in SLOW))
    try:
        load_kernels(ordered, model.device, progress)
    except Exception:  # Warp raises whatever its parser met
        try_custom_laws(model.features.custom, model.device)
        raise
    return time.perf_counter() - begin
