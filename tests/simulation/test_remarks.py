"""What a run says beside its verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import LoopSettings, Robot, TrajectorySettings, synthetic_chain
from modrobust.motion import Quintic
from modrobust.simulation.remarks import remarks
from support.random_robots import random_robot

T = np.array([0.0, 0.1, 0.2])  # [s]
STILL = np.zeros((3, 2))


@pytest.fixture(scope="module")
def robot() -> Robot:
    return replace(
        random_robot(np.random.default_rng(1), types="rp"),
        joint_names=("elbow", "slide"),
        position_limits=np.array([[-1.0, 1.0], [-np.inf, np.inf]]),
        velocity_limits=np.array([np.inf, 0.5]),
    )


def said(robot: Robot, q: Any = STILL, dq: Any = STILL, noisy: Any = None) -> list[str]:
    logged = np.array(q), np.array(dq), np.zeros((3, 2))
    every: Any = (T, *logged, noisy)
    return remarks(robot, robot.controller, robot.loop, 0.2, *every)


def noisy_run(tau_step: float) -> tuple[Robot, list[str]]:
    """What is said of torques that step by so much a tick under noise of 1 mrad and 0.1 rad/s."""
    arm = synthetic_chain(2)
    loop = LoopSettings(rate=1e3, noise_position=(1e-3,) * 2, noise_velocity=(0.1,) * 2)
    gains = mr.RobustController(arm, law="sampled", G=20.0, loop=loop).settings
    t: Any = np.arange(40) * 1e-3
    tau = np.zeros((40, 2))
    tau[1::2, 0] = tau_step
    still: Any = np.zeros((40, 2))
    return arm, remarks(arm, gains, loop, 0.04, t, still, still, tau, np.full(2, 99.0))


def test_with_noise_a_torque_may_step_by_what_the_noise_explains() -> None:
    arm, quiet = noisy_run(0.0)
    assert quiet == []
    controller = mr.RobustController(arm, law="sampled", G=20.0)
    M = mr.mass_matrix(arm, [0.0, 0.0], controller._points[1])
    each = (20.0 + 10.0) * 0.1 + 20.0 * 10.0 * 1e-3
    explained = 3.0 * np.sqrt(2.0 / 3.0) * np.hypot(*(M[0] * each))
    assert noisy_run(0.99 * explained)[1] == []
    (remark,) = noisy_run(1.02 * explained)[1]
    assert f'joint "{arm.joint_names[0]}" steps by ' in remark
    assert "the noise explains (3 sigma)" in remark


def test_a_quiet_run_within_its_limits_has_no_remarks(robot: Robot) -> None:
    assert said(robot, q=[[-1.0, 0.0], [1.0, 9.0], [1.0 + 1e-9, 0.0]], noisy=np.ones(2)) == []


def test_a_position_beyond_its_limit_is_told_with_joint_size_and_time(robot: Robot) -> None:
    q = [[0.0, 0.0], [-1.25, 0.0], [1.125, 0.0]]
    assert said(robot, q=q) == [
        'joint "elbow" went 0.25 rad beyond its position limit of -1 rad, at t = 0.1 s'
    ]


def test_a_velocity_beyond_its_limit_is_told_with_joint_size_and_time(robot: Robot) -> None:
    dq = [[9.0, 0.0], [0.0, 0.0], [0.0, -0.75]]
    assert said(robot, dq=dq) == [
        'joint "slide" went 0.25 m/s beyond its velocity limit of -0.5 m/s, at t = 0.2 s'
    ]


def test_a_state_that_is_no_number_is_passed_over(robot: Robot) -> None:
    q = [[np.nan, np.nan], [1.5, np.nan], [np.nan, np.nan]]
    assert len(said(robot, q=q)) == 1


def test_a_torque_that_shakes_names_the_worst_joint_and_the_remedy(robot: Robot) -> None:
    assert said(robot, noisy=np.array([1.1, 854.3])) == [
        'the torque chatters, joint "slide" most, 854 times the variation of the same signal at '
        "10 Hz (limit 1.1); raise phi_P, lower kappa_P"
    ]
    assert "beyond all measure" in said(robot, noisy=np.array([np.inf, 2.0]))[0]


def test_a_duration_shorter_than_the_last_point_is_told(robot: Robot) -> None:
    points = ((0.0, 0.0), (1.0, 1.0))
    short = TrajectorySettings("quintic", duration=0.2, times=(0.0, 3.0), points=points)
    assert said(replace(robot, trajectory=short)) == [
        "the motion of the file has its last point at 3 s, after its duration of 0.2 s; "
        "raise the duration"
    ]
    assert said(replace(robot, trajectory=replace(short, duration=3.0))) == []


def test_a_run_that_hurries_back_to_its_motion_has_remarks_in_its_summary() -> None:
    slow = replace(mr.load_robot("lwa4p-paper"), velocity_limits=np.full(6, 0.05))
    still = Quintic(np.zeros(1), np.zeros((1, 6)))
    run = mr.simulate(slow, trajectory=still, duration=0.1, q0=np.full(6, 0.1))
    told = run.summary()["remarks"]
    assert told == run.remarks
    assert len(told) == np.count_nonzero(np.abs(run.dq).max(axis=0) > 0.05) > 0
    fastest = np.abs(run.dq[:, 0]).max()
    assert f'joint "link1.axis" went {fastest - 0.05:.3g} rad/s beyond its velocity' in told[0]
