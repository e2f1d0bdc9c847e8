"""The controller as a function of the state: inside somebody else's ODE solver."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.control.controller import SOLVER_ERROR
from modrobust.errors import ShapeError, TimeOrderError, ValueRangeError
from modrobust.model import Robot, synthetic_chain

N = 2


@pytest.fixture(scope="module")
def robot() -> Robot:
    return synthetic_chain(N, uncertainty=0.1)


def inputs(seed: int) -> tuple[Any, Any, Any, Any, Any]:
    rng = np.random.default_rng(seed)
    q, dq, dq_des, ddq_des = rng.uniform(-1, 1, (4, N))
    return q, dq, q + rng.uniform(-0.1, 0.1, N), dq_des, ddq_des


def test_without_integral_it_is_the_first_command(robot: Robot) -> None:
    fresh, other = mr.RobustController(robot), mr.RobustController(robot)
    first, answer = fresh.command(7.0, *inputs(0)), other.torque(*inputs(0))
    for name in ("tau", "nominal", "v", "phi_lo", "phi_hi", "rho"):
        np.testing.assert_array_equal(getattr(answer, name), getattr(first, name), err_msg=name)
    assert answer.rho_norm == first.rho_norm
    assert answer.integral_rate == first.integral_rate
    q, _, q_des, _, _ = inputs(0)
    assert answer.integral_rate == pytest.approx(np.linalg.norm(q_des - q), rel=1e-14)
    assert other.torque(q, q, q + 0.001, q, q).integral_rate == 0.0  # inside epsilon


def test_the_integral_raises_both_gains(robot: Robot) -> None:
    controller = mr.RobustController(robot, kappa_P=2, kappa_I=100, phi_P=1, phi_I=200)
    plain, grown = controller.torque(*inputs(1)), controller.torque(*inputs(1), integral=0.05)
    r = plain.v / (2.0 * plain.rho_norm + 1.0)
    np.testing.assert_allclose(grown.v, (7.0 * plain.rho_norm + 11.0) * r, rtol=1e-13)


def test_commands_and_their_own_integrals_do_not_notice_it(robot: Robot) -> None:
    one, other = mr.RobustController(robot), mr.RobustController(robot)
    for t in (0.0, 0.1, 0.1, 0.3):
        expected = other.command(t, *inputs(2))
        kappa, phi = other.kappa, other.phi
        np.testing.assert_array_equal(one.command(t, *inputs(2)).tau, expected.tau)
        one.torque(*inputs(3), integral=5.0)
        assert (one.kappa, one.phi) == (kappa, phi)
    with pytest.raises(TimeOrderError):
        one.command(0.0, *inputs(2))


def test_a_solver_carries_the_integral_as_a_state(robot: Robot) -> None:
    """Of the solver's and of a finely stepped loop's integrals and ends; no time is ever kept."""
    integrate = pytest.importorskip("scipy.integrate")
    controller = mr.RobustController(robot)
    truth = robot.sample_parameters(3)

    def desired(t: float) -> tuple[Any, Any, Any]:
        return (
            np.array([np.sin(t), 0.5 * np.sin(2 * t)]),
            np.array([np.cos(t), np.cos(2 * t)]),
            np.array([-np.sin(t), -2.0 * np.sin(2 * t)]),
        )

    def rate(t: float, x: Any) -> Any:
        q, dq, integral = x[:N], x[N : 2 * N], x[2 * N]
        command = controller.torque(q, dq, *desired(t), integral=integral)
        ddq = mr.forward_dynamics(robot, q, dq, command.tau, parameters=truth)
        return np.concatenate([dq, ddq, [command.integral_rate]])

    start = np.concatenate([[0.05, -0.04], [0.0, 0.0], [0.0]])
    found = integrate.solve_ivp(rate, (0.0, 0.5), start, method="LSODA", rtol=1e-8, atol=1e-10)
    assert found.success
    end = found.y[:, -1]

    x, h = start, 1e-4
    for k in range(5000):
        t = k * h
        a = rate(t, x)
        b = rate(t + h / 2, x + h / 2 * a)
        x = x + h * b
    np.testing.assert_allclose(end[:N], x[:N], atol=1e-5)
    assert end[-1] == pytest.approx(x[-1], rel=1e-3)
    assert end[-1] > 1e-3
    assert np.linalg.norm(desired(0.5)[0] - end[:N]) < 0.01
    backwards = controller.torque(start[:N], start[N : 2 * N], *desired(0.0))
    np.testing.assert_array_equal(backwards.tau, controller.torque(*_at(start), *desired(0)).tau)


def _at(x: Any) -> tuple[Any, Any]:
    return x[:N], x[N : 2 * N]


@pytest.mark.parametrize(
    ("integral", "message"),
    [
        (np.nan, "integral: nan; must be finite and not negative"),
        (np.inf, "integral: inf; must be finite and not negative"),
        (-0.1, "integral: -0.1; must be finite and not negative"),
        ("much", "integral: 'much'; must be a number"),
    ],
)
def test_an_integral_that_is_none_is_refused(robot: Robot, integral: Any, message: str) -> None:
    with pytest.raises(ValueRangeError) as caught:
        mr.RobustController(robot).torque(*inputs(0), integral=integral)
    assert str(caught.value).startswith(message)


def test_what_a_solver_makes_of_zero_counts_as_zero(robot: Robot) -> None:
    controller = mr.RobustController(robot)
    below = controller.torque(*inputs(0), integral=-SOLVER_ERROR)
    np.testing.assert_array_equal(below.tau, controller.torque(*inputs(0)).tau)


def test_a_vector_that_is_none_is_refused(robot: Robot) -> None:
    q, dq, q_des, dq_des, ddq_des = inputs(0)
    with pytest.raises(ShapeError, match=r"^q_des: expected shape \(2,\), got \(3,\)"):
        mr.RobustController(robot).torque(q, dq, np.zeros(3), dq_des, ddq_des)
    with pytest.raises(ValueRangeError, match=r"^dq\[0\] is nan"):
        mr.RobustController(robot).torque(q, [np.nan, 0.0], q_des, dq_des, ddq_des)
    with pytest.raises(ValueRangeError, match="beyond 100000 rad"):
        mr.RobustController(robot).torque([1e6, 0.0], dq, q_des, dq_des, ddq_des)


@pytest.mark.parametrize("before", [0.3, 1e-9, 7e5, -2.0])
def test_time_may_seem_to_go_back_by_its_rounding(robot: Robot, before: float) -> None:
    """0.1 + 0.2 is after 0.3: no step, and nothing that is counted twice afterwards."""
    one, other = mr.RobustController(robot), mr.RobustController(robot)
    for controller in (one, other):
        controller.command(before, *inputs(1))
    back = before - 3 * np.spacing(abs(before))
    np.testing.assert_array_equal(
        one.command(back, *inputs(2)).tau, other.command(before, *inputs(2)).tau
    )
    assert one.kappa == other.kappa
    after = before + 0.25
    one.command(after, *inputs(3))
    other.command(after, *inputs(3))
    assert one.kappa == other.kappa > 2.0
    for too_far in (after - 1e-9 * (1.0 + abs(after)), -np.inf):
        with pytest.raises((TimeOrderError, ValueRangeError)):
            one.command(too_far, *inputs(2))
