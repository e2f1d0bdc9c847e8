"""The D-H table: forward kinematics to 1e-12 for any serial chain, flags where axes nearly meet."""

import math

import numpy as np
import pytest

from modrobust.assembly import load_robot
from modrobust.model.dh import dh_table
from support.float_transforms import (
    dh_standard,
    from_xyz_rpy,
    rotation_x,
    rotation_z,
    translation,
)

REVOLUTE, PRISMATIC = "revolute", "prismatic"


def dh_forward(table, joint_types, q):
    """Tip frame in the base frame from the table: base, rows, tool."""
    transform = table.base
    for row, kind, position in zip(table.rows, joint_types, q, strict=True):
        turn, shift = (0.0, position) if kind == "prismatic" else (position, 0.0)
        transform = transform @ dh_standard(row.a, row.alpha, row.d + shift, row.theta + turn)
    return transform @ table.tool


def joint_frames_tip(joint_types, before, after, q):
    """Tip frame in the base frame from the module frames."""
    transform = np.eye(4)
    for kind, position, b, a in zip(joint_types, q, before, after, strict=True):
        prismatic = kind == "prismatic"
        motion = translation((0.0, 0.0, position)) if prismatic else rotation_z(position)
        transform = transform @ b @ motion @ a
    return transform


def chain(spans):
    """Serial chain whose joint i is followed by spans[i]; nothing before the joints."""
    n = len(spans)
    return list(range(-1, n - 1)), np.stack([np.eye(4)] * n), np.stack(spans)


def largest_difference(table, kinds, before, after, rng):
    n = len(kinds)
    worst = 0.0
    for q in [np.zeros(n), *rng.uniform(-math.pi, math.pi, (20, n))]:
        difference = dh_forward(table, kinds, q) - joint_frames_tip(kinds, before, after, q)
        worst = max(worst, float(np.max(np.abs(difference))))
    return worst


# Standard D-H table of the real LWA 4P with its gripper, angles to the ten digits printed there.
# Source: AndreaGiusti/OTFCtrlModRob, chain PB1 L1 PB2 L2 PB3 L3.
LWA4P = [
    # a [m], alpha [rad], d [m], theta [rad]
    (0.0, -math.pi / 2, 0.1013, 0.0),
    (0.35, math.pi, 0.1013, -math.pi / 2),
    (0.0, -math.pi / 2, 0.1013, -math.pi / 2),
    (0.0, math.pi / 2, 0.3012, 0.0),
    (0.0, -math.pi / 2, 0.0, 0.0),
    (0.0, 0.0, 0.1548, 0.0),
]


def test_a_chain_described_by_a_table_gives_that_table_back():
    parents, before, after = chain([dh_standard(*row) for row in LWA4P])
    table = dh_table(parents, before, after)
    for row, expected in zip(table.rows, LWA4P, strict=True):
        assert (row.a, row.alpha, row.d, row.theta) == pytest.approx(expected, abs=1e-15)
        assert not row.near_parallel
    np.testing.assert_allclose(table.base, np.eye(4), atol=1e-15)
    np.testing.assert_allclose(table.tool, np.eye(4), atol=1e-15)


def test_the_modules_of_the_real_lwa4p_give_its_published_table():
    table = load_robot("lwa4p").dh
    assert table is not None
    for row, expected in zip(table.rows, LWA4P, strict=True):
        assert (row.a, row.alpha, row.d, row.theta) == pytest.approx(expected, abs=1e-15)
    np.testing.assert_allclose(table.base, np.eye(4), atol=1e-15)
    np.testing.assert_allclose(table.tool, np.eye(4), atol=1e-15)


# Table I of Giusti and Althoff 2017, rows a [m], alpha [rad], d [m], theta [rad].
TABLE_I = [
    (0.0, -math.pi / 2, 0.0, 0.0),
    (0.35, math.pi, 0.0, -math.pi / 2),
    (0.0, -math.pi / 2, 0.0, -math.pi / 2),
    (0.0, math.pi / 2, 0.301, 0.0),
    (0.0, -math.pi / 2, 0.0, 0.0),
    (0.0, 0.0, 0.095, 0.0),
]


def test_the_modules_of_the_paper_give_table_i():
    table = load_robot("lwa4p-paper").dh
    assert table is not None
    for row, expected in zip(table.rows, TABLE_I, strict=True):
        assert (row.a, row.alpha, row.d, row.theta) == pytest.approx(expected, abs=1e-15)


def test_a_negative_a_of_a_table_is_kept():
    rows = [(-0.2, 0.4, 0.1, 0.3), (-0.3, 0.0, 0.05, 1.0), (0.1, -math.pi / 2, 0.0, 0.0)]
    table = dh_table(*chain([dh_standard(*row) for row in rows]))
    for row, expected in zip(table.rows, rows, strict=True):
        assert (row.a, row.alpha, row.d, row.theta) == pytest.approx(expected, abs=1e-14)


@pytest.mark.parametrize("seed", range(30))
def test_random_oblique_chains_of_both_joint_types_keep_their_forward_kinematics(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 11))
    kinds = list(rng.choice([REVOLUTE, PRISMATIC], n))
    before = np.stack(
        [from_xyz_rpy(rng.uniform(-0.3, 0.3, 3), rng.uniform(-3, 3, 3)) for _ in range(n)]
    )
    after = np.stack(
        [from_xyz_rpy(rng.uniform(-0.5, 0.5, 3), rng.uniform(-3, 3, 3)) for _ in range(n)]
    )
    table = dh_table(range(-1, n - 1), before, after)
    assert not any(row.near_parallel for row in table.rows)
    assert largest_difference(table, kinds, before, after, rng) < 1e-12


@pytest.mark.parametrize("seed", range(20))
def test_chains_of_parallel_intersecting_and_collinear_axes_keep_their_forward_kinematics(seed):
    rng = np.random.default_rng(seed)
    n = 8
    kinds = list(rng.choice([REVOLUTE, PRISMATIC], n))
    spans = []
    for _ in range(n):
        turn = rotation_z(rng.uniform(-3, 3))
        choice = rng.integers(5)
        shift = translation(rng.uniform(-0.5, 0.5, 3))
        along = translation((0.0, 0.0, rng.uniform(-0.5, 0.5)))
        spans.append(
            [
                shift @ turn,  # parallel
                shift @ rotation_x(math.pi) @ turn,  # antiparallel
                along @ turn,  # one line
                along @ rotation_x(rng.uniform(0.1, 3.0)) @ turn,  # intersecting
                turn @ shift @ rotation_x(math.pi / 2) @ turn,  # perpendicular, skew
            ][choice]
        )
    parents, before, after = chain(spans)
    table = dh_table(parents, before, after)
    assert not any(row.near_parallel for row in table.rows)
    assert largest_difference(table, kinds, before, after, rng) < 1e-12


@pytest.mark.parametrize("angle", [1e-3 * 1.01, 2e-3, 1e-2])
def test_unflagged_rows_hold_to_1e12_up_to_the_flagging_threshold(angle):
    rng = np.random.default_rng(0)
    spans = [from_xyz_rpy((0.05, 0.03, 0.1), (angle, 0.0, 0.0)) for _ in range(6)]
    parents, before, after = chain(spans)
    table = dh_table(parents, before, after)
    assert not any(row.near_parallel for row in table.rows)
    assert largest_difference(table, [REVOLUTE] * 6, before, after, rng) < 1e-12


@pytest.mark.parametrize("angle", [1e-12, 1e-9, 1e-7, 1e-5, 9e-4])
def test_almost_parallel_axes_are_flagged_and_still_close_to_the_module_frames(angle):
    rng = np.random.default_rng(0)
    parents, before, after = chain([from_xyz_rpy((0.3, 0.2, 0.1), (angle, 0.0, 0.0)), np.eye(4)])
    table = dh_table(parents, before, after)
    assert [row.near_parallel for row in table.rows] == [True, False]
    assert largest_difference(table, [REVOLUTE] * 2, before, after, rng) < 1e-7


def test_almost_parallel_axes_are_flagged_also_where_their_common_normal_is_near():
    parents, before, after = chain([from_xyz_rpy((1e-3, 2e-3, 0.1), (9e-4, 0.0, 0.0)), np.eye(4)])
    assert dh_table(parents, before, after).rows[0].near_parallel


def test_a_common_normal_far_away_is_flagged():
    parents, before, after = chain([from_xyz_rpy((0.3, 5.0, 0.1), (2e-3, 0.0, 0.0)), np.eye(4)])
    assert dh_table(parents, before, after).rows[0].near_parallel


def test_parallel_axes_composed_of_opposite_turns_are_not_flagged():
    spans = [rotation_x(0.3) @ translation((0.1, 0.2, 0.3)) @ rotation_x(-0.3), np.eye(4)]
    table = dh_table(*chain(spans))
    assert not table.rows[0].near_parallel
    assert table.rows[0].alpha == 0.0


def test_branches_have_no_table():
    with pytest.raises(ValueError, match="serial"):
        dh_table([-1, 0, 0], np.stack([np.eye(4)] * 3), np.stack([np.eye(4)] * 3))
