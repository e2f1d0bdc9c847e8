"""The rule as a whole: what binds, what it says, what it refuses."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.design import central_parameters, design
from modrobust.design.choice import integral_gain, measured_noise, noise_gain
from modrobust.design.gains import BLEND, blend_time
from modrobust.design.spectra import Spectra
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import LoopSettings
from modrobust.motion import make_trajectory

PLAIN = LoopSettings()


def noisy(n, rate=1000.0, delay=1.0, position=1e-4, velocity=1e-2):
    return LoopSettings(rate, delay, (position,) * n, (velocity,) * n)


@cache
def arm(name="scara"):
    return mr.load_robot(name)


@cache
def chosen(name="scara", rate=1000.0, epsilon=None):
    return design(arm(name), LoopSettings(rate=rate), epsilon=epsilon)


def test_the_settings_are_those_of_the_law_with_its_gains():
    found = chosen()
    s = found.settings
    assert (s.law, s.bound, s.epsilon) == ("sampled", "hull", arm().controller.epsilon)
    assert s.Lambda == 0.5 * s.G == 0.5 * found.G
    assert s.K_r == (s.Lambda,) * arm().n
    assert s.L_i == pytest.approx(s.G**2 * min(0.05, found.spectra.light[0]), rel=5e-3)
    assert (s.integral, s.predictor, s.vector_saturation) == (True, True, True)


def test_it_is_the_same_each_time():
    again = design(arm(), PLAIN)
    assert again.settings == chosen().settings
    assert again.to_dict() == chosen().to_dict()
    before = np.random.get_state(legacy=False)["state"]["key"].copy()  # noqa: NPY002
    design(arm(), PLAIN)
    assert np.array_equal(before, np.random.get_state(legacy=False)["state"]["key"])  # noqa: NPY002


def test_the_gain_is_the_least_that_meets_epsilon():
    found = chosen()
    assert (found.binding, found.reachable) == ("epsilon", True)
    assert pytest.approx(found.G_eps, rel=5e-3) == found.G
    assert pytest.approx(np.sqrt(4.0 * found.need.total / 0.01)) == found.G_eps
    quarter = chosen(epsilon=0.04)
    assert quarter.G_eps == pytest.approx(0.5 * found.G_eps)
    assert found.remarks == (
        "epsilon and errors are norms over joints in rad and joints in m together",
    )
    assert found.helps == ()


def test_a_wide_epsilon_leaves_the_floor():
    found = chosen(epsilon=5.0)
    assert (found.binding, found.G) == ("floor", 20.0)


def test_a_faster_loop_allows_more():
    found = [chosen("lwa4p-paper", rate) for rate in (250.0, 500.0, 1000.0, 4000.0)]
    assert [x.binding for x in found] == ["stability", "stability", "epsilon", "epsilon"]
    gains = [x.G_stab for x in found]
    assert gains == sorted(gains)
    assert gains[1] == pytest.approx(2.0 * gains[0])
    reached = [x.epsilon_reached for x in found]
    assert reached == sorted(reached, reverse=True)
    assert [x.reachable for x in found] == [False, False, True, True]


def test_what_cannot_be_met_is_said_with_what_can():
    found = chosen("lwa4p-paper", 500.0)
    assert found.remarks[0] == (
        f"epsilon 0.01 rad is not reachable at this rate: it asks for G = {found.G_eps:.3g}/s, a "
        f"loop at 500 Hz allows {found.G_stab:.3g}/s; epsilon {found.epsilon_reached:.2g} rad is"
    )
    within = design(arm("lwa4p-paper"), LoopSettings(rate=500.0), epsilon=found.epsilon_reached)
    assert within.G_eps == pytest.approx(within.G_stab)


def test_what_helps_is_sorted_and_true():
    """The best change made for real gives the epsilon that was promised."""
    robot = arm("lwa4p-paper")
    found = design(robot, LoopSettings(rate=500.0, delay=1.0))
    helps = {item.change: item for item in found.helps}
    assert [x.epsilon for x in found.helps] == sorted(x.epsilon for x in found.helps)
    assert all(x.epsilon < found.epsilon_reached for x in found.helps)
    doubled = design(robot, LoopSettings(rate=1000.0, delay=1.0))
    assert helps["twice the rate, 1000 Hz"].epsilon == pytest.approx(doubled.epsilon_reached)
    assert pytest.approx(doubled.G_stab) == helps["twice the rate, 1000 Hz"].G
    on_time = design(robot, LoopSettings(rate=500.0))
    assert helps["no delay"].epsilon == pytest.approx(on_time.epsilon_reached)
    assert "half the noise of the sensors" not in helps
    body = next(x for x in helps if x.startswith("half the box of the mass of "))
    index = robot.body_names.index(body.removeprefix("half the box of the mass of "))
    ends = {}
    for name in ("lower", "upper"):
        p = getattr(robot, name)
        mass = p.mass.copy()
        mass[index] = 0.5 * (mass[index] + robot.nominal.mass[index])
        ends[name] = replace(p, mass=mass)
    narrow = design(replace(robot, **ends), LoopSettings(rate=500.0, delay=1.0))
    assert helps[body].epsilon == pytest.approx(narrow.epsilon_reached)


def test_drive_figures_help_an_arm_that_has_none():
    robot = replace(arm("ur5"), gear_ratio=np.zeros(6))
    found = design(robot, noisy(6))
    assert any(
        x.change.startswith("drive: figures of the joints that have none") for x in found.helps
    )


def test_a_light_and_a_heavy_robot_in_one_box_are_remarked_on():
    robot = arm("lwa4p-paper")
    p = robot.lower
    light = replace(p, mass=0.02 * p.mass, inertia=np.where(p.inertia < 0.0, 1.0, 0.02) * p.inertia)
    found = design(replace(robot, lower=light), PLAIN)
    assert found.spectra.spread > 20.0
    assert any("times as heavy as the lightest" in remark for remark in found.remarks)


def test_any_motion_asks_for_more_than_a_slow_one():
    motion = make_trajectory(arm())
    own = design(arm(), PLAIN, motion=motion)
    assert own.motion == f"the motion given, {motion.duration:g} s"
    assert chosen().motion == "any motion within the joint and velocity limits"
    assert own.G_eps < chosen().G_eps


@pytest.mark.parametrize("delay", [0.0, 1.0])
def test_noise_asks_for_its_share_of_a_torque_limit(delay):
    """By hand for one joint: sqrt3 M (1.5 G n_v + 0.5 G^2 (n_q + D T n_v)) = 0.3 limit."""
    G = noise_gain(np.array([[[2.0]]]), np.array([40.0]), noisy(1, delay=delay))
    asked = 1.5 * G * 1e-2 + 0.5 * G**2 * (1e-4 + delay * 1e-3 * 1e-2)
    assert np.sqrt(3.0) * 2.0 * asked == pytest.approx(12.0)


def test_noise_of_several_joints_adds_up_as_a_norm_and_the_tightest_joint_counts():
    M = np.array([[[2.0, 1.0], [1.0, 3.0]]])
    loop = noisy(2, delay=0.0)
    G = noise_gain(M, np.array([np.inf, 40.0]), loop)
    asked = np.sqrt(3.0) * np.hypot(1.0, 3.0) * (1.5 * G * 1e-2 + 0.5 * G**2 * 1e-4)
    assert asked == pytest.approx(12.0)
    assert noise_gain(M, np.array([0.1, 40.0]), loop) < G


def test_joints_without_a_limit_set_none():
    assert noise_gain(np.ones((1, 1, 1)), np.array([np.inf]), noisy(1)) == np.inf
    found = design(replace(arm(), effort_limits=np.full(4, np.inf)), noisy(4))
    assert found.to_dict()["bounds"]["G_noise"] is None


def test_no_sensor_is_better_than_the_floor():
    q, v = measured_noise(LoopSettings(), 2)
    np.testing.assert_allclose(q, 1e-6)
    np.testing.assert_allclose(v, 1e-4)


def test_steps_of_a_sensor_count_half_and_differentiated_with_their_filter():
    step = (2e-4, 4e-4)
    q, v = measured_noise(
        LoopSettings(quantisation_position=step, quantisation_velocity=(0.1, 0.2)), 2
    )
    np.testing.assert_allclose(q, [1e-4, 2e-4])
    np.testing.assert_allclose(v, [0.05, 0.1])
    loop = LoopSettings(quantisation_position=step, velocity="differentiated", filter=100.0)
    _, v = measured_noise(loop, 2)
    np.testing.assert_allclose(v, np.array(step) / 1e-3 * (1.0 - np.exp(-2.0 * np.pi * 0.1)))


def test_the_integral_is_slower_where_the_robot_may_be_heavy():
    assert integral_gain(100.0, Spectra((0.5, 1.0), (1.0, 1.0), 1.0)) == pytest.approx(500.0)
    assert integral_gain(100.0, Spectra((0.01, 1.0), (1.0, 1.0), 1.0)) == pytest.approx(100.0)


def test_errors_by_cause_add_up_and_grow_with_their_cause():
    quiet, loud = (design(arm(), noisy(4, position=x, velocity=100.0 * x)) for x in (1e-5, 1e-4))
    assert sum(quiet.expected.values()) == quiet.error
    assert set(quiet.expected) == {
        "parameters",
        "friction",
        "disturbance",
        "noise",
        "hold",
        "delay",
    }
    assert loud.expected["noise"] == pytest.approx(10.0 * quiet.expected["noise"], rel=0.02)
    assert quiet.expected["disturbance"] == 0.0
    assert quiet.expected["friction"] == pytest.approx(2.0 * quiet.need.friction / quiet.G**2)
    worst = design(arm(), replace(noisy(4), noise="worst"))
    assert worst.expected["noise"] == pytest.approx(2.0 * (1e-4 + 3.0 * 1e-2 / worst.G))


def test_the_blend_takes_longer_where_the_start_is_far_off():
    robot = arm("lwa4p")
    centre = central_parameters(robot)
    motion = make_trajectory(robot)
    assert blend_time(robot, centre, None) == BLEND
    assert blend_time(robot, centre, motion) == BLEND  # 0.005 rad off
    limit = robot.velocity_limits[0]
    offset = np.zeros(6)
    offset[0] = 0.6 * limit / 2.0 / 1.875  # [rad]: 0.6 s at half of the limit
    start = motion.sample([0.0])[0][0]
    far = replace(robot, initial_q=start + offset, effort_limits=np.full(6, np.inf))
    assert blend_time(far, centre, motion) == pytest.approx(0.6)
    assert blend_time(replace(far, initial_q=start + 100.0 * offset), centre, motion) == 1.0
    weak = replace(far, initial_q=start + 0.1 * offset, effort_limits=np.full(6, 1e-3))
    assert blend_time(weak, centre, motion) == 1.0


def test_it_is_plain_json():
    found = chosen("lwa4p-paper", 500.0)
    text = json.dumps(found.to_dict(), allow_nan=False)
    assert json.loads(text)["gains"]["G"] == found.G
    assert "helps" not in found.to_dict()
    helps = found.to_dict(helps=True)["helps"]
    assert helps[0] == {
        "change": helps[0]["change"],
        "epsilon": found.helps[0].epsilon,
        "G": found.helps[0].G,
    }


def test_the_robots_own_loop_and_epsilon_are_the_defaults():
    slow = replace(arm(), loop=LoopSettings(rate=250.0))
    found = design(slow)
    assert found.loop.rate == 250.0
    assert found.settings.epsilon == arm().controller.epsilon


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"epsilon": 0.0}, ValueRangeError, "epsilon: 0; must be positive and finite"),
        ({"epsilon": -1.0}, ValueRangeError, "epsilon: -1; must be positive"),
        ({"epsilon": float("nan")}, ValueRangeError, "epsilon: nan; must be positive"),
        ({"epsilon": "small"}, ValueRangeError, "epsilon: 'small'; must be a number"),
        ({"loop": 1000.0}, ValueRangeError, "loop: 1000.0; must be LoopSettings"),
        ({"loop": LoopSettings(rate=0.0)}, ValueRangeError, "rate: 0 Hz; must be positive"),
        ({"loop": LoopSettings(delay=1.5)}, ValueRangeError, "delay: 1.5 periods; must be from 0"),
        ({"loop": LoopSettings(filter=-1.0)}, ValueRangeError, "filter: -1 Hz; must be positive"),
        ({"loop": LoopSettings(noise="big")}, ValueRangeError, "noise: 'big' is not known"),
        ({"loop": LoopSettings(velocity="x")}, ValueRangeError, "velocity: 'x' is not known"),
        (
            {"loop": LoopSettings(noise_position=(1e-4,))},
            ShapeError,
            "noise_position: expected 4 numbers or none, got 1",
        ),
        (
            {"loop": LoopSettings(noise_velocity=(1.0, -1.0, 0.0, 0.0))},
            ValueRangeError,
            "noise_velocity: -1; must be finite and not negative",
        ),
        ({"motion": 3}, ValueRangeError, "trajectory: 3; must be a trajectory"),
    ],
)
def test_what_no_loop_is_like_is_refused(change, error, message):
    with pytest.raises(error, match=f"^{message}".replace("(", r"\(")):
        design(arm(), **change)


def test_a_motion_of_another_robot_is_refused():
    with pytest.raises(ShapeError, match="trajectory: has 6 joints; robot"):
        design(arm(), motion=make_trajectory(arm("lwa4p")))


def test_what_is_no_robot_is_refused():
    wrong: Any = "lwa4p"
    with pytest.raises(ValueRangeError, match="expected a Robot, got str"):
        design(wrong)
