"""Robots, controllers and results can be copied and pickled; a copy goes its own way."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.simulation import simulate
from modrobust.simulation.result import LOGGED

COPIES: dict[str, Callable[[Any], Any]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda it: pickle.loads(pickle.dumps(it)),
}


@pytest.fixture(scope="module")
def robot() -> mr.Robot:
    robot = mr.load_robot("lwa4p-payload")
    assert robot.model
    assert robot.dh  # what is cached is no hindrance
    return robot


def command(controller: mr.RobustController, t: float) -> mr.Command:
    zero = np.zeros(controller.robot.n)
    return controller.command(t, zero, zero + 0.1, zero + 0.2 + t, zero - 0.1, zero)


def same(one: mr.Command, other: mr.Command) -> bool:
    return all(np.array_equal(value, vars(other)[name]) for name, value in vars(one).items())


@pytest.mark.parametrize("way", COPIES)
def test_a_copied_robot_is_the_same(way: str, robot: mr.Robot) -> None:
    other = COPIES[way](robot)
    assert other.to_dict() == robot.to_dict()
    assert other.scenarios.keys() == robot.scenarios.keys()
    state = np.random.default_rng(0).normal(size=(4, robot.n))
    for one, two in zip(
        mr.inverse_dynamics_bounds(robot, *state),
        mr.inverse_dynamics_bounds(other, *state),
        strict=True,
    ):
        np.testing.assert_array_equal(one, two)
    with pytest.raises(ValueError, match="read-only"):
        other.lower.mass[0] = 0.0


@pytest.mark.parametrize("way", COPIES)
def test_a_copied_controller_has_integrators_of_its_own(way: str, robot: mr.Robot) -> None:
    controller = mr.RobustController(robot, law="norm", bound="ianea", epsilon=0.05)
    for k in range(5):
        command(controller, 0.1 * k)
    other = COPIES[way](controller)
    assert other.settings == controller.settings
    assert (other.kappa, other.phi) == (controller.kappa, controller.phi)
    assert controller.kappa > controller.settings.kappa_P  # they have advanced
    ahead = command(other, 3.0)  # the original knows nothing of this
    assert controller.kappa < other.kappa
    again = COPIES[way](controller)
    assert same(command(again, 0.5), command(controller, 0.5))
    assert same(command(again, 3.0), command(controller, 3.0))
    assert not same(ahead, command(COPIES[way](mr.RobustController(robot, law="norm")), 3.0))
    with pytest.raises(mr.ModrobustError, match="t went backwards"):
        command(COPIES[way](controller), 2.0)


@pytest.mark.parametrize("way", COPIES)
def test_a_copied_controller_with_chosen_gains_goes_on_with_the_same_torques(way: str) -> None:
    robot = mr.load_robot("scara")
    controller = mr.RobustController(robot, law="auto", delay=1.0)
    rest = np.zeros(robot.n)
    for _ in range(3):
        controller.step(rest, rest, rest + 1e-3, rest, rest)
    twin = COPIES[way](controller)
    assert twin.design is not None
    assert controller.design is not None
    assert twin.design.to_dict() == controller.design.to_dict()
    for _ in range(3):
        ours, theirs = (c.step(rest, rest, rest + 1e-3, rest, rest) for c in (controller, twin))
        assert (ours.tau == theirs.tau).all()


@pytest.mark.parametrize("way", COPIES)
def test_a_copied_result_is_the_same(way: str, robot: mr.Robot) -> None:
    result = simulate(robot, duration=0.05, rate=2e3)
    assert len(result.command_seconds)  # cached
    other = COPIES[way](result)
    for name in LOGGED:
        np.testing.assert_array_equal(getattr(other, name), getattr(result, name))
    one, two = result.summary(), other.summary()
    for figures in (one, two):
        figures.pop("command_time")  # measured
    assert one == two
