"""Rules on shapes that are analytic surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, entries, read, tables, text
from warpdem.input.scene_shapes import ANALYTIC

if TYPE_CHECKING:
    from collections.abc import Iterator

SOLID = {
    "cylinder": 'a solid cylinder is kind = "capsule", radius and length, or a mesh',
    "ball": 'a solid ball is kind = "sphere"',
}


def containers(scene: Any) -> Iterator[Fault]:
    """Cylinders and balls contain the bodies."""
    for index, shape in tables(scene, "shape"):
        kind = text(shape, "kind")
        if kind in SOLID and read(shape, "inside") is False:
            rule = f'kind = "{kind}" is a container: {SOLID[kind]}'
            yield Fault(("shape", index, "inside"), False, rule)


def surfaces_stand(scene: Any) -> Iterator[Fault]:
    """A surface has no mass: it is only for fixed bodies."""
    kinds = {
        name: kind
        for _, shape in tables(scene, "shape")
        if (name := text(shape, "name")) and (kind := text(shape, "kind")) in ANALYTIC
    }
    for index, body in tables(scene, "body"):
        name = text(body, "shape")
        if name in kinds and read(body, "fixed") in (None, False):
            rule = f"a {kinds[name]} has no mass: give the body fixed = true"
            yield Fault(("body", index, "shape"), name, rule)
    for index, fill in tables(scene, "fill"):
        for place, name in enumerate(entries(fill, "shapes")):
            if isinstance(name, str) and name in kinds:
                rule = f"a {kinds[name]} cannot be strewn"
                yield Fault(("fill", index, "shapes", place), name, rule)
