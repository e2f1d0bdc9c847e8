"""The list of runs of a campaign: run k depends on the settings, the seed and its number alone."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import modrobust as mr
from modrobust.campaign import Plan
from modrobust.campaign.motions import REST, draw_motion
from modrobust.campaign.plan import MOTIONS, PARAMETERS, checked_plan
from modrobust.model import DISTURBANCES, NOISES, LoopSettings
from modrobust.simulation import true_robot


def test_true_parameters_are_taken_in_turn() -> None:
    kinds = [Plan().run(k).parameters for k in range(8)]
    assert kinds == ["lower", "upper", "corner", "random"] * 2


def test_every_kind_of_parameters_meets_every_disturbance_noise_and_motion() -> None:
    plan = Plan(seed=3)
    count = len(PARAMETERS) * len(DISTURBANCES) * len(NOISES) * len(MOTIONS)
    for first in (0, count):  # whenever the list has been gone through
        runs = [plan.run(k) for k in range(first, first + count)]
        met = {(r.parameters, r.disturbance, r.noise, r.motion) for r in runs}
        assert met == set(itertools.product(PARAMETERS, DISTURBANCES, NOISES, MOTIONS))


def test_a_run_has_a_seed_of_its_own_that_no_other_campaign_has() -> None:
    seeds = {Plan(seed=s).run(k).seed for s in range(3) for k in (0, 1, 10**6 - 1)}
    assert len(seeds) == 9


def test_another_seed_shuffles_the_kinds_otherwise() -> None:
    one, two = ([Plan(seed=s).run(k) for k in range(24)] for s in (0, 1))
    assert [r.disturbance for r in one] != [r.disturbance for r in two]


def test_a_loop_without_noise_has_no_kind_of_it() -> None:
    robot = mr.load_robot("scara")
    noisy = LoopSettings(noise_position=(1e-4,) * robot.n)
    kinds = PARAMETERS, tuple(DISTURBANCES), NOISES, MOTIONS
    quiet, loud = (
        checked_plan(robot, loop, 0, *kinds, initial_error=0.005)
        for loop in (LoopSettings(), noisy)
    )
    assert quiet.noises == ("none",)
    assert loud.noises == NOISES
    assert quiet.run(0).loop(LoopSettings(rate=500.0)).rate == 500.0


@pytest.mark.parametrize("time", [1.0, 10.0])
@pytest.mark.parametrize("name", ["lwa4p", "scara"])
def test_a_drawn_motion_stays_within_limits_and_leaves_a_fifth_of_the_torque(
    name: str, time: float
) -> None:
    robot = mr.load_robot(name)
    truth = true_robot(robot, "upper").parameters
    drawn = draw_motion(robot, truth, time, 5)
    q, dq, ddq = drawn.trajectory.sample(np.linspace(0.0, time + REST, 400))
    lo, hi = robot.position_limits.T
    assert ((lo <= q) & (q <= hi)).all()
    assert (np.abs(dq) <= 0.5 * robot.velocity_limits + 1e-12).all()
    assert np.abs(dq).max() <= 1.5 + 1e-12
    assert np.abs(dq).max() > 0.01
    tau = [mr.inverse_dynamics(robot, *state, truth) for state in zip(q, dq, dq, ddq, strict=True)]
    # Looked at in 17 places when it was drawn, here in 400.
    assert (np.abs(tau) <= 0.85 * robot.effort_limits).all()
    assert drawn.feasible
    again = draw_motion(robot, truth, time, 5).trajectory
    assert np.array_equal(again.points, drawn.trajectory.points)


def test_a_motion_that_needs_too_much_torque_is_drawn_again() -> None:
    robot = mr.load_robot("lwa4p")
    truth = true_robot(robot, "upper").parameters
    first = draw_motion(robot, truth, 1.0, 5)
    limits = robot.effort_limits * first.need / 0.9
    again = draw_motion(replace(robot, effort_limits=limits), truth, 1.0, 5)
    assert again.feasible
    assert not np.array_equal(again.trajectory.points, first.trajectory.points)
    hopeless = draw_motion(replace(robot, effort_limits=0.01 * limits), truth, 1.0, 5)
    assert not hopeless.feasible
