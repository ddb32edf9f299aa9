"""Bundles of trajectories taken apart and put together again, row by row."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.rockfall.flights import Flights, Starts


def part(starts: Starts, first: int, last: int) -> Starts:
    """The rows from ``first`` to before ``last``."""
    rows = {field.name: getattr(starts, field.name)[first:last] for field in fields(starts)}
    return type(starts)(**rows)


def joined(bundles: Sequence[Flights]) -> Flights:
    """The rows of all bundles, one after the other; at least one bundle."""
    return _joined(bundles)


def _joined(tables: Sequence[Any]) -> Any:
    if len(tables) == 1:
        return tables[0]
    columns = {}
    for field in fields(tables[0]):
        parts = [getattr(table, field.name) for table in tables]
        columns[field.name] = _joined(parts) if is_dataclass(parts[0]) else np.concatenate(parts)
    return type(tables[0])(**columns)
