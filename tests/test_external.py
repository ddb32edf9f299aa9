"""The laws of the forces on single bodies, one by one."""

import numpy as np
import pytest
import warp as wp
from warpdem.kernels.external import (
    barrier_factor,
    between_nodes,
    damping_factor,
    mean_damping_factor,
    nearest_node,
    quadratic_drag,
)
from warpdem.kernels.precision import wide, wide3


@wp.kernel(enable_backward=False)
def look_up(
    field: wp.array(dtype=wide3, ndim=3),
    places: wp.array(dtype=wide3),
    near: wp.array(dtype=wide3),
    between: wp.array(dtype=wide3),
):
    k = wp.tid()
    near[k] = nearest_node(field, places[k])
    between[k] = between_nodes(field, places[k])


def values(velocity, places):
    """Nearest and trilinear values of a grid at places, in spacings from its first node."""
    count = len(places)
    near, between = (wp.zeros(count, dtype=wide3, device="cpu") for _ in range(2))
    arrays = [
        wp.array(velocity, dtype=wide3, device="cpu"),
        wp.array(places, dtype=wide3, device="cpu"),
    ]
    wp.launch(look_up, dim=count, inputs=[*arrays, near, between], device="cpu")
    return near.numpy(), between.numpy()


def test_drag_is_against_the_motion_and_goes_with_the_square_of_the_speed():
    force = quadratic_drag(wide(0.5), wide3(3.0, 0.0, -4.0), wide(np.inf))
    assert list(force) == pytest.approx([-7.5, 0.0, 10.0], rel=1e-15)
    cut = quadratic_drag(wide(0.5), wide3(3.0, 0.0, -4.0), wide(2.0))
    assert list(cut) == pytest.approx([-6.0, 0.0, 8.0], rel=1e-15)


def test_trilinear_values_are_exact_for_multilinear_fields_and_held_beyond_the_border():
    shape = np.array([4, 3, 5])
    i, j, k = np.meshgrid(*(np.arange(n) for n in shape), indexing="ij")

    def field(x, y, z):
        return np.stack([1.0 + 2.0 * x - y, 3.0 * z + x * y, x * y * z], axis=-1)

    places = np.random.default_rng(0).uniform(-1.0, shape, (200, 3))
    inside = np.clip(places, 0.0, shape - 1.0)
    _, between = values(field(i, j, k).astype(float), places)

    assert between == pytest.approx(field(*inside.T), rel=1e-13, abs=1e-13)


def test_the_nearest_node_is_taken_also_beyond_the_border():
    velocity = np.random.default_rng(1).normal(size=(3, 4, 2, 3))
    places = np.array([[0.49, 0.0, 0.0], [0.51, 2.6, 0.9], [-7.0, 99.0, 1e30]])
    near, _ = values(velocity, places)

    assert np.array_equal(near, velocity[[0, 1, 0], [0, 3, 3], [0, 1, 1]])


def test_a_grid_of_one_node_is_the_same_everywhere():
    near, between = values(np.array([[[[1.0, 2.0, 3.0]]]]), np.array([[5.0, -1.0, 0.3]]))

    assert near.tolist() == between.tolist() == [[1.0, 2.0, 3.0]]


@pytest.mark.parametrize(("power", "factor"), [(2.0, 0.7), (-2.0, 1.3), (0.0, 1.3)])
def test_cundalls_damping_lowers_forces_that_do_work(power, factor):
    assert damping_factor(wide(power), wide(0.3)) == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize(
    ("power", "own", "other", "factor"),
    [
        (5.0, 1.0, 0.0, 0.7),
        (-5.0, 1.0, 0.0, 1.3),
        # the power passes zero after half of the step: 1.3 before, 0.7 after
        (-0.65, 1.0, 0.0, 1.0),
        # it reaches zero after 0.4 of the step, and there a factor of 0.9 holds it
        (-0.16, 1.0, -0.9, 0.4 * 1.3 + 0.6 * 0.9),
        # at rest under a force that balances, and under none
        (0.0, 1.0, -1.1, 1.1),
        (0.0, 0.0, 0.0, 1.0),
    ],
)
def test_mean_damping_sees_the_power_change_its_sign(power, own, other, factor):
    found = mean_damping_factor(*map(wide, (power, own, other, 1.0, 0.3)))
    assert found == pytest.approx(factor, rel=1e-14)


@pytest.mark.parametrize("exponent", [1.0, 2.5, 8.0])
def test_a_barrier_is_open_at_rest_shut_at_its_limit_and_pushes_back_beyond(exponent):
    def factor(speed):
        return barrier_factor(wide(speed), wide(2.0), wide(exponent))

    assert factor(0.0) == 1.0
    assert factor(2.0) == factor(-2.0) == 0.0
    assert factor(1e300) == pytest.approx(-1.0, rel=1e-12)
    ratio = 0.75**exponent
    assert factor(-1.5) == pytest.approx((1.0 - ratio) / (1.0 + ratio), rel=1e-14)
    assert factor(4.0) == pytest.approx(-factor(1.0), rel=1e-14)
