"""An ensemble's folder: the same bytes however its trajectories were spread and interrupted."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import skating
from test_output import files_at_most, tiny_disk

from warpdem.errors import OutputError, UnstableError, WarpdemError
from warpdem.output.ensemble_folder import claimed
from warpdem.rockfall import ensemble, finish, task
from warpdem.rockfall.share import Shard, Share, shard_of
from warpdem.running import runner
from warpdem.running.interrupts import Interrupted

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def _stand_in(monkeypatch, tmp_path):
    skating.stand_in(monkeypatch.setattr)
    (tmp_path / "terrain.asc").write_text("flat")


def run(folder, share=ensemble.WHOLE, *, threads=2, resume=False, force=False, **options):
    scene = skating.scene(folder.parent, **options)
    return ensemble.run_rockfall(
        scene, folder, threads=threads, resume=resume, force=force, quiet=True, share=share
    )


def results(folder):
    return {name: (folder / name).read_bytes() for name in skating.RESULTS}


def chunks(folder):
    return {path.name: path.read_bytes() for path in (folder / "chunks").glob("chunk_*")}


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


def send(number):
    os.kill(os.getpid(), number)


def start(folder, **keywords):
    """A run in a process of its own."""
    command = [sys.executable, skating.__file__, str(folder), json.dumps(keywords)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)


def wait_for(process, path):
    while not path.exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.005)


@pytest.fixture
def whole(tmp_path):
    assert run(tmp_path / "whole") == 0
    return tmp_path / "whole"


def test_a_run_leaves_chunks_results_and_a_summary(whole):
    names = {path.relative_to(whole).as_posix() for path in whole.rglob("*") if path.is_file()}
    files = {f"chunks/chunk_{index:06d}.npz" for index in range(11)}
    assert names == files | {"chunks/plan.json", "summary.json", *skating.RESULTS}
    facts = summary(whole)
    assert (facts["status"], facts["trajectories"], facts["asked"]) == ("finished", 103, 103)
    assert facts["fates"] == {"moving": 26, "rest": 26, "left": 26, "timeout": 25, "caught": 0}
    assert facts["chunks"] == {"size": 10, "count": 11, "done": 11}
    assert facts["unverified_classes"] == ["snow"]
    assert facts["steps"]["most_sweeps"] == 6
    assert facts["largest"]["speed"] == pytest.approx(102 * 5 / 7)
    assert facts["trajectories_with"]["unconverged"] == 88  # all but the multiples of 7
    assert facts["threads"] == 2


@pytest.mark.parametrize(("threads", "chunk"), [(1, 10), (3, 7), (2, 1000), (4, None)])
def test_results_depend_on_neither_threads_nor_chunks(tmp_path, whole, threads, chunk):
    assert run(tmp_path / "run", threads=threads, chunk=chunk) == 0
    assert results(tmp_path / "run") == results(whole)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_run_soon_and_a_resumed_run_equals_a_whole_one(tmp_path, whole, number):
    folder = tmp_path / "run"
    process = start(folder, scene={"pause": 0.02}, threads=2)
    wait_for(process, folder / "chunks" / "chunk_000002.npz")
    began = time.monotonic()
    process.send_signal(number)
    process.send_signal(number)
    _, text = process.communicate(timeout=30)
    assert time.monotonic() - began < 2.0
    assert process.returncode == 128 + number
    assert "Traceback" not in text
    assert "--resume goes on" in text
    assert summary(folder)["status"] == "interrupted"
    kept = chunks(folder)
    assert 3 <= len(kept) < 11
    assert not list(folder.rglob("*.part"))
    times = {name: (folder / "chunks" / name).stat().st_mtime_ns for name in kept}
    assert run(folder, resume=True, pause=0.02) == 0
    assert results(folder) == results(whole)
    assert {name: (folder / "chunks" / name).stat().st_mtime_ns for name in kept} == times


def test_a_killed_run_resumes_with_nothing_lost_or_doubled(tmp_path, whole):
    folder = tmp_path / "run"
    process = start(folder, scene={"pause": 0.01})
    wait_for(process, folder / "chunks" / "chunk_000004.npz")
    process.kill()
    process.communicate(timeout=30)
    (folder / "chunks" / "chunk_000009.npz.part").write_text("half a chunk")
    assert 0 < len(chunks(folder)) < 11
    assert run(folder, resume=True, pause=0.01) == 0
    assert results(folder) == results(whole)
    assert not list(folder.rglob("*.part"))


def test_a_signal_during_the_results_leaves_them_to_a_resumption(tmp_path, whole, monkeypatch):
    monkeypatch.setattr(finish, "finish", lambda *_: send(signal.SIGTERM))
    assert run(tmp_path / "run") == 143
    monkeypatch.setattr(finish, "finish", skating.write_results)
    assert run(tmp_path / "run", resume=True) == 0
    assert results(tmp_path / "run") == results(whole)
    assert chunks(tmp_path / "run") == chunks(whole)


def test_a_signal_before_the_first_trajectory_leaves_no_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(task, "prepared", lambda *_: send(signal.SIGINT))
    with pytest.raises(Interrupted):
        run(tmp_path / "run")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("order", [(1, 2, 3), (3, 1, 2), (2, 3, 1)])
def test_shards_in_any_order_equal_one_run(tmp_path, whole, order):
    folder = tmp_path / "run"
    for number in order[:-1]:
        assert run(folder, Share(Shard(number, 3)), threads=1) == 0
        assert not (folder / "deposits.csv").exists()
    assert run(folder, Share(Shard(order[-1], 3))) == 0
    assert results(folder) == results(whole)
    assert chunks(folder) == chunks(whole)
    assert summary(folder)["status"] == "finished"


def test_shards_at_the_same_time_equal_one_run(tmp_path, whole):
    folder = tmp_path / "run"
    shards = [start(folder, scene={"pause": 0.002}, shard=[k, 2], threads=k) for k in (1, 2)]
    for shard in shards:
        _, text = shard.communicate(timeout=60)
        assert shard.returncode == 0, text
    assert run(tmp_path / "one", pause=0.002) == 0
    assert results(folder) == results(whole)
    assert chunks(folder) == chunks(tmp_path / "one")


def test_a_run_without_shard_flies_what_shards_left_and_merges_to_the_same_bytes(tmp_path, whole):
    folder = tmp_path / "run"
    run(folder, Share(Shard(2, 4)))
    assert run(folder, resume=True) == 0
    first = results(folder)
    assert first == results(whole)
    assert run(folder, resume=True) == 0
    assert results(folder) == first


def test_a_chosen_chunk_suits_all_shards_together(tmp_path):
    run(tmp_path / "run", Share(Shard(1, 3)), threads=1, chunk=None, count=6000)
    plan = json.loads((tmp_path / "run" / "chunks" / "plan.json").read_text())["plan"]
    assert plan == {"count": 6000, "size": 100}


def test_a_shard_flies_its_own_chunks_alone():
    assert [Shard(k, 3).of(range(8)) for k in (1, 2, 3)] == [[0, 3, 6], [1, 4, 7], [2, 5]]


def test_a_shard_and_its_double_do_not_share_a_folder(tmp_path):
    run(tmp_path / "run", Share(Shard(1, 2)))
    options = {"resume": False, "force": False}
    with claimed(tmp_path / "run", **options, shard=Shard(2, 2)):
        with pytest.raises(WarpdemError, match="another run of --shard 2/2"):
            run(tmp_path / "run", Share(Shard(2, 2)))
        with pytest.raises(WarpdemError, match="shards of another number than 3"):
            run(tmp_path / "run", Share(Shard(2, 3)))
        with pytest.raises(WarpdemError, match="another run is writing"):
            run(tmp_path / "run", resume=True)
        assert run(tmp_path / "run", Share(Shard(1, 2))) == 0


def test_a_shard_never_removes_results(tmp_path, whole):
    with pytest.raises(WarpdemError, match="would remove what other shards write"):
        run(whole, Share(Shard(1, 2)), force=True)


@pytest.mark.parametrize("text", ["0/2", "3/2", "1", "a/b", "1/0", "-1/2", "1/2/3"])
def test_what_is_no_shard_is_refused(text):
    with pytest.raises(ValueError, match="not a shard such as 2/4"):
        shard_of(text)


def test_a_damaged_chunk_is_made_again(tmp_path, whole, capsys):
    run(tmp_path / "run")
    broken = tmp_path / "run" / "chunks" / "chunk_000003.npz"
    broken.write_bytes(broken.read_bytes()[:-100])
    (tmp_path / "run" / "chunks" / "chunk_000007.npz").unlink()
    scene = skating.scene(tmp_path)
    assert ensemble.run_rockfall(scene, tmp_path / "run", resume=True) == 0
    told = capsys.readouterr().err
    assert "chunk_000003.npz: not a readable chunk" in told
    assert "it is made again" in told
    assert "finished: 20 trajectories flown" in told
    assert chunks(tmp_path / "run") == chunks(whole)
    assert results(tmp_path / "run") == results(whole)


def test_another_scene_is_not_resumed_and_the_changed_key_is_named(tmp_path, whole):
    for share, resume in ((ensemble.WHOLE, True), (Share(Shard(1, 2)), False)):
        with pytest.raises(WarpdemError, match=r"differs .* in run\.seed; give another --out"):
            run(whole, share, resume=resume, seed=2)
    (tmp_path / "terrain.asc").write_text("steep")
    with pytest.raises(WarpdemError, match=r"in terrain\.file \(contents\);"):
        run(whole, resume=True)


def test_what_no_trajectory_depends_on_may_change(tmp_path, whole):
    assert run(whole, resume=True, title="other", chunk=50) == 0
    assert summary(whole)["title"] == "other"


def test_a_chunk_of_another_scene_is_refused(tmp_path, whole):
    run(tmp_path / "other", seed=2)
    name = "chunks/chunk_000001.npz"
    (whole / name).write_bytes((tmp_path / "other" / name).read_bytes())
    with pytest.raises(OutputError, match=r"chunk_000001\.npz: made from another scene"):
        run(whole, resume=True)


def test_a_folder_with_files_is_left_alone(tmp_path, whole):
    before = results(whole)
    with pytest.raises(WarpdemError, match="already holds files"):
        run(whole)
    assert results(whole) == before
    (tmp_path / "empty").mkdir()
    with pytest.raises(WarpdemError, match="holds no chunks to resume from"):
        run(tmp_path / "empty", resume=True)
    (tmp_path / "empty" / "notes.txt").write_text("mine")
    with pytest.raises(WarpdemError, match="already holds files"):
        run(tmp_path / "empty", Share(Shard(1, 2)))


def test_force_removes_what_a_run_wrote_and_nothing_else(whole):
    for name in ("notes.txt", "chunks/mine.npz", "my_map.png"):
        (whole / name).write_text("mine")
    (whole / "energy_q95.tif").write_text("old")
    assert run(whole, force=True, count=12) == 0
    names = {path.relative_to(whole).as_posix() for path in whole.rglob("*") if path.is_file()}
    own = {"chunks/chunk_000000.npz", "chunks/chunk_000001.npz", "chunks/plan.json"}
    mine = {"notes.txt", "chunks/mine.npz", "my_map.png"}
    assert names == own | mine | {"summary.json", *skating.RESULTS}


def test_a_scene_that_cannot_be_built_leaves_old_results_alone(tmp_path, whole, monkeypatch):
    def refuse(*_):
        raise WarpdemError("no such terrain")

    monkeypatch.setattr(task, "prepared", refuse)
    before = results(whole) | chunks(whole)
    with pytest.raises(WarpdemError, match="no such terrain"):
        run(whole, force=True)
    assert results(whole) | chunks(whole) == before
    with pytest.raises(WarpdemError, match="no such terrain"):
        run(tmp_path / "new", Share(Shard(1, 2)))
    monkeypatch.setattr(task, "prepared", skating.prepared)
    assert run(tmp_path / "new") == 0  # a lock that is left is no result


def test_a_full_disk_leaves_finished_chunks_good(tmp_path, whole):
    with files_at_most(4000), pytest.raises(OutputError, match="File too large; finished chunks"):
        run(tmp_path / "run", chunk=10, threads=1)
    assert run(tmp_path / "run", resume=True) == 0
    assert results(tmp_path / "run") == results(whole)


def test_a_full_file_system_leaves_finished_chunks_good(tmp_path, whole):
    with tiny_disk(tmp_path / "disk", "72k") as disk:
        (disk / "terrain.asc").write_text("flat")
        with pytest.raises(OutputError, match=r"No space left on device; finished chunks"):
            run(disk / "run", threads=1)
        kept = chunks(disk / "run")
        assert kept
        assert not list((disk / "run").rglob("*.part"))
        (tmp_path / "run" / "chunks").mkdir(parents=True)
        for path in (disk / "run" / "chunks").iterdir():
            (tmp_path / "run" / "chunks" / path.name).write_bytes(path.read_bytes())
    assert run(tmp_path / "run", resume=True) == 0
    assert kept.items() <= chunks(tmp_path / "run").items()
    assert results(tmp_path / "run") == results(whole)


def test_a_trajectory_that_goes_wrong_ends_the_run_and_keeps_its_chunks(tmp_path):
    with pytest.raises(UnstableError, match="trajectory 57: flew off"):
        run(tmp_path / "run", threads=1, fatal=57)
    assert len(chunks(tmp_path / "run")) == 5
    assert summary(tmp_path / "run")["status"] == "unstable"


def test_the_last_line_says_where_the_results_are(tmp_path, capsys):
    ensemble.run_rockfall(skating.scene(tmp_path), tmp_path / "run", threads=1)
    told = capsys.readouterr().err
    assert told.endswith(f"finished: 103 trajectories flown; results in {tmp_path / 'run'}\n")


def test_the_public_run_knows_the_method(tmp_path):
    scene = skating.scene(tmp_path)
    assert runner.run(scene, tmp_path / "run", threads=1, quiet=True) == 0
    scene.run.method = "smooth"
    with pytest.raises(WarpdemError, match="--shard and --workers are for ensembles"):
        runner.run(scene, tmp_path / "run", share=Share(Shard(1, 2)))


def test_a_scheduler_without_workers_is_refused():
    with pytest.raises(WarpdemError, match="only with --workers dask"):
        Share(scheduler="tcp://host:8786")
