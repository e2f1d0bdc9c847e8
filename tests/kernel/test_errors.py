"""Inputs that the kernel refuses: the message names the one to look at, with index and value."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import TimeOrderError, ValueRangeError
from support.random_robots import point_robot, random_robot

ROBOT = random_robot(np.random.default_rng(1), types="rrp")
ZERO = np.zeros(3)
TOO_LARGE = "{} is the largest input; the result is not finite; the inputs are too large"
TOO_FAR = "{}: a joint angle is beyond 100000 rad; reduce it by whole turns"


def with_entry(index: int, value: float) -> Any:
    array = np.ones(3)
    array[index] = value
    return array


@pytest.mark.parametrize(
    "call",
    [
        mr.inverse_dynamics,
        mr.inverse_dynamics_bounds,
        partial(mr.inverse_dynamics_bounds, bound="ianea"),
        mr.perturbation_bounds,
    ],
)
def test_an_overflow_names_the_largest_input(call: Callable[..., Any]) -> None:
    huge = with_entry(2, -1e200)
    for at, name in ((1, "dq"), (2, "dq_a")):
        state = [ZERO, np.ones(3), np.ones(3), ZERO]
        state[at] = huge
        state[3 - at] = 1e150 * np.ones(3)
        with pytest.raises(ValueRangeError) as caught:
            call(ROBOT, *state)
        assert str(caught.value) == TOO_LARGE.format(f"{name}[2] = -1e+200")


def test_an_overflow_of_the_forward_dynamics_names_the_largest_input() -> None:
    with pytest.raises(ValueRangeError) as caught:
        mr.forward_dynamics(ROBOT, ZERO, with_entry(0, 1e180), ZERO)
    assert str(caught.value) == TOO_LARGE.format("dq[0] = 1e+180")


def test_an_angle_beyond_the_range_is_named() -> None:
    for call in (mr.inverse_dynamics, mr.inverse_dynamics_bounds, mr.perturbation_bounds):
        with pytest.raises(ValueRangeError) as caught:
            call(ROBOT, with_entry(1, 2e5), 3e5 * np.ones(3), ZERO, ZERO)
        assert str(caught.value) == TOO_FAR.format("q[1] = 200000")


def test_the_controller_names_the_input_too() -> None:
    controller = mr.RobustController(ROBOT)
    with pytest.raises(ValueRangeError) as caught:
        controller.command(0.0, with_entry(1, -2e5), ZERO, ZERO, ZERO, ZERO)
    assert str(caught.value) == TOO_FAR.format("q[1] = -200000")
    for at, name in ((1, "dq"), (2, "q_des"), (3, "dq_des"), (4, "ddq_des")):
        signals = [ZERO] * 5
        signals[at] = with_entry(2, 1e300)
        with pytest.raises(ValueRangeError) as caught:
            controller.command(0.0, *signals)
        assert str(caught.value) == TOO_LARGE.format(f"{name}[2] = 1e+300")
    assert np.isfinite(controller.command(0.0, ZERO, ZERO, ZERO, ZERO, ZERO).tau).all()
    with pytest.raises(TimeOrderError):
        controller.command(-1.0, ZERO, ZERO, ZERO, ZERO, ZERO)


def test_the_replay_of_commands_names_the_input_with_its_row() -> None:
    rows = np.zeros((4, 3))
    q, dq = rows.copy(), rows.copy()
    q[2, 0], dq[3, 1] = 2e5, 1e300
    controller = mr.RobustController(ROBOT)
    with pytest.raises(ValueRangeError) as caught:
        controller.time_commands(np.arange(4.0), q, rows, rows, rows, rows)
    assert str(caught.value) == TOO_FAR.format("q[2][0] = 200000")
    with pytest.raises(ValueRangeError) as caught:
        controller.time_commands(np.arange(4.0), rows, dq, rows, rows, rows)
    assert str(caught.value) == TOO_LARGE.format("dq[3][1] = 1e+300")


def test_sizes_beyond_2_to_900_are_refused() -> None:
    """Else bounds would come from sizes that the proof does not cover, finite as they may be."""
    robot = point_robot(
        "r", after=[np.eye(4)], mass=[1e-250], com=[[1e-3, 0, 0]], inertia=[1e-255 * np.eye(3)]
    )
    robot = replace(robot, gravity=np.zeros(3))
    zero, size = np.zeros(1), 2.0**900
    lo, hi = mr.inverse_dynamics_bounds(robot, zero, zero, zero, np.array([size / 1e3]))
    assert np.isfinite([lo, hi]).all()
    with pytest.raises(ValueRangeError):
        mr.inverse_dynamics_bounds(robot, zero, zero, zero, np.array([size * 1e2]))
