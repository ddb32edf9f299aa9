"""The contact laws of a scene: which there are, and what is compiled out."""

from typing import NamedTuple

import warp as wp

# Material.kind; custom laws count on from CUSTOM
HOOKE = 0
AVALANCHE = 1
CUSTOM = 2


class Laws(NamedTuple):
    """What the contacts of a scene need; every field that is False or empty is compiled out."""

    polyhedra: bool  # not only spheres
    convex: bool  # every face is convex
    two_sided: bool  # some open surface acts on both sides
    cones: bool  # some shape restricts the directions of its edges and vertices
    surfaces: bool  # some fixed body is an analytic surface
    central: bool  # normals go through the centres of all bodies that turn
    hooke: bool  # some pair of groups has spring and dashpot
    avalanche: bool  # some has the law of rock avalanches
    custom: tuple[wp.Function, ...]  # normal forces of the user's own
    damped: bool
    pair_damping: bool  # dashpot by the pair's frequency; else by each contact's
    predicted: bool  # contact update of second order; else the velocities of the half step
    friction: bool
    elastic_cap: bool  # some cap is k d instead of the whole normal force
    total_cap: bool  # some cap is the whole normal force
    objective: bool  # friction follows the contact frame
    keep: bool  # friction survives an opening (Rockable)
    partnership: str  # once, sum, number, overlap, pnorm: see sharing.py
    passive: bool  # friction gains no energy from moving shares
    rolling: bool
    branch_arm: bool  # rolling cap over the branch length
    cohesion: bool
    adhesion: bool  # some of it goes with the radius of curvature
    sticky: bool  # some of it begins and ends at touch
    reaching: bool  # some of it acts at a distance
    documented: bool  # and goes on in contact as exaDEM's page has it
    controlled: bool  # some walls follow forces
    periodic: bool  # pairs with images
    deforming: bool  # images that move against one another
    account: bool  # energy bookkeeping
    fused: bool  # products and sums are rounded once
    sleeps: bool  # bodies at rest may sleep, see sleep.py

    @property
    def once(self) -> bool:
        """Each vertex counts once, edges by what they overlap more than their ends."""
        return self.partnership == "once"

    @property
    def moving(self) -> bool:
        """Sub-contacts remember the share of the stiffness that they had."""
        return self.partnership not in {"once", "sum"}
