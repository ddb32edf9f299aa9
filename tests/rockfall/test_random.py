import numpy as np
import pytest

from warpdem.geometry.orientation import matrix
from warpdem.rockfall.compass import direction, sine_cosine
from warpdem.rockfall.random import Purpose, Streams

MANY = np.arange(1_000_001)
SOME = np.arange(200_000)


def rows(streams, draws=2):
    numbers = [streams.words(Purpose.PLACE, draw) for draw in range(draws)]
    return np.column_stack(numbers)


def test_a_million_trajectories_have_streams_of_their_own():
    found = rows(Streams(1, MANY))
    assert len(np.unique(found.reshape(-1))) == found.size
    assert len(np.unique(found, axis=0)) == len(MANY)


def test_two_seeds_share_no_number():
    first, second = rows(Streams(1, MANY)).reshape(-1), rows(Streams(2, MANY)).reshape(-1)
    assert len(np.intersect1d(first, second)) == 0


def test_two_purposes_share_no_number():
    first, second = (Streams(1, SOME).words(p, 0) for p in (Purpose.PLACE, Purpose.HEIGHT))
    assert len(np.intersect1d(first, second)) == 0


def test_uniform_numbers_fill_all_bins_alike():
    bins, expected, chis = 1000, len(SOME) / 1000, []
    for seed in range(10):
        for draw in range(3):
            found = Streams(seed, SOME).uniform(Purpose.SPEED, draw)
            assert found.min() >= 0.0
            assert found.max() < 1.0
            filled = np.histogram(found, bins, (0.0, 1.0))[0]
            chis.append(((filled - expected) ** 2 / expected).sum())
    sigma = np.sqrt(2.0 * (bins - 1))
    assert abs(np.mean(chis) - (bins - 1)) < 3.0 * sigma / np.sqrt(len(chis))
    assert np.abs(np.array(chis) - (bins - 1)).max() < 5.0 * sigma


def test_neighbouring_trajectories_and_draws_are_uncorrelated():
    numbers = np.column_stack([Streams(3, SOME).uniform(Purpose.PLACE, k) for k in range(4)])
    shifted = np.column_stack([numbers[:-1], numbers[1:]])
    off = np.corrcoef(shifted.T) - np.eye(8)
    assert np.abs(off).max() < 5.0 / np.sqrt(len(SOME))


def test_directions_are_isotropic():
    found = Streams(5, SOME).directions(Purpose.SPIN_AXIS)
    sigma = 1.0 / np.sqrt(len(SOME))
    assert np.abs(np.linalg.norm(found, axis=1) - 1.0).max() < 1e-15
    assert np.abs(found.mean(axis=0)).max() < 5.0 * sigma
    assert np.abs(found.T @ found / len(found) - np.eye(3) / 3.0).max() < 3.0 * sigma


def test_orientations_are_isotropic():
    found = Streams(5, SOME).quaternions(Purpose.ORIENTATION)
    sigma = 1.0 / np.sqrt(len(SOME))
    assert np.abs(np.linalg.norm(found, axis=1) - 1.0).max() < 1e-15
    assert np.abs(matrix(found).mean(axis=0)).max() < 5.0 * sigma
    assert np.abs(found.T @ found / len(found) - np.eye(4) / 4.0).max() < 3.0 * sigma
    # of a uniform point on the sphere in four dimensions <w^4> = 3/24
    assert (found**4).mean(axis=0) == pytest.approx(np.full(4, 0.125), abs=5.0 * sigma)


@pytest.mark.parametrize("what", ["uniform", "directions", "quaternions"])
def test_numbers_do_not_depend_on_the_batch(what):
    ids = np.arange(1000, 3001)
    whole = getattr(Streams(9, ids), what)(Purpose.ORIENTATION)
    parts = [getattr(Streams(9, part), what)(Purpose.ORIENTATION) for part in np.split(ids, [7])]
    single = [getattr(Streams(9, ids[k : k + 1]), what)(Purpose.ORIENTATION) for k in (0, 8, 2000)]
    assert np.array_equal(whole, np.concatenate(parts))
    assert np.array_equal(whole[[0, 8, 2000]], np.concatenate(single))


def splitmix(word):
    word = (word + 0x9E3779B97F4A7C15) % 2**64
    word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
    word = (word ^ (word >> 27)) * 0x94D049BB133111EB % 2**64
    return word ^ (word >> 31)


def test_words_are_those_of_whole_numbers_without_bounds():
    assert splitmix(0) == 0xE220A8397B1DCDAF  # the first number of SplitMix64 of seed 0
    ids = [0, 1, 2**40]
    found = Streams(1, np.array(ids)).words(Purpose.PLACE, 3).tolist()
    number = splitmix((int(Purpose.PLACE) << 48) + 3)
    assert found == [
        splitmix(splitmix(splitmix(splitmix(1)) ^ splitmix(id_)) ^ number) for id_ in ids
    ]


def test_sine_and_cosine_are_right_to_the_last_digits():
    angle = np.linspace(-720.0, 720.0, 100_001)
    sine, cosine = sine_cosine(angle)
    assert np.abs(sine - np.sin(np.radians(angle))).max() < 2e-15
    assert np.abs(cosine - np.cos(np.radians(angle))).max() < 2e-15
    assert sine_cosine(np.array([0.0, 90.0, 180.0, 270.0]))[0].tolist() == [0.0, 1.0, 0.0, -1.0]


def test_azimuth_turns_from_north_to_east_and_dip_goes_down():
    found = direction(np.array([0.0, 90.0, 225.0, 10.0]), np.array([0.0, 0.0, 0.0, 90.0]))
    half = np.sqrt(0.5)
    wanted = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-half, -half, 0.0], [0.0, 0.0, -1.0]]
    assert found == pytest.approx(np.array(wanted), abs=1e-15)
