"""Which keys of a contact law go together, and what is said where they do not."""

import pytest
from pydantic import ValidationError

from warpdem.input.scene import Scene

LAW = {"groups": ["default", "default"], "kn": 1e5, "kt": 1e5, "mu": 0.5, "en2": 0.25}
OWN = {key: LAW[key] for key in ("groups", "kn", "kt", "mu")} | {
    "law": "custom",
    "file": "own.py",
    "normal": "hertz",
}


def scene(law, **run):
    groups = [{"name": "default"}]
    return Scene.model_validate(
        {"run": {"duration": 1.0, **run}, "group": groups, "contact": [law]}
    )


@pytest.mark.parametrize(
    ("law", "run", "rule"),
    [
        ({**LAW, "en2": None}, {}, "missing: the energy kept by a rebound"),
        ({**LAW, "damping_ratio": 0.1}, {}, "leave one of the two out"),
        ({**LAW, "law": "avalanche", "en2": None, "damping_ratio": 0.1}, {}, "has no dashpot"),
        ({**LAW, "dncut": 0.01}, {}, "no effect without fc"),
        (
            {**LAW, "law": "avalanche", "fc": 1.0, "dncut": 0.01},
            {"cohesion": "documented"},
            "is a law with a dashpot",
        ),
        ({**OWN, "normal": None}, {}, 'law = "custom" needs it'),
        ({**OWN, "en2": 0.5}, {}, "no dashpot but its own"),
        (OWN, {"partnership": "number"}, "shares nothing"),
        ({**LAW, "parameters": [1.0]}, {}, 'only with law = "custom"'),
        ({**LAW, "gamma": 1.0}, {"compat": "rockable"}, "has no cohesion"),
        (LAW, {"partnership_exponent": 6.0}, 'only with partnership = "pnorm"'),
        (LAW, {"compat": "exadem", "damping": "pair"}, 'compat = "exadem" sets "contact"'),
    ],
)
def test_laws_that_make_no_sense_are_refused_with_their_reason(law, run, rule):
    with pytest.raises(ValidationError, match=rule):
        scene(law, **run)


@pytest.mark.parametrize(
    "law",
    [
        {**LAW, "law": "avalanche", "fc": 1.0, "dncut": 0.01},
        {**LAW, "gamma": 0.1, "fc": 1.0},
        {**LAW, "en2": None, "damping_ratio": 1.5},
        {**OWN, "parameters": [1.0] * 8, "fc": 2.0},
    ],
)
def test_laws_are_combined_where_that_makes_sense(law):
    scene(law, cohesion="exadem")
