"""The pairs of each body: those it is the partner in, then those it owns, in ascending order."""

from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Incidence


@inlined()
def owned_from(incidence: Incidence, body: int) -> int:
    """First pair that a body owns; they go on to ``incidence.ends``."""
    if body == 0:
        return 0
    return incidence.ends[body - 1]


@inlined()
def pairs_of(incidence: Incidence, body: int):
    """First pair that a body owns, the number of pairs it is the partner in, and that of all."""
    first = owned_from(incidence, body)
    others = incidence.start[body + 1] - incidence.start[body]
    return first, others, others + incidence.ends[body] - first


@inlined()
def pair_at(incidence: Incidence, body: int, first: int, others: int, k: int) -> int:
    """The k-th pair of a body: 2 pair + (1 where it is the partner)."""
    if k < others:
        return 2 * incidence.pair[incidence.start[body] + k] + 1
    return 2 * (first + k - others)
