"""Rigid transforms: conventions spelled out by elementary motions, exact right angles, inverse."""

import math
from fractions import Fraction

import numpy as np
import pytest

from modrobust.geometry import (
    cos_sin,
    dh_modified,
    dh_standard,
    from_xyz_rpy,
    giusti2015,
    giusti2015_iit,
    inverse,
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
        assert cos_sin(angle) == (math.cos(angle), math.sin(angle))
    assert cos_sin(math.nextafter(math.pi / 2, 0))[0] > 0.0


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
    np.testing.assert_allclose(dh_standard(0.1, 0.2, 0.3, 0.4), expected, rtol=0, atol=1e-16)


def test_modified_dh_is_rx_tx_rz_tz():
    expected = rotation_x(0.2) @ tx(0.1) @ rotation_z(0.4) @ tz(0.3)
    np.testing.assert_allclose(dh_modified(0.1, 0.2, 0.3, 0.4), expected, rtol=0, atol=1e-16)


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
    transform = from_xyz_rpy((0.3, -0.4, 0.5), (0.6, -0.7, 2.8))
    np.testing.assert_allclose(inverse(transform) @ transform, np.eye(4), rtol=0, atol=1e-15)
    np.testing.assert_allclose(transform @ inverse(transform), np.eye(4), rtol=0, atol=1e-15)
