"""Chunks flown by Dask's worker processes."""

import sys

import pytest
import skating
from test_ensemble import chunks, results, run, summary

from warpdem.errors import WarpdemError
from warpdem.rockfall import workers
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


def test_a_chunk_whose_worker_died_is_flown_again(tmp_path, monkeypatch):
    run(tmp_path / "threads")
    (tmp_path / "fuse").write_text("x")
    monkeypatch.setenv(skating.FUSE, str(tmp_path / "fuse"))
    assert run(tmp_path / "workers", DASK, threads=1) == 0
    assert (tmp_path / "fuse").read_text() == ""
    assert chunks(tmp_path / "workers") == chunks(tmp_path / "threads")


def test_a_chunk_that_always_fails_is_named_and_the_others_stay(tmp_path, monkeypatch):
    monkeypatch.setenv(skating.FUSE, str(tmp_path / "absent"))
    fault = (
        r"chunk 5 \(trajectories 50 to 59\) failed 3 times .* RuntimeError: out of order; --resume"
    )
    with pytest.raises(WarpdemError, match=fault):
        run(tmp_path / "workers", DASK, threads=1)
    monkeypatch.delenv(skating.FUSE)
    kept = chunks(tmp_path / "workers")
    assert run(tmp_path / "workers", resume=True) == 0
    assert kept.items() <= chunks(tmp_path / "workers").items()


def test_the_missing_extra_and_the_way_out_are_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(WarpdemError, match=r"pip install 'warpdem\[dask\]'"):
        run(tmp_path / "workers", DASK)
    assert not (tmp_path / "workers").exists()


def test_a_scheduler_that_does_not_answer_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "ANSWER", "1s")
    with pytest.raises(WarpdemError, match="no scheduler answers there"):
        run(tmp_path / "workers", Share(workers="dask", scheduler="tcp://127.0.0.1:9"))
