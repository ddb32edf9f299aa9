"""The small laws of the device code, called from Python: real numbers in, closed formulas out."""

import numpy as np
import pytest
import warp as wp
from gates import gate
from warpdem.kernels.normal import hooke, onset, pair_frequency, predicted_force
from warpdem.kernels.precision import quat, vec3, wide, wide3
from warpdem.kernels.rotation import (
    arc,
    exponential,
    free_drift,
    inertia,
    inverse_inertia,
    no_squish,
    rkmk4,
    taylor_drift,
)
from warpdem.kernels.tangential import coulomb, laid, radial_return, slip_direction, spun

from warpdem.geometry.orientation import product, turned

UP = wide3(0.0, 0.0, 1.0)
AT_REST = quat(0.0, 0.0, 0.0, 1.0)
BRICK = wide3(1.0, 2.0, 3.0)


def as_kind(value, kind):
    vectors = (wide3, vec3)
    return kind(*value) if kind in vectors else kind(value) if isinstance(value, float) else value


def of(law, *arguments):
    """A device function's value; numbers and vectors are given as it takes them."""
    kinds = law.input_types.values()
    value = law(*(as_kind(a, kind) for a, kind in zip(arguments, kinds, strict=True)))
    return float(value) if np.ndim(value) == 0 else np.array(value)


def scalar_first(q):
    return np.array(q)[[3, 0, 1, 2]]


# normal force


def test_hooke_adds_spring_and_dashpot():
    assert of(hooke, 1e6, 2e-6, 1e-3, 0.5) == pytest.approx(1e6 * (2e-6 + 1e-3 * 0.5))


def test_hooke_never_pulls_on_fast_separation():
    assert of(hooke, 1e6, 1e-6, 1e-3, -10.0) == 0.0


def test_predicted_hooke_is_that_of_the_velocity_it_causes_itself():
    k, d, tau, beta, before, predicted = 1e6, 1e-4, 2e-3, 0.3, 40.0, 0.1
    f = of(predicted_force, k * (d + tau * predicted), beta, before)
    own = predicted + (before - f) * beta / (k * tau)
    assert f == pytest.approx(k * (d + tau * own), rel=gate(1e-14, mixed=1e-6))


def test_contact_begins_at_the_part_of_the_step_in_which_it_advanced_its_overlap():
    dt, speed = 1e-4, 2.0
    assert of(onset, 0.3 * dt * speed, speed, dt) == pytest.approx(0.3)


def test_contact_that_lasted_the_whole_step_has_no_onset():
    assert of(onset, 3e-4, 2.0, 1e-4) == 1.0
    assert of(onset, 1e-6, -2.0, 1e-4) == 1.0


def test_pair_frequency_of_equal_parallel_contacts_grows_with_their_number():
    m_eff, d = 0.25, 1e-4
    for count in (1, 4, 16):
        force = wide3(0.0, 0.0, count * d)
        nothing = wide3()
        squares = count * d * d
        arguments = (force, nothing, nothing, nothing, nothing, squares, squares, 1.0 / m_eff)
        assert of(pair_frequency, *arguments) == pytest.approx(count / m_eff)


def test_pair_frequency_of_a_contact_beside_the_centre_counts_rotation():
    mass, moment, arm, d = 2.0, 0.3, 0.4, 1e-4
    torque = wide3(0.0, arm * d, 0.0)
    spin = wide3(0.0, arm * d / moment, 0.0)
    nothing = wide3()
    arguments = (wide3(0.0, 0.0, d), torque, nothing, spin, nothing, d * d, d * d, 1.0 / mass)
    assert of(pair_frequency, *arguments) == pytest.approx(1.0 / mass + arm**2 / moment)


def test_pinched_body_has_at_least_the_frequency_of_a_single_contact():
    nothing = wide3()
    arguments = (nothing, nothing, nothing, nothing, nothing, 2e-8, 2e-8, 4.0)
    assert of(pair_frequency, *arguments) == 4.0


# friction


def test_followed_friction_keeps_its_length_and_lies_in_the_plane():
    old, normal = wide3(3.0, -1.0, 0.2), wp.normalize(wide3(0.1, 0.2, 1.0))
    new = of(laid, old, normal)
    assert np.linalg.norm(new) == pytest.approx(np.linalg.norm(np.array(old)))
    assert new @ np.array(normal) == pytest.approx(0.0, abs=1e-15)


def test_followed_friction_turns_with_the_spin_about_the_normal():
    for angle in (0.3, 3e-3):
        new = of(spun, wide3(2.0, 0.0, 0.5), UP, angle)
        turned = np.arctan2(new[1], new[0])
        assert np.hypot(new[0], new[1]) == pytest.approx(2.0, rel=1e-15)
        assert new[2] == 0.5
        assert turned == pytest.approx(2.0 * np.arctan(0.5 * angle), rel=1e-12)
        assert abs(turned - angle) < angle**3 / 11.0


def test_friction_along_the_normal_is_forgotten():
    assert (of(laid, wide3(0.0, 0.0, 2.0), UP) == 0.0).all()


def test_radial_return_cuts_to_the_cap_and_keeps_the_direction():
    assert (of(radial_return, wide3(0.3, 0.4, 0.0), 1.0) == [0.3, 0.4, 0.0]).all()
    assert of(radial_return, wide3(3.0, 4.0, 0.0), 1.0) == pytest.approx([0.6, 0.8, 0.0])
    assert (of(radial_return, wide3(), 0.0) == 0.0).all()


def slip_angle(start, s):
    """Angle from u of the solution of t' = u - (u.t) t: tan(angle/2) falls as exp(-s)."""
    return 2.0 * np.arctan(np.tan(0.5 * start) * np.exp(-s))


def slip_error(s, start=1.2):
    t = of(slip_direction, wide3(np.cos(start), np.sin(start), 0.0), wide3(1.0, 0.0, 0.0), s)
    assert np.linalg.norm(t) == pytest.approx(1.0)
    return abs(np.arctan2(t[1], t[0]) - slip_angle(start, s))


def test_slip_turns_towards_the_sliding_velocity_to_third_order_a_step():
    assert slip_error(0.02) < 2e-6
    assert np.log2(slip_error(0.02) / slip_error(0.01)) == pytest.approx(3.0, abs=0.05)


def test_slip_is_along_the_sliding_velocity_after_long_slip():
    assert slip_error(1e6) < 1e-5


def test_friction_sticks_as_a_spring_below_the_cap():
    start, rate = wide3(1.0, 0.0, 0.0), wide3(0.0, 2.0, 0.0)
    assert of(coulomb, start, rate, 0.5, 2.0, 2.0, False) == pytest.approx([1.0, 1.0, 0.0])


@pytest.mark.parametrize("slid", [False, True])
def test_friction_never_exceeds_mu_times_the_normal_force(slid):
    random = np.random.default_rng(1)
    for start, rate in random.normal(size=(20, 2, 3)) * [1.0, 1.0, 0.0]:
        cap, before = random.uniform(0.01, 1.0, 2)
        ft = of(coulomb, wide3(*start), wide3(*rate), 0.7, float(cap), float(before), slid)
        trial = np.linalg.norm(start + 0.7 * rate)
        assert np.linalg.norm(ft) == pytest.approx(min(cap, trial))


def test_friction_that_begins_to_slip_keeps_the_direction_of_the_spring():
    ft = of(coulomb, wide3(0.6, 0.0, 0.0), wide3(0.0, 0.8, 0.0), 1.0, 0.5, 0.6, False)
    assert ft == pytest.approx([0.3, 0.4, 0.0])


def test_friction_that_slides_straight_on_stays_so():
    ft = of(coulomb, wide3(0.5, 0.0, 0.0), wide3(3.0, 0.0, 0.0), 1.0, 0.4, 0.5, True)
    assert ft == pytest.approx([0.4, 0.0, 0.0])


def test_friction_vanishes_with_the_normal_force():
    assert (of(coulomb, wide3(0.5, 0.0, 0.0), wide3(3.0, 0.0, 0.0), 1.0, 0.0, 0.0, True) == 0).all()


# rotation


def symmetric_top(moment, axial, momentum, t):
    """Exact orientation of a free symmetric top that starts along the axes; moments 1, 2 equal."""
    size = np.linalg.norm(momentum)
    rate = momentum[2] * (1.0 / axial - 1.0 / moment)
    precession = 0.5 * size / moment * t
    outer = np.append(np.cos(precession), np.sin(precession) * momentum / size)
    own = np.array([np.cos(0.5 * rate * t), 0.0, 0.0, np.sin(0.5 * rate * t)])
    return product(outer, own)


def error_of_a_step(dt, drift):
    """Of a drift from an orientation in which no part of the quaternion vanishes."""
    start, momentum = np.array([0.5, 0.5, -0.5, 0.5]), np.array([0.4, -0.3, 0.8])
    world = turned(start, momentum)
    q = drift(quat(*start[[1, 2, 3, 0]]), wide3(*world), wide3(1.0, 1.0, 2.5), dt)
    exact = product(start, symmetric_top(1.0, 2.5, momentum, dt))
    return min(np.linalg.norm(q - exact), np.linalg.norm(q + exact))


def squished(q, momentum, moment, dt):
    return scalar_first(no_squish(q, momentum, moment, wide(dt)))


def munthe_kaas(q, momentum, moment, dt):
    return scalar_first(rkmk4(q, momentum, moment, wide(dt)))


def expanded(q, momentum, moment, dt):
    # a free body of the first-order drift has the gyroscopic torque -w x L
    torque = -wp.cross(inverse_inertia(q, moment, momentum), momentum)
    return scalar_first(taylor_drift(q, momentum, torque, moment, wide(dt))[0])


def test_no_squish_step_errs_by_the_cube_of_the_step():
    errors = [error_of_a_step(dt, squished) for dt in (0.04, 0.02)]
    assert errors[0] < 1e-5
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3.0, abs=0.05)


def test_rkmk4_step_errs_by_the_fifth_power_of_the_step():
    errors = [error_of_a_step(dt, munthe_kaas) for dt in (0.4, 0.2)]
    assert errors[0] < 1e-5
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5.0, abs=0.1)


def test_taylor_step_errs_by_the_square_of_the_step():
    errors = [error_of_a_step(dt, expanded) for dt in (0.04, 0.02)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_no_squish_runs_backwards_to_its_start():
    momentum, dt = wide3(0.4, -0.3, 0.8), 0.3
    there = no_squish(AT_REST, momentum, BRICK, wide(dt))
    back = no_squish(there, momentum, BRICK, wide(-dt))
    assert of(arc, back, AT_REST) < 1e-15


def test_ball_turns_about_its_spin_exactly():
    momentum = np.array([0.4, -0.3, 0.8])
    q, _ = free_drift(AT_REST, wide3(*momentum), wide3(), wide3(2.0, 2.0, 2.0), wide(0.7))
    angle = 0.5 * 0.7 * np.linalg.norm(momentum) / 2.0
    axis = momentum / np.linalg.norm(momentum)
    assert scalar_first(q) == pytest.approx(np.append(np.cos(angle), np.sin(angle) * axis))


def test_half_kick_adds_torque_to_the_world_angular_momentum():
    for moment in (BRICK, wide3(2.0, 2.0, 2.0)):
        _, kicked = free_drift(
            AT_REST, wide3(1.0, 0.0, 0.0), wide3(0.0, 4.0, 0.0), moment, wide(0.1)
        )
        assert np.array(kicked) == pytest.approx([1.0, 0.2, 0.0])


def test_body_at_rest_stays_as_it_is():
    assert (np.array(exponential(AT_REST, wide3(), wide(0.1))) == np.array(AT_REST)).all()
    assert (np.array(no_squish(AT_REST, wide3(), BRICK, wide(0.1))) == np.array(AT_REST)).all()
    assert (np.array(rkmk4(AT_REST, wide3(), BRICK, wide(0.1))) == np.array(AT_REST)).all()


def test_inverse_inertia_undoes_inertia_in_any_orientation():
    q = wp.normalize(quat(0.3, -0.2, 0.5, 0.7))
    spin = wide3(1.0, -2.0, 0.5)
    again = inverse_inertia(q, BRICK, inertia(q, BRICK, spin))
    assert np.array(again) == pytest.approx(np.array(spin))


def test_arc_is_the_chord_of_the_turn():
    q = quat(0.0, 0.0, float(np.sin(0.4)), float(np.cos(0.4)))
    assert of(arc, q, AT_REST) == pytest.approx(2.0 * np.sin(0.4))
