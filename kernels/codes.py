"""Names of feature pairs: kind << 58 | feature of the owner << 29 | feature of the partner."""

import functools

import warp as wp

# feature of the owner first; a body pair's candidates are sorted by this number
VV = wp.constant(0)
VE = wp.constant(1)
EV = wp.constant(2)
VF = wp.constant(3)
FV = wp.constant(4)
EE = wp.constant(5)
VS = wp.constant(6)  # a vertex of the owner against the partner's analytic surface

# analytic surfaces, by what is solid; 0 is none of them
PLANE = wp.constant(1)  # z <= 0
CYLINDER = wp.constant(2)  # outside a radius about z
BALL = wp.constant(3)  # outside a radius

FEATURE_BITS = 29
FEATURE_LIMIT = 1 << FEATURE_BITS
MASK = wp.constant(wp.int64(FEATURE_LIMIT - 1))
SHIFT = wp.constant(wp.int64(FEATURE_BITS))
KIND_SHIFT = wp.constant(wp.int64(2 * FEATURE_BITS))


@wp.func
def encode(kind: int, a: int, b: int) -> wp.int64:
    """Code of feature ``a`` of the owner against feature ``b`` of the partner."""
    return (wp.int64(kind) << KIND_SHIFT) | (wp.int64(a) << SHIFT) | wp.int64(b)


@wp.func
def kind_of(code: wp.int64) -> int:
    """Kind of a feature pair."""
    return int(code >> KIND_SHIFT)


@wp.func
def feature_of_owner(code: wp.int64) -> int:
    """Vertex, edge or face of the owner, counted within its shape."""
    return int((code >> SHIFT) & MASK)


@wp.func
def feature_of_partner(code: wp.int64) -> int:
    """Vertex, edge or face of the partner, counted within its shape."""
    return int(code & MASK)


@functools.cache
def emit(*, fill: bool) -> wp.Function:
    """Function that counts a candidate, or writes it."""

    @wp.func
    def emit(code: wp.array(dtype=wp.int64), at: int, kind: int, a: int, b: int) -> int:
        if wp.static(fill):
            code[at] = encode(kind, a, b)
        return at + 1

    return emit
