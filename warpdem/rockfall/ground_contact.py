"""The class of the ground of a scene that says contacts between groups instead."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

from warpdem.input.decode import problem_at
from warpdem.rockfall.site import GroundClass

if TYPE_CHECKING:
    from warpdem.errors import Problem
    from warpdem.input.scene import Scene
    from warpdem.input.scene_contact import Contact


def contact_class(scene: Scene, problems: list[Problem]) -> GroundClass:
    """Constant friction mu and restitution sqrt(en2) of the contacts of rocks with the ground.

    Args:
        scene: Whose ground is a fixed body.
        problems: Takes contacts that are missing, cannot be so expressed, or differ.
    """
    laws = _laws(scene, problems)
    found: dict[tuple[float, float], int] = {}
    for index, law in laws.items():
        if law.law == "custom" or law.en2 is None:
            rule = 'missing: the impacts of run.method = "nonsmooth" need it, the energy they keep'
            problems.append(problem_at(scene, ("contact", index, "en2"), rule))
        else:
            found.setdefault((law.mu, law.en2), index)
    if len(found) > 1:
        first, other, *_ = found.values()
        rule = (
            f"another mu or en2 than contact[{first}]: the ground is the same for all rocks; give "
            "both the same, or run the groups one by one"
        )
        problems.append(problem_at(scene, ("contact", other), rule))
    mu, en2 = next(iter(found), (0.0, 0.0))
    return GroundClass("contact", mu, mu, 0.0, 0.0, 0.0, restitution=sqrt(en2))


def _laws(scene: Scene, problems: list[Problem]) -> dict[int, Contact]:
    """Contacts of the ground's group with those of free bodies, by their number."""
    terrains = {shape.name for shape in scene.shape if shape.kind == "terrain"}
    ground = next(body.group for body in scene.body if body.shape in terrains)
    free = [body.group for body in scene.body if not body.fixed]
    free += [fill.group for fill in scene.fill]
    number = {frozenset(contact.groups): k for k, contact in enumerate(scene.contact)}
    laws = {}
    for group in dict.fromkeys(free):
        index = number.get(frozenset((ground, group)))
        if index is None:
            rule = f'missing: between the groups "{ground}" of the ground and "{group}"'
            problems.append(problem_at(scene, ("contact",), rule))
        else:
            laws[index] = scene.contact[index]
    return laws
