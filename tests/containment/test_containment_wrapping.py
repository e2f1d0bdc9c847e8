"""The command of joints that wrap encloses (4) with the turns that were taken off, 2 pi exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from flint import ctx

from modrobust.model import Bounded, Robot
from support.containment.ball_comparison import PRECISION, check_state, exact_errors
from support.containment.containment_cases import robot_of
from support.containment.extreme_states import Signals
from support.containment.parameter_boxes import endless
from support.random_robots import random_robot

EXACTLY = 1e-20  # [rad]: what the nearest double of 2 pi would miss after 15,000 turns is 4e-12


def turning(rng: np.random.Generator, n: int) -> Robot:
    """Continuous joints and no gravity, drives or disturbance: nothing hides the rounding of e."""
    robot = random_robot(rng, types="r" * n, drives=False)
    none = Bounded(np.zeros(n), np.zeros(n), np.zeros(n))
    return replace(robot, gravity=np.zeros(3), joint_types=("continuous",) * n, disturbance=none)


@pytest.mark.parametrize("seed", range(30))
def test_next_to_whole_turns_slow_joints_hold_the_rounding_of_two_pi(seed: int) -> None:
    """Torques of 1e-30 N m, in which the error that 2 pi k brings is the largest of all."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    robot = turning(rng, n)
    q = rng.uniform(-np.pi, np.pi, n)
    dq = rng.normal(size=n) * 1e-20
    q_des = q + 2.0 * np.pi * rng.integers(-15000, 15001, n)
    signals = Signals(q, dq, q_des, dq, np.zeros(n))
    assert np.abs(robot.tracking_error(q, q_des)).max() < 1e-10
    outcome = check_state(robot, signals, rng, f"seed {seed}", as_given=True)
    assert not outcome.refused
    assert not outcome.violations, "\n".join(outcome.violations[:5])


def test_the_error_is_that_of_two_pi_itself() -> None:
    """Else the comparison above would be one of two roundings."""
    rng = np.random.default_rng(0)
    robot = turning(rng, 3)
    q, q_des = np.zeros(3), 2.0 * np.pi * np.array([1.0, -100.0, 15000.0])
    signals = Signals(q, q, q_des, q, q)
    found = robot.tracking_error(q, q_des)
    before, ctx.prec = ctx.prec, PRECISION
    try:
        exactly = exact_errors(robot, signals)
    finally:
        ctx.prec = before
    for ours, exact in zip(found, exactly, strict=True):
        assert abs(exact - float(ours)) < EXACTLY
        assert abs(float(ours)) > 1e-16  # what the double 2 pi misses


def test_the_population_has_robots_that_wrap() -> None:
    wrapping = [robot_of(seed).robot.wraps for seed in range(40)]
    assert sum(wraps.any() for wraps in wrapping) > 5
    assert sum(not wraps.any() for wraps in wrapping) > 15
    plain = random_robot(np.random.default_rng(0), types="rp")
    kinds = {endless(np.random.default_rng(k), plain).joint_types for k in range(40)}
    assert kinds == {("revolute", "prismatic"), ("continuous", "prismatic")}
