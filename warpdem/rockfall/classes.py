"""The published classes of ground, and those of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.rockfall.site import GroundClass

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

UNVERIFIED = "unverified"
"""Source of a class whose numbers nobody could confirm in print."""

_NOTES = "third-party notes"
_LU = "Lu et al. (2019), doi:10.1007/s10346-019-01238-z"

PUBLISHED: Mapping[str, GroundClass] = {
    one.name: one
    for one in (
        GroundClass("extra soft", 0.20, 2.0, 1.0, 50.0, 0.9, source=_NOTES),
        GroundClass("soft", 0.25, 2.0, 1.25, 100.0, 0.8, source=UNVERIFIED),
        GroundClass("medium soft", 0.30, 2.0, 1.5, 125.0, 0.7, source=UNVERIFIED),
        GroundClass("medium", 0.35, 2.0, 2.0, 150.0, 0.6, source=UNVERIFIED),
        GroundClass("medium hard", 0.40, 2.0, 2.5, 175.0, 0.5, source=UNVERIFIED),
        GroundClass("hard", 0.55, 2.0, 3.0, 185.0, 0.4, source=_LU),
        GroundClass("extra hard", 0.80, 2.0, 4.0, 200.0, 0.3, source=_NOTES),
        GroundClass("snow", 0.10, 0.35, 2.0, 150.0, 0.7, source=UNVERIFIED),
    )
}
"""Classes of RAMMS::ROCKFALL's manuals and papers, by name; without restitution and scarring."""

PARAMETERS = (
    "mu_min",
    "mu_max",
    "kappa",
    "beta",
    "drag",
    "restitution",
    "scar_modulus",
    "scar_drag",
)
"""What a scene may say of a class."""

NEEDED = PARAMETERS[:5]
"""What it must say of one that is like no other."""


def classes_of(own: Iterable[Any]) -> dict[str, GroundClass]:
    """The published classes and those of a scene by name; the scene's replace published ones.

    Args:
        own: The scene's sections ``[[terrain_class]]``, in order: one may be like an earlier one.
    """
    known = dict(PUBLISHED)
    for section in own:
        start = known.get(section.like or section.name)
        values = {key: getattr(start, key) for key in PARAMETERS} if start else {}
        said = {key: value for key in PARAMETERS if (value := getattr(section, key)) is not None}
        known[section.name] = GroundClass(section.name, **(values | said))
    return known
