"""Polygons of shapefiles, through pyshp."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any

from warpdem.errors import GeometryError, WarpdemError

if TYPE_CHECKING:
    from pathlib import Path


def polygons_of(path: Path) -> list[tuple[Any, dict[str, Any]]]:
    """The polygons of a shapefile as pyshp has them, and their attributes.

    Raises:
        GeometryError: The file cannot be read, or holds no polygons.
        WarpdemError: The extra ``geo`` is not installed.
    """
    try:
        import shapefile  # noqa: PLC0415 - of the extra geo
    except ImportError:
        raise WarpdemError(
            f"{path}: shapefiles need pyshp; install it with: pip install 'warpdem[geo]'"
        ) from None
    try:
        opened: Any = shapefile.Reader(str(path), encodingErrors="replace")
        with opened as reader:
            records = [(one.shape, one.record.as_dict()) for one in reader.iterShapeRecords()]
    except (shapefile.ShapefileException, struct.error, OSError, ValueError) as error:
        raise GeometryError(f"{path}: cannot be read as a shapefile: {error}") from None
    found = [
        (shape, record)
        for shape, record in records
        if shape.shapeTypeName.startswith("POLYGON") and len(shape.points)
    ]
    if not found:
        raise GeometryError(f"{path}: holds no polygons")
    return found
