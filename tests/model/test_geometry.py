"""Rigid transforms: conventions spelled out by elementary motions, exact right angles, inverse."""

import math
import random
from decimal import ROUND_UP, Context, Inexact, localcontext
from fractions import Fraction

import flint
import numpy as np
import pytest

from modrobust.errors import ValueRangeError
from modrobust.model import geometry
from modrobust.model.geometry import IDENTITY, arctan2, cos_sin
from support.float_transforms import (
    dh_modified,
    dh_standard,
    from_xyz_rpy,
    giusti2015,
    giusti2015_iit,
    rotation_to,
    rotation_x,
    rotation_y,
    rotation_z,
    translation,
)

PI = Fraction("3.14159265358979323846264338327950288419716939937510")


def tx(a):
    return translation((a, 0.0, 0.0))


def tz(d):
    return translation((0.0, 0.0, d))


@pytest.mark.parametrize("k", range(-16, 17))
def test_cosine_and_sine_of_quarter_turns_are_exact(k):
    assert cos_sin(float(k * PI / 2)) == [(1, 0), (0, 1), (-1, 0), (0, -1)][k % 4]


def test_no_other_angle_is_snapped():
    for angle in (math.nextafter(math.pi / 2, 0), math.nextafter(math.pi, 4), 17 * math.pi / 2):
        assert all(value not in (-1, 0, 1) for value in cos_sin(angle))
    assert cos_sin(math.nextafter(math.pi / 2, 0))[0] > 0.0


def test_quarter_turns_in_degrees_are_exact_however_many():
    for k in (-1001, 17, 40, 1003):
        assert list(cos_sin(k * PI / 2)) == [[1, 0], [0, 1], [-1, 0], [0, -1]][k % 4]


def test_cosine_and_sine_hold_fifty_decimals_up_to_the_largest_angle():
    rng = random.Random(0)
    flint.ctx.prec = 400
    for size in (1e-30, 1e-9, 0.1, 1.0, 10.0, 1e5):
        for _ in range(20):
            angle = Fraction(rng.uniform(-size, size)) + Fraction(1, 3**40)
            exact = flint.arb(flint.fmpq(angle.numerator, angle.denominator))
            for computed, truth in zip(cos_sin(angle), (exact.cos(), exact.sin()), strict=True):
                assert abs(flint.arb(str(computed)) - truth) < 1e-50


def test_an_angle_beyond_the_limit_is_refused():
    for angle in (1.1e5, -1e300, Fraction(10) ** 400, math.inf):
        with pytest.raises(ValueRangeError, match=r"an angle of .* rad; angles lie within 100000"):
            cos_sin(angle)


def test_the_decimals_of_the_caller_change_nothing():
    expected = geometry.from_xyz_rpy((1, 2, 3), (0.1, 0.2, 0.3)).inverse()
    with localcontext(Context(prec=3, rounding=ROUND_UP, traps=[Inexact])):
        assert geometry.from_xyz_rpy((1, 2, 3), (0.1, 0.2, 0.3)).inverse() == expected


def test_what_cancels_is_zero_and_what_is_small_stays():
    there = geometry.rotation_z(1) @ geometry.translation((0.3, 0, 0))
    assert there @ there.inverse() == IDENTITY
    tiny = geometry.rotation_z(1) @ geometry.translation((Fraction(1, 10**200), 0, 0))
    assert tiny.rounded()[1, 3] == pytest.approx(math.sin(1) * 1e-200, rel=1e-15)


@pytest.mark.parametrize("axis", [(0, 0, 2), (0, 0, -1), (1e-200, 1e-200, 0), (1, 2, -1e-9)])
def test_z_is_turned_to_an_axis(axis):
    turned = rotation_to(axis)[:3, :3]
    unit = np.array(axis) / np.max(np.abs(axis))
    np.testing.assert_allclose(turned[:, 2], unit / np.linalg.norm(unit), rtol=0, atol=2e-16)
    np.testing.assert_allclose(turned @ turned.T, np.eye(3), rtol=0, atol=1e-15)
    assert np.linalg.det(turned) == pytest.approx(1.0)


def test_right_angles_show_no_negative_zero():
    for turn in (rotation_x, rotation_y, rotation_z):
        for angle in (0.0, -0.0, math.pi / 2, -math.pi / 2, math.pi):
            assert not np.any(np.signbit(turn(angle)) & (turn(angle) == 0.0))


@pytest.mark.parametrize(
    ("turn", "start", "end"),
    [(rotation_x, 1, 2), (rotation_y, 2, 0), (rotation_z, 0, 1)],
)
def test_a_quarter_turn_takes_each_axis_to_the_next_by_the_right_hand_rule(turn, start, end):
    turned = turn(math.pi / 2)[:3, :3] @ np.eye(3)[start]
    np.testing.assert_array_equal(turned, np.eye(3)[end])


def test_standard_dh_is_rz_tz_tx_rx():
    expected = rotation_z(0.4) @ tz(0.3) @ tx(0.1) @ rotation_x(0.2)
    np.testing.assert_allclose(dh_standard(0.1, 0.2, 0.3, 0.4), expected, rtol=0, atol=2e-16)


def test_modified_dh_is_rx_tx_rz_tz():
    expected = rotation_x(0.2) @ tx(0.1) @ rotation_z(0.4) @ tz(0.3)
    np.testing.assert_allclose(dh_modified(0.1, 0.2, 0.3, 0.4), expected, rtol=0, atol=2e-16)


def test_giusti_letters_are_their_six_motions_in_order():
    expected = tz(-0.1) @ rotation_z(-0.2) @ tx(0.3) @ rotation_x(0.4) @ tz(0.5) @ rotation_z(0.6)
    computed = giusti2015(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-15)


def test_iit_letters_have_the_opposite_sign_of_p_and_delta_in():
    np.testing.assert_allclose(
        giusti2015_iit(0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
        giusti2015(-0.1, -0.2, 0.3, 0.4, 0.5, 0.6),
        rtol=0,
        atol=1e-15,
    )


def test_rpy_is_yaw_after_pitch_after_roll_also_with_a_pitch():
    expected = rotation_z(0.3) @ rotation_y(0.2) @ rotation_x(0.1)
    expected[:3, 3] = [1.0, 2.0, 3.0]
    computed = from_xyz_rpy((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(computed, expected, rtol=0, atol=1e-15)


def test_pitch_of_a_quarter_turn_points_x_down():
    np.testing.assert_array_equal(from_xyz_rpy(rpy=(0.0, math.pi / 2, 0.0))[:3, 0], [0, 0, -1])


def test_the_inverse_undoes_a_transform_from_both_sides():
    transform = geometry.from_xyz_rpy((0.3, -0.4, 0.5), (0.6, -0.7, 2.8))
    inverse = transform.inverse().rounded()
    np.testing.assert_allclose(inverse @ transform.rounded(), np.eye(4), rtol=0, atol=1e-15)
    np.testing.assert_allclose(transform.rounded() @ inverse, np.eye(4), rtol=0, atol=1e-15)


def test_spans_that_cancel_leave_0_below_a_part_in_10_to_40_and_the_rest_above() -> None:
    """As docs/reference/formats.md says; 0.3 m there and back but for the rest."""
    for rest, left in ((Fraction(2, 10**41), 0.0), (Fraction(5, 10**39), 5e-39)):
        there, back = geometry.translation((0, Fraction(3, 10), 0)), Fraction(-3, 10) + rest
        assert (there @ geometry.translation((0, back, 0))).rounded()[1, 3] == left


def test_the_angle_of_a_direction_is_the_nearest_double():
    """That of libm is not always; which of two doubles it gives depends on the processor."""
    rng = random.Random(3)
    before, flint.ctx.prec = flint.ctx.prec, 400
    try:
        for k in range(300):
            y, x = (rng.gauss(0.0, 1.0) * 10.0 ** rng.uniform(-20.0, 20.0) for _ in range(2))
            x = y * (1.0, -1.0, 1e-17, -1e17)[k // 5 % 4] if k % 5 == 0 else x
            exact = flint.arb.atan2(flint.arb(y), flint.arb(x))
            assert arctan2(y, x) == float(exact.mid().str(60, radius=False)), (y, x)
    finally:
        flint.ctx.prec = before
    assert [arctan2(*at) for at in ((0.0, -1.0), (2.0, 0.0), (0.0, 0.0))] == [
        math.pi, math.pi / 2, 0.0
    ]  # fmt: skip
