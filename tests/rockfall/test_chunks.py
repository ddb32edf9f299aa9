"""Chunks: which trajectories each holds, and files that are whole, absent or refused."""

import errno
from dataclasses import fields, is_dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import skating

from warpdem.errors import OutputError, WarpdemError
from warpdem.output import durable
from warpdem.output.scene_keys import differing, refuse_differing
from warpdem.rockfall.chunk_folder import Agreement, ChunkFolder, agree, agreed
from warpdem.rockfall.chunks import (
    CUDA_SIZES,
    SIZES,
    Chunk,
    ForeignChunkError,
    Plan,
    encode,
    planned,
    read,
)
from warpdem.rockfall.fingerprint import decisive, fingerprint
from warpdem.rockfall.finish import chosen_ids, followed
from warpdem.rockfall.task import CUDA_SLOTS, Work

PLAN = Plan(count=25, size=10)
KEYS = {"run.seed": 1}


def chunk(index, plan=PLAN):
    flyer = skating.Skating(skating.SITE, (), skating.Method(1.0, dt=0.0), device="cpu", slots=1)
    flights = flyer.fly(skating.starts(plan.ids(index), seed=1))
    return Chunk(index, flights, skating.Passages.of(flights, skating.SITE).arrays())


def same(one, other):
    return all(
        same(getattr(one, field.name), getattr(other, field.name))
        if is_dataclass(getattr(one, field.name))
        else np.array_equal(getattr(one, field.name), getattr(other, field.name))
        and getattr(one, field.name).dtype == getattr(other, field.name).dtype
        for field in fields(one)
        if field.name != "visits"
    )


@pytest.fixture
def folder(tmp_path):
    agreement = agree(tmp_path / "chunks", Agreement(PLAN, KEYS))
    return ChunkFolder(tmp_path / "chunks", agreement)


def test_chunks_hold_every_trajectory_once():
    assert len(PLAN) == 3
    ids = np.concatenate([PLAN.ids(index) for index in range(3)])
    assert ids.tolist() == list(range(25))
    assert ids.dtype == np.int64
    assert [PLAN.trajectories(index) for index in range(3)] == [10, 10, 5]


@pytest.mark.parametrize(
    ("count", "threads", "size"),
    [(10, 2, SIZES[0]), (100_000, 2, 2500), (10**9, 2, SIZES[1]), (10**6, 64, 782)],
)
def test_a_chosen_chunk_gives_each_thread_some_twenty(count, threads, size):
    assert planned(count, None, threads, cuda=False) == Plan(count, size)
    assert planned(count, 7, threads, cuda=True) == Plan(count, 7)
    on_cuda = planned(count, None, 1, cuda=True).size
    assert on_cuda >= size
    assert CUDA_SIZES[0] <= on_cuda <= CUDA_SIZES[1]


def test_a_chunk_comes_back_bit_for_bit_without_its_visits(folder):
    written = chunk(1)
    folder.store(1, encode(written, folder.fingerprint))
    (back,) = folder
    assert back.index == 1
    assert same(back.flights, written.flights)
    assert np.array_equal(back.tally["passages"], written.tally["passages"])
    assert len(back.flights.visits.id) == 0


def test_equal_chunks_give_equal_bytes():
    assert encode(chunk(1), "f") == encode(chunk(1), "f")


@pytest.mark.parametrize("place", [10, 200, 2000, -400, -30])
def test_a_chunk_with_a_wrong_bit_or_an_end_too_early_is_damaged(folder, place):
    data = bytearray(encode(chunk(1), folder.fingerprint))
    for broken in (data[:place], b"", bytes(len(data))):
        folder.file(1).write_bytes(broken)
        with pytest.raises(OutputError, match="not a readable chunk"):
            read(folder.file(1), 1, PLAN, folder.fingerprint)
    told = []
    assert folder.missing(range(3), told.append) == [0, 1, 2]
    assert len(told) == 1
    with pytest.raises(OutputError, match="--resume makes it again"):
        list(folder)


def test_wrong_bytes_never_pass_unseen(folder):
    data = encode(chunk(2), folder.fingerprint)
    whole = chunk(2).flights
    rng = np.random.default_rng(1)
    for place in rng.integers(0, len(data), 100):
        broken = bytearray(data)
        broken[place] ^= 0xFF
        folder.file(2).write_bytes(broken)
        try:
            back = read(folder.file(2), 2, PLAN, folder.fingerprint)
        except OutputError:
            continue
        assert same(back.flights, whole)  # a byte that nobody reads


@pytest.mark.parametrize(
    ("index", "mark", "reason"),
    [(1, "other", "from another scene"), (0, None, "holds chunk 0, not 1")],
)
def test_a_chunk_that_belongs_elsewhere_is_refused(folder, index, mark, reason):
    folder.file(1).write_bytes(encode(chunk(index), mark or folder.fingerprint))
    with pytest.raises(ForeignChunkError, match=reason):
        folder.missing([1], print)
    with pytest.raises(ForeignChunkError, match=reason):
        list(folder)


def test_a_chunk_of_another_plan_is_refused(folder):
    data = encode(chunk(1, Plan(25, 5)), folder.fingerprint)
    folder.file(1).write_bytes(data)
    with pytest.raises(ForeignChunkError, match="other trajectories than those of chunk 1"):
        list(folder)


def test_a_full_disk_leaves_no_part_and_names_the_file(folder, monkeypatch):
    def refuse(path):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(durable, "sync", refuse)
    with pytest.raises(OutputError, match=r"chunk_000001\.npz: No space left on device"):
        folder.store(1, b"data")
    assert [path.name for path in folder.path.iterdir()] == ["plan.json"]


def test_the_first_plan_holds_for_all(tmp_path):
    first = agree(tmp_path, Agreement(PLAN, KEYS))
    second = agree(tmp_path, Agreement(Plan(25, 3), KEYS))
    assert first == second == agreed(tmp_path) == Agreement(PLAN, KEYS)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]


def test_a_changed_scene_is_refused_by_its_keys(tmp_path):
    refuse_differing(tmp_path, differing(KEYS, {**KEYS}))
    with pytest.raises(WarpdemError, match=r"differs .* in a, b, c, d, e and 2 more;"):
        refuse_differing(tmp_path, differing({}, dict.fromkeys("abcdefg")))


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"layout": 1, "plan": {"size": 1}, "keys": {}}'])
def test_a_damaged_plan_is_told(tmp_path, text):
    (tmp_path / "plan.json").write_text(text)
    with pytest.raises(OutputError, match="not a readable plan"):
        agreed(tmp_path)


def test_a_plan_of_another_layout_is_told(tmp_path):
    (tmp_path / "plan.json").write_text('{"layout": 99, "plan": {}, "keys": {}}')
    with pytest.raises(WarpdemError, match="in layout 99, this program reads layout 1"):
        agreed(tmp_path)


def test_the_fingerprint_knows_files_and_seeds_but_not_titles(tmp_path):
    (tmp_path / "terrain.asc").write_text("flat")
    one = decisive(skating.scene(tmp_path))
    assert one == decisive(skating.scene(tmp_path, title="other", chunk=3))
    assert fingerprint(one) != fingerprint(decisive(skating.scene(tmp_path, seed=2)))
    (tmp_path / "terrain.asc").write_text("steep")
    assert fingerprint(one) != fingerprint(decisive(skating.scene(tmp_path)))


def test_the_fingerprint_knows_the_tables_of_shapefiles(tmp_path):
    (tmp_path / "areas.dbf").write_text("one")
    scene = skating.scene(tmp_path, terrain="areas.shp")
    assert "terrain.file (contents of .dbf)" in decisive(scene)


def test_chosen_trajectories_are_the_first_or_those_listed():
    assert chosen_ids(3, 2) == [0, 1]
    assert chosen_ids((7, 1, 7, 90), 10) == [1, 7]
    assert chosen_ids(0, 10) == []


def test_drawn_trajectories_take_as_many_slots_as_they_are_and_never_more_than_a_thread_has():
    given = []

    def make(site, rocks, method, *, device, slots):
        given.append(slots)
        return SimpleNamespace(load=lambda: None, follow=lambda starts, every: [])

    work = Work(skating.SITE, (), skating.Method(1.0), "cuda:0", "", make, skating.Passages.of)
    output = SimpleNamespace(trajectories=(2, 5, 900), trajectory_every=0.1)
    none = SimpleNamespace(id=(), rock=())
    releases = SimpleNamespace(count=10, starts=lambda ids: none)
    followed(SimpleNamespace(output=output), SimpleNamespace(work=work, releases=releases))
    for slots in (None, CUDA_SLOTS + 1):
        work.flyer(slots)
    assert given == [2, CUDA_SLOTS, CUDA_SLOTS]
