"""Containment where random draws seldom come: each case built to strain one step of the proof."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from modrobust.control import RobustController
from modrobust.model import Bounded, Robot
from support.containment.ball_comparison import Outcome, check_state
from support.containment.extreme_states import Signals
from support.containment.parameter_boxes import make_robot, skewed
from support.containment.written_robots import Written, random_written
from support.random_robots import point_robot, random_robot, random_state, tied

QUARTER = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])  # Rx(pi/2)


def check(robot: Robot, signals: Signals, written: Written | None = None, **how: Any) -> Outcome:
    outcome = check_state(robot, signals, np.random.default_rng(0), "built", written, **how)
    assert outcome.cases
    assert not outcome.violations, "\n".join(outcome.violations[:10])
    return outcome


def free(q: Any, dq: Any, dq_a: Any, ddq_a: Any, K_r: Any) -> Signals:
    """Signals for which (4) gives dq_a, and ddq_a but for one rounding."""
    return Signals(q, dq, q, dq_a, ddq_a - np.array(K_r) * (dq_a - dq))


def small(robot: Robot, size: float) -> Robot:
    """The robot shrunk: lengths by `size`, inertias by its square."""
    frames = {}
    for name in ("before", "after", "placement"):
        frames[name] = getattr(robot, name).copy()
        frames[name][:, :3, 3] *= size
    points = {
        name: replace(point, com=point.com * size, inertia=point.inertia * size**2)
        for name in ("nominal", "lower", "upper")
        if (point := getattr(robot, name))
    }
    return replace(robot, gravity=np.zeros(3), **frames, **points)


@pytest.mark.parametrize("far", [1e3, 1e6])
def test_a_small_arm_far_from_its_base_frame(far: float) -> None:
    rng = np.random.default_rng(5)
    robot = small(random_robot(rng, n=3, types="rrr", drives=False), 1e-3)
    before = robot.before.copy()
    before[0, :3, 3] = far, far / 3, -far / 7
    robot = replace(robot, before=before)
    for _ in range(5):
        state = random_state(rng, 3, 0.3)
        check(robot, free(*state, robot.controller.K_r))


@pytest.mark.parametrize("dq_a", [1e10, 1e25, 1e100])
def test_a_product_that_underflows_before_its_last_factor(dq_a: float) -> None:
    inertia = 1e-11 * (np.ones((3, 3)) + 20 * np.eye(3))
    robot = point_robot(
        "rr",
        after=[QUARTER, QUARTER],
        mass=[1.0, 1.0],
        com=np.zeros((2, 3)),
        inertia=[inertia, inertia],
    )
    robot = replace(robot, gravity=np.zeros(3))
    dq = np.array([3e-311, 0.0])
    state = (np.array([0.1, 0.2]), dq, np.array([dq_a, 0.0]), np.zeros(2))
    check(robot, free(*state, robot.controller.K_r))


def test_signals_whose_reference_acceleration_cancels() -> None:
    rng = np.random.default_rng(3)
    robot = random_robot(rng, n=3, types="rrr", width="narrow", drives=False)
    robot = replace(robot, gravity=np.zeros(3))
    q, dq = np.array([0.3, 0.2, -0.4]), np.array([3.3, -2.9, 3.3])
    K_r = np.array(robot.controller.K_r)
    signals = Signals(q, dq, q, np.zeros(3), K_r * dq * (1 + 1e-14))
    check(robot, signals, as_given=True)


@pytest.mark.parametrize("ratio", [1e-160, 3e-161, 1e-162])
def test_a_gear_ratio_whose_square_underflows(ratio: float) -> None:
    robot = point_robot(
        "r", after=[QUARTER], mass=[1e-60], com=np.zeros((1, 3)), inertia=[1e-60 * np.eye(3)]
    )
    point = replace(robot.nominal, rotor_inertia=np.array([1e308]))
    robot = replace(
        robot,
        gravity=np.zeros(3),
        gear_ratio=np.array([ratio]),
        nominal=point,
        lower=replace(point, rotor_inertia=np.array([0.5e308])),
        upper=replace(point, rotor_inertia=np.array([1.5e308])),
    )
    zero = np.zeros(1)
    check(robot, Signals(zero, zero, zero, zero, np.ones(1)))


@pytest.mark.parametrize("seed", range(6))
def test_a_mimic_joint_that_turns_many_times(seed: int) -> None:
    rng = np.random.default_rng(seed)
    written = replace(
        random_written(rng, 3, 2),
        prismatic=[False] * 5,
        multiplier=[Fraction(7, 10), Fraction(-131, 100)],
    )
    robot = make_robot(rng, written)
    q = rng.uniform(-7e4, 7e4, 3)
    dq, dq_a, ddq_a = rng.normal(size=(3, 3))
    signals = free(q, dq, dq_a, ddq_a, robot.controller.K_r)
    check(robot, signals)
    check(robot, signals, written)


@pytest.mark.parametrize("seed", range(4))
def test_rotations_as_far_from_orthonormal_as_a_robot_may_have_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    written = random_written(rng, 6, 0, sparse=True)
    robot = skewed(rng, make_robot(rng, written, sparse=True))
    state = random_state(rng, 6)
    check(robot, free(*state, robot.controller.K_r))


@pytest.mark.parametrize("far", [1e5, 1e12])
def test_a_slide_far_out(far: float) -> None:
    rng = np.random.default_rng(1)
    robot = small(random_robot(rng, types="rprr", drives=False), 0.01)
    q, dq, dq_a, ddq_a = random_state(rng, 4)
    q[1] = far
    check(robot, free(q, dq, dq_a, ddq_a, robot.controller.K_r))


def test_a_chain_of_thirty_with_kilometres_between() -> None:
    rng = np.random.default_rng(2)
    robot = random_robot(rng, n=30, types="r" * 30, simple=True)
    after = robot.after.copy()
    after[:, :3, 3] *= 1e4
    robot = replace(robot, after=after)
    state = random_state(rng, 30, 0.1)
    check(robot, free(*state, robot.controller.K_r))


@pytest.mark.parametrize("moving", range(3))
def test_quadratics_that_are_all_but_singular(moving: int) -> None:
    """Only one joint moves: [s]' L has a null direction, and its sign is a matter of rounding."""
    rng = np.random.default_rng(moving)
    for _ in range(10):
        robot = small(random_robot(rng, n=3, types="rrr", drives=False), 1.0)
        wide = 10.0 ** rng.uniform(-6, 1)
        com = robot.nominal.com
        robot = replace(
            robot,
            lower=replace(robot.lower, com=com - wide),
            upper=replace(robot.upper, com=com + wide),
        )
        q, dq, dq_a, ddq_a = random_state(rng, 3)
        keep = np.arange(3) == moving
        check(robot, free(q, dq * keep, dq_a * keep, ddq_a * keep, robot.controller.K_r))


def test_the_norm_of_rho_is_rounded_up() -> None:
    rng = np.random.default_rng(0)
    before, ctx.prec = ctx.prec, 320
    for n in (1, 3, 7, 20):
        robot = random_robot(rng, n=n)
        for _ in range(20):
            controller = RobustController(robot)
            q, dq, dq_a, ddq_a = random_state(rng, n)
            out = controller.command(0.0, q, dq, q, dq_a, ddq_a)
            ends = np.maximum(np.abs(out.phi_lo), np.abs(out.phi_hi))
            assert np.array_equal(out.rho, ends)
            assert sum(arb(x) ** 2 for x in ends.tolist()) <= arb(out.rho_norm) ** 2
    ctx.prec = before


def test_the_norm_of_rho_is_rounded_up_where_its_squares_underflow() -> None:
    """Else a gain of 0 could answer a perturbation of 1e-170."""
    tensor = 1e-170 * np.eye(3)
    robot = point_robot(
        "rr", after=[QUARTER] * 2, mass=[1e-170] * 2, com=np.zeros((2, 3)), inertia=[tensor] * 2
    )
    lower = replace(robot.nominal, inertia=robot.nominal.inertia * 0.5)
    robot = replace(robot, gravity=np.zeros(3), lower=lower)
    zero = np.zeros(2)
    out = RobustController(robot).command(0.0, zero, zero, zero, zero, np.ones(2))
    assert 0 < out.rho.max() < 1e-160
    assert sum(Fraction(x) ** 2 for x in out.rho.tolist()) <= Fraction(out.rho_norm) ** 2


def test_torques_below_the_smallest_double() -> None:
    mass = 1e-262
    robot = point_robot(
        "r",
        after=[QUARTER],
        mass=[mass],
        com=[[0.3, 0.2, 0.1]],
        inertia=[mass * np.eye(3)],
    )
    robot = replace(robot, gravity=np.zeros(3))
    zero = np.zeros(1)
    check(robot, Signals(zero, zero, zero, zero, np.array([1e-190])))


def test_a_mimic_joints_rate_that_underflows() -> None:
    point = {"mass": [1e-9] * 2, "com": np.zeros((2, 3)), "inertia": [1e-9 * np.eye(3)] * 2}
    free_robot = point_robot("rr", after=[np.eye(4)] * 2, **point)
    robot = tied(replace(free_robot, gravity=np.zeros(3)), 1, np.random.default_rng(0))
    mimic_joints = replace(robot.mimic, multiplier=np.array([1e-5]), offset=np.zeros(1))
    exact = replace(robot.nominal, rotor_inertia=np.array([0.0, 1.0]))
    robot = replace(
        robot,
        mimic=mimic_joints,
        gear_ratio=np.array([0.0, 1e20]),
        nominal=exact,
        lower=exact,
        upper=exact,
    )
    rate = np.array([1e-320])
    check(robot, Signals(np.zeros(1), rate, np.zeros(1), rate, rate))


def test_a_slide_whose_nominal_force_the_disturbance_all_but_cancels() -> None:
    """u0 subtracted to nearest is off by an ulp of u0, which only so small a result shows."""
    rng = np.random.default_rng(0)
    zero = np.zeros(1)
    for _ in range(60):
        mass, ddq = rng.uniform(1, 4, 2)
        robot = point_robot(
            "p", after=[np.eye(4)], mass=[mass], com=np.zeros((1, 3)), inertia=[np.eye(3)]
        )
        light = replace(robot.nominal, mass=np.array([mass * 10.0 ** rng.uniform(-6, -3)]))
        d = np.array([-mass * ddq * (1 + 10.0 ** rng.uniform(-6, -1))])
        robot = replace(robot, gravity=np.zeros(3), lower=light, disturbance=Bounded(d, d, d))
        check(robot, Signals(zero, zero, zero, zero, np.array([ddq])))


def test_friction_that_the_disturbance_all_but_cancels() -> None:
    """The same of a drive's torque, beside a body of next to no weight."""
    rng = np.random.default_rng(0)
    zero = np.zeros(1)
    for _ in range(40):
        viscous, dq = rng.uniform(1, 4, 2)
        robot = point_robot(
            "r", after=[QUARTER], mass=[1e-30], com=np.zeros((1, 3)), inertia=[1e-30 * np.eye(3)]
        )
        point = replace(robot.nominal, viscous=np.array([viscous]))
        light = replace(point, viscous=np.array([viscous * 10.0 ** rng.uniform(-6, -3)]))
        d = np.array([-viscous * dq * (1 + 10.0 ** rng.uniform(-6, -1))])
        robot = replace(
            robot,
            gravity=np.zeros(3),
            gear_ratio=np.zeros(1),
            nominal=point,
            lower=light,
            upper=point,
            disturbance=Bounded(d, d, d),
        )
        check(robot, Signals(zero, np.array([dq]), zero, np.array([dq]), zero))


def test_a_force_all_but_across_the_axis() -> None:
    """A slide turned by some angle: what is left of the force is the error of the turn."""
    rng = np.random.default_rng(0)
    zero = np.zeros(2)
    for _ in range(40):
        alpha = rng.uniform(-3, 3)
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(alpha), -np.sin(alpha)], [np.sin(alpha), np.cos(alpha)]]
        robot = point_robot(
            "pr",
            after=[np.eye(4)] * 2,
            mass=[1e-30, 1.7],
            com=[[0, 0, 0], [0.3, 0, 0]],
            inertia=[1e-30 * np.eye(3)] * 2,
        )
        robot = replace(robot, gravity=np.zeros(3), before=np.array([np.eye(4), QUARTER @ turn]))
        for base in (0, np.pi / 2, np.pi, -np.pi / 2):
            q = np.array([0.0, base - alpha + 10.0 ** rng.uniform(-16, -9)])
            check(robot, Signals(q, zero, q, zero, np.array([0.0, 1.3])))
