"""The exact reference itself: against the paper's transcription, and what "as written" means."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from modrobust.model import Parameters, Robot
from modrobust.reference import newton_euler
from support.containment.ball_comparison import Outcome, exact_torques
from support.containment.ball_dynamics import State, coefficients, from_doubles
from support.containment.written_robots import (
    ball,
    exact_pose,
    nearest,
    nearest_matrix,
    random_written,
)
from support.random_robots import random_robot, random_state, tied
from support.rounding import as_long


@pytest.fixture(autouse=True)
def _precision():
    before, ctx.prec = ctx.prec, 320
    yield
    ctx.prec = before


def torque(robot: Robot, point: Parameters, state: Any) -> tuple[Any, Any]:
    """Exact torques at one point with smooth friction, and without drives, as doubles."""
    rows = coefficients(from_doubles(robot), State(*([arb(x) for x in v.tolist()] for v in state)))
    found = exact_torques(robot, rows, [point.packed], [rows.smooth_sign])
    smooth, bodies = (np.array([float(x) for x in found[name][0]]) for name in ("smooth", "bodies"))
    return smooth, bodies


@pytest.mark.parametrize("tree", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_balls_agree_with_the_transcription_of_the_paper(seed: int, tree: bool) -> None:
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, n=7, tree=tree)
    state = random_state(rng, 7)
    point = robot.corner_parameters(rng)
    long = as_long(state)
    for drives, got in zip((True, False), torque(robot, point, state), strict=True):
        expected = newton_euler(robot, point, *long, drives=drives)
        # the rotations of a robot are orthonormal up to their rounding only
        np.testing.assert_allclose(got, np.array(expected, dtype=float), rtol=0, atol=1e-12)


@pytest.mark.parametrize("anywhere", [False, True])
def test_mimic_joints_are_a_tree_of_free_joints_that_move_alike(anywhere: bool) -> None:
    rng = np.random.default_rng(3)
    free = random_robot(rng, n=6, tree=not anywhere)
    robot = tied(free, 4, rng, anywhere)
    state = random_state(rng, 4)
    f = robot.mimic
    G = np.zeros((6, 4))
    G[robot.free, np.arange(4)] = 1.0
    G[f.joints, f.leaders] = f.multiplier
    full = [G @ v for v in state]
    full[0][f.joints] += f.offset
    expected = torque(free, free.nominal, full)
    for got, every in zip(torque(robot, robot.nominal, state), expected, strict=True):
        np.testing.assert_allclose(got, G.T @ every, rtol=1e-13, atol=1e-12)


def test_right_angles_are_exact() -> None:
    quarter = Fraction(1, 2)  # half turns
    T = nearest_matrix(exact_pose([("rz", quarter), ("x", Fraction(1, 4)), ("rx", -quarter)]))
    expected = np.array([[0, 0, -1, 0], [1, 0, 0, 0.25], [0, -1, 0, 0], [0, 0, 0, 1]])
    assert T.tolist() == expected.tolist()


def test_the_nearest_double_is_the_nearest() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        for moves in random_written(rng, 6, 0).after:
            pose = exact_pose(moves)
            for x in (*pose.R, *pose.p):
                near = nearest(x)
                for other in (np.nextafter(near, -np.inf), np.nextafter(near, np.inf)):
                    assert not abs(x - float(other)) < abs(x - near)
    assert nearest(ball(Fraction(1, 10))) == 0.1


def test_outcomes_add_up() -> None:
    total = Outcome(cases=1, used_hull=0.5, kinds={"far": 1})
    total.add(Outcome(cases=2, violations=["one"], used_hull=0.25, kinds={"far": 2, "fast": 1}))
    assert total.kinds == {"far": 3, "fast": 1}
    assert (total.cases, total.violations, total.used_hull) == (3, ["one"], 0.5)
