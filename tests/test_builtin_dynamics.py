"""Every built-in robot: torques, bounds and mass matrix against the oracles."""

from __future__ import annotations

import numpy as np
import pytest

import modrobust as mr
from exact_hull import exact_bounds
from modrobust.assembly import builtin_robots
from modrobust.robot import Robot
from oracle import box, mass_matrix, newton_euler
from random_robots import random_state

ROUNDING = 1e-12  # of the largest figure


@pytest.fixture(scope="module", params=sorted(builtin_robots()))
def robot(request: pytest.FixtureRequest) -> Robot:
    return mr.load_robot(request.param)


def test_a_builtin_robot_agrees_with_the_oracles(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    state = random_state(rng, robot.n)
    tau = mr.inverse_dynamics(robot, *state)
    expected = newton_euler(robot, robot.nominal, *state, drives=True)
    np.testing.assert_allclose(tau, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())

    lo, hi = mr.inverse_dynamics_bounds(robot, *state, method="ianea")
    wide = newton_euler(robot, box(robot), *state, drives=True)
    slack = ROUNDING * max(np.abs(wide.lo).max(), np.abs(wide.hi).max())
    np.testing.assert_allclose(lo, wide.lo, rtol=0, atol=slack)
    np.testing.assert_allclose(hi, wide.hi, rtol=0, atol=slack)

    lo, hi = mr.inverse_dynamics_bounds(robot, *state, method="hull")
    slack = ROUNDING * max(np.abs(lo).max(), np.abs(hi).max())
    if robot.n <= 7:  # the brute force takes its time
        exact_lo, exact_hi = exact_bounds(robot, *state, drives=True)
        assert np.all(lo <= exact_lo + slack)
        assert np.all(hi >= exact_hi - slack)
        assert np.all(hi - lo <= 1.02 * (exact_hi - exact_lo) + 2 * slack)

    points = [robot.sample_parameters(rng) for _ in range(20)]
    points += [robot.corner_parameters(rng) for _ in range(20)]
    points += list(robot.scenarios.values())
    for point in points:
        tau = mr.inverse_dynamics(robot, *state, parameters=point)
        assert np.all(tau >= lo - slack)
        assert np.all(tau <= hi + slack)


def test_a_builtin_robot_has_a_positive_definite_mass_matrix(robot: Robot) -> None:
    rng = np.random.default_rng(2)
    for _ in range(10):
        q = rng.uniform(-np.pi, np.pi, robot.n)
        for parameters in (robot.nominal, robot.sample_parameters(rng)):
            M = mr.mass_matrix(robot, q, parameters=parameters, drives=False)
            assert np.linalg.eigvalsh(M)[0] > 0
        expected = mass_matrix(robot, robot.nominal, q)
        M = mr.mass_matrix(robot, q, drives=False)
        np.testing.assert_allclose(M, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())
