"""Mass properties kept from one start to the next."""

import numpy as np
import pytest

from warpdem.geometry import remembered as memory
from warpdem.geometry.polyhedron import build

# an L: not convex, so that its rounding has to be integrated
CORNERS = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
VERTICES = [(x, y, z) for z in (0.0, 1.0) for x, y in CORNERS]
FACES = [
    [5, 4, 3, 2, 1, 0],
    [6, 7, 8, 9, 10, 11],
    *([k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k] for k in range(6)),
]


@pytest.fixture
def kept(tmp_path, monkeypatch):
    monkeypatch.setenv("WARPDEM_CACHE_PATH", str(tmp_path / "cache"))
    monkeypatch.setattr(memory, "SLOW", 0.0)
    return tmp_path / "cache"


def angle(radius=0.1):
    return build(VERTICES, FACES, name="angle", radius=radius)


def facts(shape):
    return (
        shape.volume,
        shape.volume_error,
        shape.inertia_over_mass.tobytes(),
        shape.frame_origin.tobytes(),
        shape.frame_rotation.tobytes(),
    )


def refuse(*_):
    pytest.fail("integrated again")


def test_what_was_integrated_is_remembered_to_the_last_bit(kept, monkeypatch):
    first = angle()
    monkeypatch.setattr("warpdem.geometry.polyhedron.overlapping_properties", refuse)

    assert facts(angle()) == facts(first)
    assert len(list(kept.iterdir())) == 1


def test_another_rounding_is_another_solid(kept):
    assert angle(0.1).volume < angle(0.2).volume
    assert len(list(kept.iterdir())) == 2


def test_a_damaged_file_is_integrated_again(kept):
    first = angle()
    (file,) = kept.iterdir()
    file.write_bytes(file.read_bytes()[:100])

    assert facts(angle()) == facts(first)
    assert np.load(file)["values"][0] == first.volume


def test_where_nothing_can_be_kept_it_is_integrated_each_time(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("WARPDEM_CACHE_PATH", str(tmp_path / "file"))
    monkeypatch.setattr(memory, "SLOW", 0.0)

    assert facts(angle()) == facts(angle())


def test_what_is_integrated_at_once_is_not_kept(kept, monkeypatch):
    monkeypatch.setattr(memory, "SLOW", 1e9)
    angle()

    assert not kept.exists()
