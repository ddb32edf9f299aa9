"""Rasters written for tests."""

import numpy as np


def write_asc(path, heights, *, x=0.0, y=0.0, cell=1.0, corner="corner", nodata=-9999):
    """An ESRI ASCII grid; ``heights`` begin in the north."""
    rows, columns = np.shape(heights)
    head = [
        f"ncols {columns}",
        f"nrows {rows}",
        f"xll{corner} {x!r}",
        f"yll{corner} {y!r}",
        f"cellsize {cell!r}",
        f"NODATA_value {nodata}",
    ]
    filled = np.where(np.isnan(heights), nodata, heights)
    body = [" ".join(repr(float(z)) for z in row) for row in filled]
    path.write_text("\n".join([*head, *body]) + "\n")


def waves(rows, columns, seed=0):
    """Rough heights about 1000 m."""
    return 1000.0 + np.random.default_rng(seed).normal(0.0, 0.7, (rows, columns)).cumsum(axis=1)
