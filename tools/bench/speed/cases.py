"""The cases, as data: what moves, how long, beside whom, and what is asked."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

from speed import scenes
from speed.peers.liggghts import LIGGGHTS
from speed.peers.yade import YADE

if TYPE_CHECKING:
    from collections.abc import Callable

    from speed.peers import Peer
    from speed.problem import Problem


@dataclass(frozen=True)
class Recorded:
    """A speed that was measured elsewhere in time, on a machine like this: quoted, not paired.

    Attributes:
        peer: Program.
        threads: Of its run.
        speed: Body-steps per second.
        how: What was run.
    """

    peer: str
    threads: int
    speed: float
    how: str


@dataclass(frozen=True)
class Case:
    """A problem to be stepped by warpdem and its peers.

    Attributes:
        name: On the command line.
        what: In the table.
        make: The problem, not yet settled.
        settle: Steps until it starts.
        warm, steps: Before the clock starts, and under it.
        peers: Programs run beside.
        recorded: Programs quoted.
        targets: How many times faster to be than a peer on so many threads.
        differs: What is not the same for all.
        threads: Numbers of threads compared.
    """

    name: str
    what: str
    make: Callable[[], Problem]
    settle: int
    warm: int
    steps: int
    differs: str
    peers: tuple[Peer, ...] = ()
    recorded: tuple[Recorded, ...] = ()
    targets: dict[tuple[str, int], float] = field(default_factory=dict)
    threads: tuple[int, ...] = (1, 2)


SPRINGS = (
    "All solve Hooke's springs with the same kn, kt, dashpot, mu, dt, weight and plane walls from "
    "the same positions, at rest and without friction history, and build it up in the steps before "
    "the clock. warpdem runs with run.arithmetic = 'fused'. "
)
SPHERES = (
    SPRINGS + "LIGGGHTS and YADE damp each contact by itself, friction turned with the contact; "
    "warpdem keeps the two-body restitution besides, and no orientations. "
)

CASES = (
    Case(
        "spheres_rest",
        "1000 spheres at rest in a box",
        partial(scenes.spheres, 1000, 10, name="spheres_rest"),
        settle=12000,
        warm=2000,
        steps=10000,
        peers=(LIGGGHTS, YADE),
        recorded=(Recorded("Rockable", 1, 1.5e6, "1000 spheres, 2300 contacts, dt 1e-4"),),
        targets={("Rockable", 1): 4.0},
        threads=(1,),
        differs=SPHERES + "Rockable's recorded run had a packing of its own and boxes as walls.",
    ),
    Case(
        "spheres_settled",
        "8000 settled spheres, five walls",
        partial(scenes.spheres, 8000, 20, name="spheres_settled"),
        settle=12000,
        warm=2000,
        steps=2000,
        peers=(LIGGGHTS, YADE),
        targets={
            ("LIGGGHTS", 1): 1.2,
            ("LIGGGHTS", 2): 1.6,
            ("YADE", 1): 7.0,
            ("YADE", 2): 7.0,
        },
        differs=SPHERES + "LIGGGHTS' two threads are two MPI ranks.",
    ),
    Case(
        "cubes",
        "1000 rounded cubes at rest in a box",
        partial(scenes.cubes, 1000, 10),
        settle=8000,
        warm=2000,
        steps=2000,
        recorded=(
            Recorded("Rockable", 1, 1.8e5, "1000 cubes, r = .1 half size, 4700 sub-contacts"),
            Recorded("Rockable", 2, 2.2e5, "the same"),
        ),
        targets={("Rockable", 1): 6.0, ("Rockable", 2): 10.0},
        differs="Rockable's recorded run had a packing of its own, thick boxes as walls, and its "
        "own numerics: first order in the dashpots, lists renewed at fixed intervals.",
    ),
    Case(
        "octahedra",
        "216 octahedra settling on a plane",
        partial(scenes.octahedra, 216, 6),
        settle=0,
        warm=4000,
        steps=1000,
        recorded=(
            Recorded("exaDEM", 1, 2.2e6, "its kernels alone, 1900 candidates, 240 contacts"),
        ),
        targets={("exaDEM", 1): 1.0},
        threads=(1,),
        differs="exaDEM's recorded run is its force kernels over a list that was there: no lists, "
        "no grid, no integration of its application; here everything is included.",
    ),
)


def with_peer(case: Case, peer: Peer) -> Case:
    """The case beside one more program."""
    return replace(case, peers=(*case.peers, peer))


def case_named(name: str) -> Case:
    """One of the cases.

    Raises:
        KeyError: There is none of that name.
    """
    return {case.name: case for case in CASES}[name]
