"""The plant: forward dynamics inverts inverse dynamics, and the free robot keeps its energy."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.errors import SingularMassMatrixError, ValueRangeError
from modrobust.model import Robot
from modrobust.reference import potential_energy
from support.random_robots import random_robot, random_state

SHAPES: list[dict[str, Any]] = [
    {"simple": True, "n": 6},
    {"simple": False, "types": "prprpr"},
    {"simple": False, "n": 12},
    {"simple": False, "n": 10, "tree": True},
]


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("drives", [False, True])
def test_forward_dynamics_inverts_inverse_dynamics(shape: dict[str, Any], drives: bool) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        robot = random_robot(rng, **shape)
        q, dq, _, ddq = random_state(rng, robot.n)
        point = replace(robot.nominal, mass=1.3 * robot.nominal.mass)
        for parameters in (None, point):
            tau = mr.inverse_dynamics(robot, q, dq, dq, ddq, parameters=parameters, drives=drives)
            back = mr.forward_dynamics(robot, q, dq, tau, parameters=parameters, drives=drives)
            M = mr.mass_matrix(robot, q, parameters=parameters, drives=drives)
            size = 1e-14 * np.linalg.cond(M) * (1 + np.abs(tau).max() / np.linalg.norm(M))
            np.testing.assert_allclose(back, ddq, rtol=0, atol=size + 1e-12)


def free_fall(robot: Robot, q: Any, dq: Any, step: float, duration: float) -> float:
    """Largest relative change of the energy of the free robot, by Runge-Kutta of order four."""
    zero = np.zeros(robot.n)
    model, packed = robot.model, robot.nominal.packed

    def rate(x: Any) -> Any:
        # the kernel without the checks around it, for the sake of 400 000 calls
        k = np.empty_like(x)
        k[0] = x[1]
        k[1] = _kernel.forward_dynamics(model, packed, x[0], x[1], zero, False)
        return k

    def energy(x: Any) -> tuple[float, float]:
        M = mr.mass_matrix(robot, x[0], drives=False)
        kinetic = x[1] @ M @ x[1] / 2
        return kinetic + potential_energy(robot, robot.nominal, x[0]), kinetic

    x = np.array([q, dq])
    start, scale = energy(x)
    worst = 0.0
    for tick in range(round(duration / step)):
        a = rate(x)
        b = rate(x + step / 2 * a)
        c = rate(x + step / 2 * b)
        d = rate(x + step * c)
        x = x + step / 6 * (a + 2 * b + 2 * c + d)
        if tick % round(0.05 / step) == 0:
            now, kinetic = energy(x)
            scale = max(scale, kinetic)
            worst = max(worst, abs(now - start))
    return worst / scale


def pendulums() -> tuple[Robot, Any, Any]:
    """A chain of three revolute joints and its first state, of moderate speeds."""
    rng = np.random.default_rng(2)
    robot = random_robot(rng, types="rrr", simple=True, drives=False)
    return robot, np.array([0.5, -0.4, 0.3]), np.array([0.5, -0.3, 0.4])


def test_the_free_robot_keeps_its_energy_over_ten_seconds() -> None:
    # RK4 at 10 kHz: 400 000 calls of the plant
    assert free_fall(*pendulums(), step=1e-4, duration=10.0) < 1e-8


def test_the_energy_error_falls_with_the_fourth_power_of_the_step() -> None:
    drift = [free_fall(*pendulums(), step=h, duration=1.0) for h in (4e-3, 2e-3, 1e-3)]
    assert drift[0] > 1e-10  # above rounding, so that the ratios mean something
    for coarse, fine in itertools.pairwise(drift):
        assert coarse / fine > 12


def test_a_branched_robot_with_slides_keeps_its_energy() -> None:
    rng = np.random.default_rng(3)
    robot = random_robot(rng, types="rprr", tree=True, drives=False)
    robot = replace(robot, gravity=np.array([0.0, 0.0, -1.0]))
    q, dq, _, _ = random_state(rng, 4, rate=0.5)
    assert free_fall(robot, q, dq, step=2e-4, duration=0.5) < 1e-8


def test_friction_takes_energy_and_a_released_weight_falls() -> None:
    rng = np.random.default_rng(4)
    robot = random_robot(rng, types="rrr", simple=True)
    q, dq, _, _ = random_state(rng, 3)
    tau = mr.inverse_dynamics(robot, q, dq, dq, np.zeros(3), drives=False)
    ddq = mr.forward_dynamics(robot, q, dq, tau)  # rigid part balanced: friction alone acts
    M = mr.mass_matrix(robot, q)
    assert dq @ M @ ddq < -1e-3
    expected = robot.nominal.viscous * dq + robot.nominal.coulomb * dq / np.hypot(dq, 1e-3)
    np.testing.assert_allclose(M @ ddq, -expected, rtol=1e-10)


def test_a_robot_without_mass_has_no_acceleration() -> None:
    robot = random_robot(np.random.default_rng(5), 3, drives=False)
    p = robot.nominal
    weightless = replace(p, mass=0 * p.mass, inertia=0 * p.inertia)
    zero = np.zeros(3)
    with pytest.raises(SingularMassMatrixError):
        mr.forward_dynamics(robot, zero, zero, zero + 1, parameters=weightless)


@pytest.mark.parametrize("k", range(3))
def test_a_number_that_is_not_finite_is_refused(k: int) -> None:
    robot = random_robot(np.random.default_rng(6), 3)
    arguments = (np.zeros(3), np.zeros(3), np.zeros(3))
    arguments[k][2] = np.nan
    with pytest.raises(ValueRangeError):
        mr.forward_dynamics(robot, *arguments)
