"""How many steps a tick, and by which method: against eigenvalues found another way."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

import modrobust as mr
from modrobust.errors import ValueRangeError
from modrobust.model import LoopSettings, Robot
from modrobust.motion import default_trajectory
from modrobust.simulation.integration import Steps, choose_steps, friction_rate
from support.loops import make_loop
from support.random_robots import random_robot, tied


def with_friction(robot: Robot, coulomb: float, speed: float = 1e-3) -> Robot:
    """Every joint with that Coulomb friction [N m] or [N] and speed [rad/s] or [m/s]."""
    points = {
        name: replace(getattr(robot, name), coulomb=np.full(robot.j, coulomb))
        for name in ("nominal", "lower", "upper")
    }
    return replace(robot, coulomb_speed=np.full(robot.j, speed), **points)


def robot_of(kind: str) -> Robot:
    rng = np.random.default_rng(sum(map(ord, kind)))
    robot = random_robot(rng, types="rprr", tree=kind == "tree", drives=kind != "no rotors")
    return tied(robot, 2, rng, anywhere=True) if kind == "mimic" else robot


@pytest.mark.parametrize("kind", ["chain", "tree", "mimic", "no rotors"])
def test_the_rate_is_how_fast_friction_pulls_a_resting_robot_back(kind: str) -> None:
    """The fastest eigenvalue of d ddq / d dq at rest, by differences of the forward dynamics."""
    robot = with_friction(robot_of(kind), 2.0)
    rng = np.random.default_rng(1)
    positions = rng.uniform(-2.0, 2.0, (6, robot.n))
    zero, step = np.zeros(robot.n), 1e-7  # [rad/s], well below the Coulomb speed
    fastest = []
    for q in positions:
        columns = [
            mr.forward_dynamics(robot, q, e, zero) - mr.forward_dynamics(robot, q, -e, zero)
            for e in step * np.eye(robot.n)
        ]
        values = np.linalg.eigvals(-np.array(columns).T / (2.0 * step))
        fastest.append(values.real.max())
    for q, value in zip(positions, fastest, strict=True):
        assert friction_rate(robot, robot.nominal, q[None]) == pytest.approx(value, rel=1e-4)
    assert friction_rate(robot, robot.nominal, positions) == pytest.approx(max(fastest), rel=1e-4)
    assert min(fastest) < 0.999 * max(fastest)


def test_the_rate_is_the_largest_generalised_eigenvalue() -> None:
    robot = with_friction(robot_of("chain"), 2.0)
    point = robot.sample_parameters(np.random.default_rng(2))
    q = np.random.default_rng(3).uniform(-2.0, 2.0, robot.n)
    D = np.diag(point.viscous + point.coulomb / robot.coulomb_speed)
    values = scipy.linalg.eigh(D, mr.mass_matrix(robot, q, point), eigvals_only=True)
    assert friction_rate(robot, point, q[None]) == pytest.approx(values[-1], rel=1e-9)


def test_without_friction_there_is_no_rate() -> None:
    robot = robot_of("no rotors")
    assert friction_rate(robot, robot.nominal, np.zeros((3, robot.n))) == 0.0


def chosen(robot: Robot, dt: float, given: int | None = None) -> Steps:
    motion = default_trajectory(robot, 2.0, 0)
    return choose_steps(robot, robot.nominal, motion, 2.0, dt, given)


def rate_of(robot: Robot) -> float:
    motion = default_trajectory(robot, 2.0, 0)
    return friction_rate(robot, robot.nominal, motion.sample(np.linspace(0.0, 2.0, 17))[0])


@pytest.mark.parametrize("dt", [2e-5, 2.5e-4, 1e-3, 4e-3])
@pytest.mark.parametrize("coulomb", [0.0, 0.2, 3.0, 10.0, 30.0, 100.0])
def test_a_step_is_half_of_what_is_stable_or_implicit(coulomb: float, dt: float) -> None:
    robot = with_friction(robot_of("chain"), coulomb)
    rate, found = rate_of(robot), chosen(robot, dt)
    wanted = min(5e-4, 1.4 / rate)  # [s]
    if found.implicit:
        assert wanted < min(1e-3 / 12, dt)
        assert dt / found.count <= 2e-4 * (1.0 + 1e-6)
        assert found.count == max(1, math.ceil(dt / 2e-4 - 1e-6))
        assert "implicit" in found.method
    else:
        assert wanted >= min(1e-3 / 12, dt)
        h = dt / found.count
        assert h <= wanted * (1.0 + 1e-6)
        assert found.count == 1 or dt / (found.count - 1) > wanted * (1.0 - 1e-6)
        assert "Runge-Kutta" in found.method


def test_both_methods_are_chosen_somewhere() -> None:
    soft, stiff = (with_friction(robot_of("no rotors"), x) for x in (1e-3, 10.0))
    assert not chosen(soft, 1e-3).implicit
    assert chosen(stiff, 1e-3).implicit
    assert chosen(soft, 1e-3).count == 2


def test_given_steps_are_taken_as_they_are() -> None:
    stiff = with_friction(robot_of("no rotors"), 10.0)
    assert chosen(stiff, 1e-3, 7) == Steps(7, False)
    for wrong in (0, -1, 10**6 + 1):
        with pytest.raises(ValueRangeError, match=r"^substeps"):
            chosen(stiff, 1e-3, wrong)


@pytest.mark.parametrize("rate", [250.0, 1e3, 4e3, 5e4])
@pytest.mark.parametrize("kind", ["chain", "tree", "mimic", "no rotors"])
@pytest.mark.parametrize(("coulomb", "speed"), [(40.0, 4e-3), (15.0, 1e-4)])
def test_the_chosen_steps_let_a_robot_without_torques_come_to_rest(
    coulomb: float, speed: float, kind: str, rate: float
) -> None:
    """Friction takes energy, at any rate: what is unstable would fling the joints about."""
    robot = with_friction(robot_of(kind), coulomb, speed)
    robot = replace(robot, gravity=np.zeros(3), effort_limits=np.zeros(robot.n))
    steps = chosen(robot, 1.0 / rate)
    rng = np.random.default_rng(4)
    q, dq = rng.normal(size=(2, robot.n)) * [[1.0], [0.05]]
    controller = mr.RobustController(replace(robot, loop=LoopSettings(rate=rate)), law="norm")
    loop = make_loop(
        *(controller, robot.nominal, None, q, dq),
        substeps=steps.count,
        implicit=steps.implicit,
        saturation=1,
    )
    count = round(0.3 * rate)
    log = loop.advance(*[np.zeros((count, robot.n))] * 3, max(1, count // 100))
    assert loop.status == 0
    kinetic = [v @ mr.mass_matrix(robot, x) @ v for x, v in zip(log["q"], log["dq"], strict=True)]
    assert (np.diff(kinetic) <= 1e-9 * kinetic[0]).all()
    assert np.abs(log["dq"][-1]).max() < 0.1 * speed  # it sticks
