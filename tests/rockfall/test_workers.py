"""Chunks flown by Dask's worker processes."""

import warnings

import pytest
import skating
from test_ensemble import chunks, results, run, summary

from warpdem.errors import WarpdemError
from warpdem.rockfall import ensemble
from warpdem.rockfall.share import Share

pytest.importorskip("distributed")
DASK = Share(workers="dask")
# distributed leaves sockets and event loops to the garbage collector
pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(autouse=True)
def _stand_in(monkeypatch, tmp_path):
    skating.stand_in(monkeypatch.setattr)
    (tmp_path / "terrain.asc").write_text("flat")


@pytest.mark.parametrize("count", [1, 2])
def test_results_do_not_depend_on_the_number_of_workers(tmp_path, count):
    run(tmp_path / "threads")
    assert run(tmp_path / "workers", DASK, threads=count) == 0
    assert chunks(tmp_path / "workers") == chunks(tmp_path / "threads")
    assert results(tmp_path / "workers") == results(tmp_path / "threads")
    facts = summary(tmp_path / "workers")
    assert (facts["workers"], facts["trajectories_this_session"]) == (count, 103)
