"""Allocates arrays of the device by the table of ``warpdem.memory``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import warp as wp

from warpdem.kernels.outcodes import Near
from warpdem.kernels.precision import mat33, quat, real, vec3, vec4, wide, wide3, wide4, wide33
from warpdem.memory import arrays_of

if TYPE_CHECKING:
    from warpdem.features import Features

TYPES = {
    "int": wp.int32,
    "vec3i": wp.vec3i,
    "int64": wp.int64,
    "uint64": wp.uint64,
    "real": real,
    "vec3": vec3,
    "vec4": vec4,
    "wide": wide,
    "wide3": wide3,
    "wide4": wide4,
    "wide33": wide33,
    "quat": quat,
    "mat33": mat33,
    "Near": Near,
}


def allocated(view: str, per: str, count: int, has: Features, device: Any) -> dict[str, wp.array]:
    """Arrays of zeros by name: those of a view with an entry for each of ``count`` of ``per``."""
    return {
        array.name: wp.zeros(array.length(count, has), dtype=TYPES[array.kind], device=device)
        for array in arrays_of(view, per)
    }


def allocate(view: Any, name: str, per: str, count: int, has: Features, device: Any) -> None:
    """Give a view of kernels.views its arrays with an entry for each of ``count`` of ``per``."""
    for array, values in allocated(name, per, count, has, device).items():
        setattr(view, array, values)
