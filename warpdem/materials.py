"""The contact laws of a scene on the device: one row of parameters a pair of groups."""

from __future__ import annotations

import importlib.util
import re
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

import warp as wp

from warpdem.checks.custom_laws import own_law
from warpdem.checks.restitution import damping_ratio
from warpdem.errors import Problem, SceneError
from warpdem.features import elastic_cap
from warpdem.kernels.laws import AVALANCHE, CUSTOM, HOOKE
from warpdem.kernels.normal_laws import trial
from warpdem.kernels.views import Material

if TYPE_CHECKING:
    from collections.abc import Iterable

    from warpdem.features import Features
    from warpdem.filling.placement import Placement
    from warpdem.input.scene import Scene
    from warpdem.input.scene_contact import Contact

PARSED = re.compile(
    r'.*Error while parsing function "(?P<function>.*?)" at (?P<file>.*):(?P<line>\d+):\n'
    r"(?P<code>[^\n]*)\n(?P<said>.*)",
    re.DOTALL,
)
"""The last, innermost function that Warp tells of where it cannot translate one."""

SHOWN = 300
"""Letters of what Warp says that a message shows."""


def materials(scene: Scene, placement: Placement, features: Features, device: Any) -> wp.array:
    """Contact parameters of group i and j at i * group_count + j.

    NaN where the scene has none, so that none is used.
    """
    count = len(placement.groups)
    rows = [Material() for _ in range(count * count)]
    for row in rows:
        row.kn = float("nan")
    index = {name: k for k, name in enumerate(placement.groups)}
    for (a, b), law in scene.contact_table(placement.groups).items():
        _fill(rows[index[a] * count + index[b]], law, scene, features)
    return wp.array(rows, dtype=Material, device=device)


def _fill(row: Any, law: Contact, scene: Scene, features: Features) -> None:
    for key in ("kn", "kt", "mu", "kr", "mur", "fc", "gamma"):
        setattr(row, key, getattr(law, key))
    row.zeta = damping_ratio(law, scene.run.resolved())
    row.en2 = law.en2 or 1.0
    row.dncut = law.dncut or 0.0
    row.exponent = scene.run.partnership_exponent
    row.elastic_cap = int(elastic_cap(law))
    row.kind = _kind(law, scene, features)
    for number, value in enumerate(law.parameters):
        row.parameters[number] = value


def _kind(law: Contact, scene: Scene, features: Features) -> int:
    if law.law == "custom":
        return CUSTOM + features.custom.index(own_law(law, scene))
    return AVALANCHE if law.law == "avalanche" else HOOKE


def load_custom_law(file: str, name: str) -> wp.Function:
    """The ``@wp.func`` of a custom law.

    Raises:
        SceneError: The file does not run, or the name is no ``@wp.func``.
    """
    path = Path(file)
    spec = importlib.util.spec_from_file_location(f"warpdem_law_{path.stem}", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as fault:  # the user's own code may raise anything
        rule = f"does not run: {type(fault).__name__}: {fault}"
        raise SceneError(file, [Problem(file, name, rule)]) from fault
    law = getattr(module, name)
    if not isinstance(law, wp.Function):
        raise SceneError(file, [Problem(file, name, "must be decorated with @wp.func")])
    return law


def try_custom_laws(laws: Iterable[tuple[str, str]], device: Any) -> None:
    """Build each custom law by itself, after a kernel could not be built.

    Raises:
        SceneError: Warp cannot translate some of them; carries all.
    """
    problems: dict[str, list[Problem]] = {}
    for file, name in laws:
        try:
            wp.load_module(trial(load_custom_law(file, name)).module, device=device)
        except Exception as fault:  # Warp raises whatever its parser met
            if not (found := PARSED.search("".join(map(str, fault.args)))):
                raise
            problems.setdefault(file, []).append(_untranslated(file, name, found))
    if problems:
        every = [problem for found in problems.values() for problem in found]
        raise SceneError(", ".join(problems), every)


def _untranslated(file: str, name: str, found: re.Match[str]) -> Problem:
    """What Warp says of a custom law, or of how it is called."""
    said = textwrap.shorten(found["said"].lstrip(";"), SHOWN)
    if found["function"] == "alone":
        place, rule = file, f"Warp cannot call it as a law: {said}"
    else:
        place = f"{found['file']}:{found['line']}"
        rule = f"Warp cannot translate '{found['code'].strip()}': {said}"
    return Problem(place, name, f"{rule}; warpdem/kernels/custom.py says how a law is written")
