"""The periodic cell of a scene: its size, and how it deforms."""

from typing import Annotated

from pydantic import Field

from warpdem.input.scene_values import (
    NotNegative,
    Number,
    Positive,
    PositiveVector,
    Section,
    Vector,
)

Tensor = Annotated[tuple[Vector, ...], Field(min_length=3, max_length=3, strict=False)]
AXES = "xyz"


class CellStress(Section):
    """Stresses at which components of the cell are held, compression positive [Pa]."""

    xx: Number | None = None
    """Normal stress along x."""

    yy: Number | None = None
    """Normal stress along y."""

    zz: Number | None = None
    """Normal stress along z."""

    xy: Number | None = None
    """Shear stress; the cell shears without turning, L_xy = L_yx."""

    xz: Number | None = None
    """Shear stress."""

    yz: Number | None = None
    """Shear stress."""

    def components(self) -> dict[tuple[int, int], float]:
        """The stresses given, by row and column, row <= column."""
        values = {name: getattr(self, name) for name in CellStress.model_fields}
        return {
            (AXES.index(a), AXES.index(b)): value
            for (a, b), value in values.items()
            if value is not None
        }


class Cell(Section):
    """A cell that repeats itself in space: what leaves it on one side acts on the other.

    It starts as an upright box and may deform, at a given rate or towards a given stress, or both
    by components. Bodies take part in the homogeneous flow v = L x about its centre, from the start
    and whenever L changes, so that no boundary is seen in their motion.
    """

    size: PositiveVector
    """Lengths of its edges at the start [m]."""

    origin: Vector = (0.0, 0.0, 0.0)
    """Its lowest corner at the start [m]; the centre stays where it is."""

    periodic: Annotated[tuple[bool, ...], Field(min_length=3, max_length=3, strict=False)] = (
        True,
        True,
        True,
    )
    """Along which axes it repeats itself; along the others space is open."""

    strain_rate: Tensor = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    """Velocity gradient L, rows of it [1/s]: L[0][1] shears x by y, L[0][0] < 0 compresses x."""

    stress: CellStress = CellStress()
    """Components held at a stress instead, e.g. { xx = 1e4, yy = 1e4, zz = 1e4 } [Pa]."""

    inertia: Positive | None = None
    """Mass of the cell under stress control [kg]: M L' = V (stress - target) - M damping L with
    M = inertia * V^(2/3) of the start; default: the mass of all free bodies, which makes the cell
    about as slow as the longest elastic wave in it."""

    damping: NotNegative | None = None
    """Rate at which its motion dies out under stress control [1/s]; default: its own frequency in
    a packing of the stiffest contacts, sqrt(V^(1/3) kn / (2 r inertia))."""

    start: NotNegative = 0.0
    """When it begins to deform [s]; until then it stands still."""

    stop: Positive | None = None
    """When it stops [s]; default: never."""

    @property
    def deforms(self) -> bool:
        """Whether it ever does."""
        return any(map(any, self.strain_rate)) or bool(self.stress.components())

    @property
    def centre(self) -> tuple[float, ...]:
        """The point about which it deforms [m]."""
        return tuple(low + 0.5 * edge for low, edge in zip(self.origin, self.size, strict=True))
