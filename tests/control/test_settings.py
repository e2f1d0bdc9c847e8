"""Settings of the laws and the loop: what is taken, what is refused, what a rate asks of gains."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.control import RateWarning
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import LoopSettings, Robot, synthetic_chain


@pytest.fixture(scope="module")
def robot() -> Robot:
    return synthetic_chain(3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"law": "sampld"}, 'law: no law "sampld"; did you mean "sampled"'),
        ({"law": "sampled"}, "G: nothing given"),
        ({"law": "sampled", "G": 0.0}, "G: 0; must be finite and positive"),
        ({"law": "sampled", "G": np.inf}, "G: inf; must be finite and positive"),
        ({"law": "sampled", "G": 20.0, "L_i": -1.0}, "L_i: -1; must be finite and not negative"),
        ({"kappa_max": 0.0}, "kappa_max: 0; must be"),
        ({"leak": -1.0}, "leak: -1; must be finite and not negative"),
        ({"blend": np.nan}, "blend: nan; must be finite and not negative"),
        ({"hold_aware": 1}, "hold_aware: 1; must be True or False"),
        ({"epsilon": 0.0}, "epsilon: 0; must be positive"),
        ({"rate": 0.5}, "rate: 0.5 Hz; must lie in"),
        ({"rate": np.nan}, "rate: nan Hz; must lie in"),
        ({"delay": 1.5}, "delay: 1.5; must lie in [0, 1]"),
        ({"loop": 1000.0}, "loop: a float; must be a LoopSettings"),
        ({"loop": LoopSettings(noise="gaussian")}, 'noise: no noise "gaussian"; known: uniform'),
        ({"loop": LoopSettings(disturbance="wrost")}, 'did you mean "worst"'),
        ({"loop": LoopSettings(filter=0.0)}, "filter: 0; must be finite and positive"),
        ({"loop": LoopSettings(noise_position=(-1.0,) * 3)}, "loop.noise_position: must be"),
    ],
)
def test_a_wrong_setting_is_refused(robot: Robot, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueRangeError) as caught:
        mr.RobustController(robot, **options)
    assert message in str(caught.value)


def test_an_unknown_setting_is_a_type_error(robot: Robot) -> None:
    with pytest.raises(TypeError, match='no setting "kapa_P" of a controller; did you mean'):
        mr.RobustController(robot, kapa_P=1.0)  # type: ignore[call-arg]


def test_noise_has_an_entry_a_joint(robot: Robot) -> None:
    with pytest.raises(ShapeError, match=r"loop.noise_position: expected shape \(3,\), got \(2,\)"):
        mr.RobustController(robot, loop=LoopSettings(noise_position=(1e-4, 1e-4)))


def test_gains_of_sampled_follow_from_G(robot: Robot) -> None:
    settings = mr.RobustController(robot, law="sampled", G=60.0).settings
    assert (settings.Lambda, settings.L_i) == (30.0, 0.05 * 60.0**2)
    own = mr.RobustController(robot, law="sampled", G=60.0, Lambda=10.0, L_i=0.0).settings
    assert (own.Lambda, own.L_i) == (10.0, 0.0)


def test_the_robot_s_loop_is_the_default_and_rate_and_delay_lie_over_it(robot: Robot) -> None:
    own = replace(robot, loop=LoopSettings(rate=500.0, delay=1.0, saturation=True))
    assert mr.RobustController(own).loop == own.loop
    found = mr.RobustController(own, law="sampled", G=20.0, rate=2e3, delay=0.5).loop
    assert found == replace(own.loop, rate=2e3, delay=0.5)
    assert mr.RobustController(own).period == 1.0 / 500.0


@pytest.mark.parametrize("law", ["norm", "componentwise"])
def test_the_needed_rate_is_where_the_gain_over_the_inertia_is_one(robot: Robot, law: str) -> None:
    controller = mr.RobustController(robot, law=law)
    need = controller.rate_need
    assert need is not None
    faster = mr.RobustController(robot, law=law, rate=3.0 * robot.loop.rate).rate_need
    assert faster is not None
    assert faster.share == pytest.approx(need.share / 3.0)
    assert need.rate == pytest.approx(faster.rate) == pytest.approx(need.share * robot.loop.rate)


def test_of_one_joint_it_is_the_gain_over_the_least_inertia() -> None:
    arm = synthetic_chain(1)
    need = mr.RobustController(arm, kappa_P=0.0, phi_P=7.0).rate_need
    assert need is not None
    M = min(float(mr.mass_matrix(arm, [0.0], p)[0, 0]) for p in (arm.lower, arm.nominal))
    assert need.rate >= 7.0 / M * (1 - 1e-9)
    assert need.rate <= 1.2 * 7.0 / M


def test_a_rate_that_is_given_and_too_slow_is_warned_of(robot: Robot) -> None:
    need = mr.RobustController(robot).rate_need
    assert need is not None
    slow, fast = need.rate / 2.0, need.rate * 2.0
    with pytest.warns(RateWarning, match="the loop may diverge: the gains need about"):
        mr.RobustController(robot, rate=slow)
    with pytest.warns(RateWarning, match="will most likely diverge"):
        mr.RobustController(robot, rate=slow / 2.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mr.RobustController(robot, rate=fast)
        mr.RobustController(robot, law="sampled", G=10.0, rate=slow)
        mr.RobustController(robot, hold_aware=True, rate=slow)


def test_a_loop_of_one_s_own_steps_from_tick_to_tick(robot: Robot) -> None:
    steps = mr.RobustController(robot, law="sampled", G=30.0, rate=500.0)
    told = mr.RobustController(robot, law="sampled", G=30.0, rate=500.0)
    rng = np.random.default_rng(0)
    for k in range(20):
        signals = rng.uniform(-0.01, 0.01, (5, 3))
        a, b = steps.step(*signals), told.command(k / 500.0, *signals)
        np.testing.assert_array_equal(a.tau, b.tau)
    steps.reset()
    told.reset()
    np.testing.assert_array_equal(steps.step(*signals).tau, told.command(0.0, *signals).tau)


def test_reset_starts_from_a_given_pose(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="sampled", G=30.0, blend=0.3)
    place, rest = np.array([0.2, -0.1, 0.05]), np.zeros(3)
    controller.reset(place)
    there = controller.step(place, rest, rest, rest, rest)
    fresh = mr.RobustController(robot, law="sampled", G=30.0, blend=0.3)
    np.testing.assert_array_equal(there.tau, fresh.step(place, rest, rest, rest, rest).tau)
    controller.reset(place)
    off = controller.step(place + 1e-3, rest, rest, rest, rest)
    assert np.abs(off.v).max() > 0.0  # 1 mrad is an error now, no start
    np.testing.assert_array_equal(off.nominal, there.nominal)
    with pytest.raises(ShapeError):
        controller.reset(np.zeros(2))


def test_the_law_from_tick_to_tick_is_no_function_of_the_state(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="sampled", G=30.0)
    with pytest.raises(ValueRangeError, match="no function of the state alone"):
        controller.torque(*np.zeros((5, 3)))
