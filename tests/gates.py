"""What a test asks for in the precision that the suite runs in (see conftest.py)."""

from typing import TypeVar

import pytest
from warpdem.kernels.choice import chosen

MIXED = chosen() == "mixed"

Gate = TypeVar("Gate")


def gate(float64: Gate, *, mixed: Gate) -> Gate:
    """The gate of the precision at hand."""
    return mixed if MIXED else float64


def not_in_mixed(reason: str) -> pytest.MarkDecorator:
    """Mark of a test that cannot hold in mixed precision, and why."""
    return pytest.mark.skipif(MIXED, reason=f"mixed precision: {reason}")
