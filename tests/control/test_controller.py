"""The controller against its formulas, its integrators, its settings and its errors."""

from __future__ import annotations

import re
import threading
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import ModrobustError, ShapeError, TimeOrderError, ValueRangeError
from modrobust.model import Bounded, Robot, synthetic_chain
from support.rounding import assert_encloses, excess_allowed

N = 4


@pytest.fixture(scope="module")
def robot() -> Robot:
    """A chain with a disturbance, friction and gains that differ from joint to joint."""
    chain = synthetic_chain(N)

    def drives(x: float) -> dict[str, Any]:
        return {
            "rotor_inertia": np.full(N, x * 1e-5),
            "viscous": np.full(N, x * 0.3),
            "coulomb": np.full(N, x * 0.2),
        }

    d = np.array([0.1, 0.2, 0.0, 0.3])
    return replace(
        chain,
        gear_ratio=np.full(N, 50.0),
        nominal=replace(chain.nominal, **drives(1.0)),
        lower=replace(chain.lower, **drives(0.8)),
        upper=replace(chain.upper, **drives(1.5)),
        disturbance=Bounded(np.zeros(N), -d, 2.0 * d),
        controller=replace(chain.controller, K_r=(10.0, 8.0, 6.0, 5.0)),
    )


def inputs(seed: int, error: float = 0.1) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2, 2, N)
    dq, dq_des, ddq_des = rng.uniform(-1, 1, (3, N))
    return q, dq, q + rng.uniform(-error, error, N), dq_des, ddq_des


@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_the_command_equals_the_formulas(robot: Robot, bound: str) -> None:
    K_r = np.array(robot.controller.K_r)
    controller = mr.RobustController(robot, bound=bound, kappa_P=3.0, phi_P=0.7)
    for seed in range(20):
        controller.reset()
        q, dq, q_des, dq_des, ddq_des = inputs(seed)
        command = controller.command(0.0, q, dq, q_des, dq_des, ddq_des)
        dq_a = dq_des + K_r * (q_des - q)  # (4)
        ddq_a = ddq_des + K_r * (dq_des - dq)
        r = (dq_des - dq) + K_r * (q_des - q)
        phi = mr.perturbation_bounds(robot, q, dq, dq_a, ddq_a, bound=bound)  # (12)
        # the command's encloses the rounding of (4), too: that of these sizes in place of its terms
        dq_a_size = np.abs(dq_des) + K_r * (np.abs(q_des) + np.abs(q))
        ddq_a_size = np.abs(ddq_des) + K_r * (np.abs(dq_des) + np.abs(dq))
        allowed = excess_allowed(robot, q, dq, dq_a_size, ddq_a_size, bound=bound)
        assert_encloses((command.phi_lo, command.phi_hi), phi, allowed)
        rho = np.maximum(np.abs(command.phi_lo), np.abs(command.phi_hi))  # (8)
        v = (3.0 * np.linalg.norm(rho) + 0.7) * r  # (7)
        u0 = mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a)
        close = partial(np.testing.assert_allclose, rtol=1e-13, atol=1e-13)
        close(command.nominal, u0)
        np.testing.assert_array_equal(command.rho, rho)
        close(command.v, v)
        np.testing.assert_array_equal(command.tau, command.nominal + command.v)  # (3)
        assert command.rho_norm == pytest.approx(np.linalg.norm(rho), rel=1e-14)
        assert isinstance(command.rho_norm, float)


def test_the_disturbance_widens_the_perturbation_set(robot: Robot) -> None:
    quiet = replace(robot, disturbance=Bounded(np.zeros(N), np.zeros(N), np.zeros(N)))
    args = inputs(1)
    noisy = mr.RobustController(robot).command(0.0, *args)
    without = mr.RobustController(quiet).command(0.0, *args)
    np.testing.assert_allclose(noisy.phi_lo, without.phi_lo - robot.disturbance.hi, atol=1e-12)
    np.testing.assert_allclose(noisy.phi_hi, without.phi_hi - robot.disturbance.lo, atol=1e-12)


def test_the_integral_advances_by_the_previous_error_and_the_time_since(robot: Robot) -> None:
    controller = mr.RobustController(
        robot, kappa_P=2.0, kappa_I=100.0, phi_P=1.0, phi_I=200.0, epsilon=0.01
    )
    integral, previous, before = 0.0, 0.0, 0.0
    # The second error is inside epsilon: the integral then rests for one step.
    for t, error in [(1.0, 0.1), (1.25, 0.005), (1.5, 0.2), (1.5, 0.3), (2.0, 0.0)]:
        q, dq, _, dq_des, ddq_des = inputs(3)
        q_des = q + np.array([error, 0.0, 0.0, 0.0])
        size = float(np.linalg.norm(q_des - q))
        if t > 1.0:
            integral += previous * (t - before)
        command = controller.command(t, q, dq, q_des, dq_des, ddq_des)
        previous, before = (size if size >= 0.01 else 0.0), t
        assert controller.kappa == pytest.approx(2.0 + 100.0 * integral, rel=1e-14)
        assert controller.phi == pytest.approx(1.0 + 200.0 * integral, rel=1e-14)
        r = (dq_des - dq) + np.array(robot.controller.K_r) * (q_des - q)
        gain = controller.kappa * command.rho_norm + controller.phi
        np.testing.assert_allclose(command.v, gain * r, rtol=1e-12)
    # By hand: 0.1 for 0.25 s, nothing for 0.25 s, nothing at once, 0.3 for 0.5 s.
    assert integral == pytest.approx(0.1 * 0.25 + 0.3 * 0.5)


def test_time_going_backwards_is_an_error_that_leaves_the_controller_as_it_was(
    robot: Robot,
) -> None:
    one, other = mr.RobustController(robot), mr.RobustController(robot)
    for controller in (one, other):
        controller.command(1.0, *inputs(1))
    with pytest.raises(TimeOrderError, match="t went backwards"):
        one.command(0.5, *inputs(2))
    with pytest.raises(ValueRangeError):
        one.command(1.2, inputs(1)[0] * 1e6, *inputs(1)[1:])
    after, expected = (controller.command(1.5, *inputs(4)) for controller in (one, other))
    np.testing.assert_array_equal(after.tau, expected.tau)
    assert one.kappa == other.kappa > 2.0


def test_reset_forgets_time_and_integrals(robot: Robot) -> None:
    controller = mr.RobustController(robot)
    first = controller.command(5.0, *inputs(1))
    controller.command(6.0, *inputs(2))
    controller.reset()
    again = controller.command(0.0, *inputs(1))
    np.testing.assert_array_equal(again.tau, first.tau)


def test_settings_default_to_the_robots_and_keywords_override_them(robot: Robot) -> None:
    assert mr.RobustController(robot).settings == robot.controller
    by_name = dict(zip(robot.joint_names, (1.0, 2.0, 3.0, 4.0), strict=True))
    for K_r in ([1, 2, 3, 4], np.array([1.0, 2.0, 3.0, 4.0]), by_name):
        assert mr.RobustController(robot, K_r=K_r).settings.K_r == (1.0, 2.0, 3.0, 4.0)
    assert mr.RobustController(robot, K_r=7).settings.K_r == (7.0,) * N
    changed = mr.RobustController(robot, kappa_I=0, bound="ianea").settings
    assert (changed.kappa_I, changed.bound, changed.phi_I) == (0.0, "ianea", 200.0)


@pytest.mark.parametrize(
    ("settings", "kind", "message"),
    [
        (
            {"law": "nrom"},
            ValueRangeError,
            'law: no law "nrom"; did you mean "norm"? known: norm, componentwise, sampled, auto',
        ),
        (
            {"law": ["norm"]},
            ValueRangeError,
            "law: no law \"['norm']\"; "
            'did you mean "norm"? known: norm, componentwise, sampled, auto',
        ),
        ({"bound": "exact"}, ValueRangeError, 'bound: no bound "exact"; known: hull, ianea'),
        ({"kappa_P": -1}, ValueRangeError, "kappa_P: -1; must be finite and not negative"),
        ({"phi_I": np.nan}, ValueRangeError, "phi_I: nan; must be finite and not negative"),
        ({"phi_P": "much"}, ValueRangeError, "phi_P: 'much'; must be a number"),
        (
            {"epsilon": 0.0},
            ValueRangeError,
            "epsilon: 0; must be positive: it is the radius that the tracking error is to stay in",
        ),
        (
            {"K_r": 0.0},
            ValueRangeError,
            'K_r: 0 for joint "link1.axis"; must be finite and positive',
        ),
        (
            {"K_r": [1.0, 2.0, np.inf, 1.0]},
            ValueRangeError,
            'K_r: inf for joint "link3.axis"; must be finite and positive',
        ),
        (
            {"K_r": [1.0, 2.0]},
            ShapeError,
            'K_r: expected shape (4,), got (2,); robot "chain-4" has 4 joints',
        ),
        (
            {"K_r": {"link1.axes": 1.0}},
            ValueRangeError,
            'K_r: no joint "link1.axes"; did you mean "link1.axis"? '
            "known: link1.axis, link2.axis, link3.axis, link4.axis",
        ),
        (
            {"K_r": {"link1.axis": 1.0, "link3.axis": 1.0}},
            ValueRangeError,
            "K_r: nothing for link2.axis, link4.axis; every joint needs a value",
        ),
    ],
)
def test_a_wrong_setting_is_refused(
    robot: Robot, settings: dict[str, Any], kind: type[ModrobustError], message: str
) -> None:
    with pytest.raises(kind, match=f"^{re.escape(message)}$"):
        mr.RobustController(robot, **settings)


def test_a_vector_of_the_wrong_length_is_refused_by_name(robot: Robot) -> None:
    q, dq, q_des, dq_des, ddq_des = inputs(1)
    controller = mr.RobustController(robot)
    with pytest.raises(ShapeError) as caught:
        controller.command(0.0, q, dq, q_des[:3], dq_des, ddq_des)
    assert str(caught.value) == (
        'q_des: expected shape (4,), got (3,); robot "chain-4" has 4 joints'
    )


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("position", range(5))
def test_a_number_that_is_not_finite_never_gives_a_torque(
    robot: Robot, bad: float, position: int
) -> None:
    args = [x.copy() for x in inputs(1)]
    args[position][2] = bad
    with pytest.raises(ValueRangeError, match=r"\[2\] is (nan|inf); every entry must be finite"):
        mr.RobustController(robot).command(0.0, *args)
    with pytest.raises(ValueRangeError):
        mr.RobustController(robot).command(bad, *inputs(1))


@pytest.mark.parametrize(
    ("t", "message"),
    [
        (np.nan, "t: nan s; must be finite"),
        (np.inf, "t: inf s; must be finite"),
        ("abc", "t: 'abc'; must be a number [s]"),
        (None, "t: None; must be a number [s]"),
        ([0.0], "t: [0.0]; must be a number [s]"),
    ],
)
def test_a_time_that_is_no_instant_is_refused_and_changes_nothing(
    robot: Robot, t: Any, message: str
) -> None:
    controller = mr.RobustController(robot)
    controller.command(1.0, *inputs(1))
    with pytest.raises(ValueRangeError) as caught:
        controller.command(t, *inputs(1))
    assert str(caught.value) == message
    controller.command(1.0, *inputs(1))


def test_times_of_commands_are_positive_and_leave_the_controller_alone(robot: Robot) -> None:
    controller = mr.RobustController(robot)
    controller.command(9.0, *inputs(1))
    signals = [np.tile(x, (50, 1)) for x in inputs(2)]
    seconds = controller.time_commands(np.arange(50) * 1e-3, *signals)
    assert seconds.shape == (50,)
    assert (seconds > 0.0).all()
    assert (seconds < 1.0).all()
    with pytest.raises(TimeOrderError):
        controller.command(0.0, *inputs(1))


def test_timing_in_one_thread_leaves_commands_in_another_alone() -> None:
    robot = mr.load_robot("lwa4p-paper")
    controller = mr.RobustController(robot)
    rng = np.random.default_rng(0)
    q, dq, q_des, dq_des, ddq_des = rng.normal(size=(5, 6))
    k = 100_000
    signals = [np.tile(x, (k, 1)) for x in rng.normal(size=(5, 6))]
    alone = controller.command(0.0, q, dq, q_des, dq_des, ddq_des).tau
    worker = threading.Thread(
        target=lambda: controller.time_commands(np.linspace(0.0, 1.0, k), *signals)
    )
    worker.start()
    beside = 0
    while worker.is_alive():
        tau = controller.command(0.0, q, dq, q_des, dq_des, ddq_des).tau
        np.testing.assert_array_equal(tau, alone)
        beside += 1
    worker.join()
    assert beside > 10
