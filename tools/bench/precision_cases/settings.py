"""Settings of the program that the diagrams compare."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError

from warpdem.input.scene_run import ROCKABLE, Numerics, Run


@dataclass(frozen=True)
class Setting:
    """Keys of [run].

    Attributes:
        name: In tables.
        run: The keys.
        law: Its answer is another one than the default's: what it is to be compared with.
        truth: Keys with which that answer is found.
    """

    name: str
    run: dict[str, Any]
    law: str = "own"
    truth: dict[str, Any] = field(default_factory=dict)

    @property
    def precision(self) -> str:
        """A process has one."""
        return self.run.get("precision", "float64")

    @property
    def known(self) -> bool:
        """Whether this version takes it, and it is not the default anyway."""
        try:
            run = Run.model_validate({"duration": 1.0, **self.run})
        except ValidationError:
            return False
        plain = Run(duration=1.0)
        return not self.run or any(getattr(run, k) != getattr(plain, k) for k in self.run)


def _law(name: str, **run: Any) -> Setting:
    return Setting(name, run, name, run)


_CHANGED = {
    key: getattr(ROCKABLE, key)
    for key in Numerics.model_fields
    if getattr(ROCKABLE, key) != getattr(Numerics(), key)
}
ALL = (
    Setting("default", {}),
    Setting("lagged", {"contact_update": "lagged"}),
    Setting("rkmk4", {"rotation": "rkmk4"}),
    Setting("taylor", {"rotation": "taylor"}),
    Setting("mixed", {"precision": "mixed"}),
    _law("sum", partnership="sum"),
    _law("pnorm", partnership="pnorm"),
    Setting("nonsmooth", {"method": "nonsmooth"}, "hard"),
    Setting(
        "rockable",
        {"compat": "rockable"},
        "rockable",
        _CHANGED | {"contact_update": "predicted", "rotation": "no_squish", "partnership": "sum"},
    ),
)
SETTINGS = {setting.name: setting for setting in ALL}
CONTACT = ("default", "lagged", "mixed", "rockable")
"""Settings for impacts of spheres."""
TURNING = ("default", "lagged", "rkmk4", "taylor", "mixed", "rockable")
"""For impacts of bodies of unequal moments of inertia."""
SHARED = ("default", "lagged", "mixed", "sum", "pnorm", "rockable")
"""For contacts of faces."""
