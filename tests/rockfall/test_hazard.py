"""Rasters of the cells."""

import numpy as np
from fields import flights, site

from warpdem.rockfall.hazard import rasters
from warpdem.rockfall.tally import Tally


def test_rasters_hold_counts_everywhere_and_values_where_something_passed():
    here = site(rows=9, columns=11)
    bundle = flights(50, visits=300, where=here)
    tally = Tally.of(bundle, here)
    found = rasters(tally, here)
    assert len(found) == 3 + 4 * 6
    assert {raster.shape for raster in found.values()} == {(9, 11)}
    passages = np.zeros((9, 11), int)
    for cell in {*zip(bundle.visits.id.tolist(), bundle.visits.cell.tolist(), strict=True)}:
        passages.flat[cell[1]] += 1
    np.testing.assert_array_equal(found["passages"], passages)
    blank = passages == 0
    for name, raster in found.items():
        if name not in ("passages", "deposits"):
            np.testing.assert_array_equal(np.isnan(raster), blank, err_msg=name)
    np.testing.assert_allclose(found["reach_probability"][~blank] * 50, passages[~blank], 1e-6)
    order = [found[f"jump_{ending}"][~blank] for ending in ("median", "q90", "q95", "q99", "max")]
    assert (np.diff(order, axis=0) >= 0).all()
