"""Every built-in robot: torques, bounds and mass matrix against the oracles."""

from __future__ import annotations

import numpy as np
import pytest

import modrobust as mr
from modrobust.assembly import builtin_robots
from modrobust.model import Robot
from modrobust.reference import box, mass_matrix, newton_euler
from support.exact_range import exact_range
from support.random_robots import random_state
from support.ready_robots import freed, load_builtin
from support.rounding import as_long, assert_encloses, excess_allowed, torque_error
from support.states import state_of

ROUNDING = 1e-12  # of the largest figure


@pytest.fixture(scope="module", params=sorted(builtin_robots()))
def robot(request: pytest.FixtureRequest) -> Robot:
    return load_builtin(request.param)


def test_a_builtin_robot_agrees_with_the_oracles(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    state = random_state(rng, robot.n)
    free, G = freed(robot)  # (15): the oracles know no mimic joints
    full = state_of([robot.all_positions(state[0]), *(G @ x for x in state[1:])])
    tau = mr.inverse_dynamics(robot, *state)
    expected = G.T @ newton_euler(free, free.nominal, *full, drives=True)
    np.testing.assert_allclose(tau, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())

    bounds = mr.inverse_dynamics_bounds(robot, *state, bound="ianea")
    long = as_long(state)
    full = state_of([robot.all_positions(long[0]), *(G @ x for x in long[1:])])
    wide = newton_euler(free, box(free), *full, drives=True)
    more, less = np.maximum(G, 0.0).T, np.minimum(G, 0.0).T
    expected = more @ wide.lo + less @ wide.hi, more @ wide.hi + less @ wide.lo
    assert_encloses(bounds, expected, excess_allowed(robot, *state, bound="ianea"))

    lo, hi = mr.inverse_dynamics_bounds(robot, *state, bound="hull")
    if robot.j == robot.n:  # the exact range knows no mimic joints
        exact = exact_range(robot, state, True)
        assert_encloses((lo, hi), exact, excess_allowed(robot, *state))

    points = [robot.sample_parameters(rng) for _ in range(20)]
    points += [robot.corner_parameters(rng) for _ in range(20)]
    points += list(robot.scenarios.values())
    for point in points:
        tau = mr.inverse_dynamics(robot, *state, parameters=point)
        error = torque_error(robot, *state, parameters=point)
        assert np.all(tau >= lo - error)
        assert np.all(tau <= hi + error)


def test_a_builtin_robot_has_a_positive_definite_mass_matrix(robot: Robot) -> None:
    rng = np.random.default_rng(2)
    for _ in range(10):
        q = rng.uniform(-np.pi, np.pi, robot.n)
        for parameters in (robot.nominal, robot.sample_parameters(rng)):
            M = mr.mass_matrix(robot, q, parameters=parameters, drives=False)
            assert np.linalg.eigvalsh(M)[0] > 0
        free, G = freed(robot)
        expected = G.T @ mass_matrix(free, free.nominal, robot.all_positions(q)) @ G
        M = mr.mass_matrix(robot, q, drives=False)
        np.testing.assert_allclose(M, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())
