"""Joints that turn endlessly: the error of (4) less whole turns, and the loop across the seam."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.errors import ValueRangeError
from modrobust.model import MimicJoints, Robot, synthetic_chain
from modrobust.motion import Quintic, Splined, make_trajectory

TURN = 2.0 * np.pi
# Fifty decimals of 2 pi, so that what is tested is not tested by itself.
EXACT_TURN = Fraction("6.28318530717958647692528676655900576839433879875021")
U = Fraction(1, 2**53)


def endless(n: int = 2, kinds: tuple[str, ...] = ("continuous", "revolute")) -> Robot:
    """A chain whose joints are of these kinds, without limits."""
    robot = synthetic_chain(n, uncertainty=0.1)
    free = np.tile([-np.inf, np.inf], (n, 1))
    return replace(robot, joint_types=kinds, position_limits=free)


def error(robot: Robot, q: Any, q_des: Any) -> Any:
    return robot.tracking_error(np.array(q, dtype=float), np.array(q_des, dtype=float))


def test_a_measured_turn_is_no_error_for_a_continuous_joint_and_one_for_a_revolute_one() -> None:
    """Measured 2 pi - 0.001 against desired 0: the way on is 0.001, not back by a turn."""
    robot = endless()
    e = error(robot, [TURN - 0.001, TURN - 0.001], [0.0, 0.0])
    assert e[0] == pytest.approx(0.001, abs=1e-15)
    assert e[1] == -(TURN - 0.001)
    controller, zero = mr.RobustController(robot), np.zeros(2)
    near = controller.torque([-0.001, 0.0], zero, zero, zero, zero)
    round_about = controller.torque([TURN - 0.001, 0.0], zero, zero, zero, zero)
    np.testing.assert_allclose(round_about.tau, near.tau, atol=1e-11)
    assert round_about.integral_rate == near.integral_rate == 0.0  # inside epsilon
    limited = controller.torque([0.0, TURN - 0.001], zero, zero, zero, zero)
    assert limited.tau[1] < -50.0  # [N m]


def test_the_error_is_the_real_one_to_its_stated_rounding() -> None:
    """Near no turn and many, near 0 and half a turn: within u (|e| + k 2^-27) of the exact one."""
    robot, rng = endless(1, ("continuous",)), np.random.default_rng(0)
    worst = Fraction(0)
    for _ in range(4000):
        k = int(rng.choice([0, 1, -1, 2, 1000, -31830, int(rng.integers(-31000, 31000))]))
        e = float(rng.choice([0.0, 1e-300, 1e-17, 1e-9, 1e-3, 1.0, np.pi, np.pi - 1e-15]))
        e *= rng.choice([-1.0, 1.0]) * (1.0 + rng.normal() * rng.choice([0.0, 1e-16, 1e-3]))
        at = rng.uniform(-1.0, 1.0) * rng.choice([1e-10, 1.0, 1e3])
        side = rng.random() < 0.5
        q, q_des = (at, at + TURN * k + e) if side else (at - TURN * k - e, at)
        if max(abs(q), abs(q_des)) > 1e5:
            continue
        found = float(error(robot, [q], [q_des])[0])
        difference = Fraction(q_des) - Fraction(q)
        turns = round((difference - Fraction(found)) / EXACT_TURN)
        exact = difference - turns * EXACT_TURN
        allowed = U * (abs(Fraction(found)) + Fraction(abs(turns), 2**27))
        assert abs(Fraction(found) - exact) <= allowed, (q, q_des)
        assert abs(found) <= np.pi
        if turns == 0:
            assert found == q_des - q
        elif allowed:
            worst = max(worst, abs(Fraction(found) - exact) / allowed)
    assert 0.1 < float(worst) < 1.0  # the bound is used, and not by luck


@pytest.mark.parametrize("k", [0, 1, -1, 17, -15915])
def test_next_to_half_a_turn_no_error_is_beyond_it(k: int) -> None:
    robot = endless(1, ("continuous",))
    middle = TURN * k + np.pi
    for steps in range(-40, 41):
        q_des = middle + steps * np.spacing(abs(middle))
        found = float(error(robot, [0.0], [q_des])[0])
        assert abs(found) <= np.pi
        assert abs(abs(found) - np.pi) < 100 * np.spacing(abs(middle) + np.pi)


def test_a_plain_robot_has_the_bits_of_the_plain_difference() -> None:
    """And a continuous joint those of a revolute one, as long as no turn is taken off."""
    plain, wrapping = endless(2, ("revolute",) * 2), endless(2, ("continuous",) * 2)
    rng = np.random.default_rng(1)
    for _ in range(50):
        q, dq, dq_des, ddq_des = rng.normal(size=(4, 2))
        args = q, dq, q + rng.uniform(-3.1, 3.1, 2), dq_des, ddq_des
        one, other = (mr.RobustController(robot).torque(*args) for robot in (plain, wrapping))
        for name in ("tau", "nominal", "phi_lo", "phi_hi"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes(), name
        assert one.integral_rate == other.integral_rate


def test_the_integral_grows_by_the_error_less_whole_turns() -> None:
    controller, zero = mr.RobustController(endless()), np.zeros(2)
    answer = controller.torque([TURN + 0.1, 0.2], zero, zero, zero, zero)
    assert answer.integral_rate == pytest.approx(np.hypot(0.1, 0.2), rel=1e-12)


def test_angles_beyond_what_can_be_reduced_are_refused_where_they_wrap() -> None:
    controller, zero = mr.RobustController(endless()), np.zeros(2)
    with pytest.raises(ValueRangeError, match=r"^q_des\[0\] = 100001: a joint angle is beyond"):
        controller.command(0.0, zero, zero, [100001.0, 0.0], zero, zero)
    controller.command(0.0, zero, zero, [0.0, 100001.0], zero, zero)  # no angle to be reduced
    with pytest.raises(ValueRangeError, match=r"^q\[0\] = 100001: a joint angle is beyond"):
        controller.command(0.0, [100001.0, 0.0], zero, zero, zero, zero)
    with pytest.raises(_kernel.KernelError):
        _kernel.tracking_error(endless().model, np.array([[0.0, 0.0]]), np.array([[2e5, 0.0]]))


def test_a_continuous_joint_has_no_position_limits() -> None:
    with pytest.raises(
        ValueRangeError, match=r'joint "link1.axis" is continuous and has \[-1, 1\]'
    ):
        replace(endless(), position_limits=np.array([[-1.0, 1.0], [-np.inf, np.inf]]))


def mimicked(kind: str, multiplier: float) -> Robot:
    """A continuous joint that another one mimics."""
    robot = endless(3, ("continuous", "revolute", kind))
    return replace(
        robot,
        joint_names=robot.joint_names[:2],
        position_limits=robot.position_limits[:2],
        velocity_limits=robot.velocity_limits[:2],
        effort_limits=robot.effort_limits[:2],
        acceleration_limits=robot.acceleration_limits[:2],
        disturbance=replace(
            robot.disturbance,
            nominal=robot.disturbance.nominal[:2],
            lo=robot.disturbance.lo[:2],
            hi=robot.disturbance.hi[:2],
        ),
        controller=replace(robot.controller, K_r=robot.controller.K_r[:2]),
        mimic=MimicJoints(
            ("mimic",), np.zeros(1, np.int32), np.array([multiplier]), np.array([0.3])
        ),
    )


@pytest.mark.parametrize(
    ("kind", "multiplier", "wraps"),
    [
        ("revolute", -2.0, True),
        ("continuous", 1.0, True),
        ("revolute", 0.5, False),
        ("prismatic", 1.0, False),
    ],
)
def test_a_joint_wraps_only_where_a_turn_brings_its_mimic_joints_back(
    kind: str, multiplier: float, wraps: bool
) -> None:
    robot = mimicked(kind, multiplier)
    assert robot.wraps.tolist() == [wraps, False]
    assert robot.to_dict()["joints"][0]["type"] == "continuous"
    e = error(robot, [TURN, 0.0], [0.0, 0.0])
    assert e[0] == pytest.approx(0.0 if wraps else -TURN, abs=1e-15)


def seam(robot: Robot) -> Quintic:
    """Most of a turn in 0.6 s, as an unwrapped motion."""
    return Quintic(np.array([0.0, 0.6]), np.array([[0.0, 0.0], [0.75 * TURN, 0.5]]))


class Wrapped(Quintic):
    """The same, kept within one turn as an encoder would have it."""

    def sample(self, t: Any) -> Any:
        q, dq, ddq = super().sample(t)
        q[:, 0] = (q[:, 0] + np.pi) % TURN - np.pi
        return q, dq, ddq


@pytest.mark.parametrize("plant", ["builtin", "mujoco", "pinocchio"])
def test_the_closed_loop_goes_over_the_seam_as_if_it_were_not_there(plant: str) -> None:
    if plant != "builtin":
        pytest.importorskip({"mujoco": "mujoco", "pinocchio": "pinocchio"}[plant])
    robot = endless()
    rate = 2e4 if plant == "builtin" else 3e3
    motion = seam(robot)
    options: dict[str, Any] = {"rate": rate, "seed": 1, "plant": plant}
    plain = mr.simulate(robot, trajectory=motion, **options)
    jumping = mr.simulate(robot, trajectory=Wrapped(motion.times, motion.points), **options)
    assert np.abs(np.diff(jumping.q_des[:, 0])).max() > 6.0  # it does jump
    assert jumping.ok, jumping.reasons
    assert jumping.error.max() < 0.01
    np.testing.assert_allclose(jumping.q, plain.q, atol=1e-8)
    np.testing.assert_allclose(jumping.tau, plain.tau, atol=1e-5)
    assert jumping.summary()["error_final"] == pytest.approx(jumping.error[-1], abs=1e-12)
    if plant != "builtin":
        return
    lost = mr.simulate(
        replace(robot, joint_types=("revolute", "revolute")),
        trajectory=Wrapped(motion.times, motion.points),
        **options,
    )
    assert not lost.ok  # a cable does not jump back
    assert lost.summary()["violations"] == 0


def test_a_start_a_turn_off_is_no_error() -> None:
    robot = endless()
    still = Quintic(np.array([0.0]), np.zeros((1, 2)))
    run = mr.simulate(robot, trajectory=still, q0=[3 * TURN + 0.02, 0.0], duration=0.5)
    assert run.error[0] == pytest.approx(0.02, abs=1e-12)
    assert run.q[-1, 0] == pytest.approx(3 * TURN, abs=0.01)
    assert run.ok


def test_a_recording_over_the_seam_is_splined_as_it_went(tmp_path: Any) -> None:
    t = np.linspace(0.0, 1.0, 41)
    angle = 3.0 + 0.5 * np.sin(t) + t
    rows = np.stack([t, (angle + np.pi) % TURN - np.pi, (angle + np.pi) % TURN - np.pi], axis=1)
    file = tmp_path / "seam.csv"
    np.savetxt(file, rows, delimiter=",", fmt="%.17g")
    motion = make_trajectory(endless(), str(file))
    assert isinstance(motion, Splined)
    at = np.linspace(0.0, 1.0, 500)
    q, dq, _ = motion.sample(at)
    np.testing.assert_allclose(q[:, 0], 3.0 + 0.5 * np.sin(at) + at, atol=1e-7)
    assert np.abs(dq[:, 0]).max() < 2.0
    assert np.abs(dq[:, 1]).max() > 100.0  # of the joint that does not wrap, as written
    run = mr.simulate(endless(), trajectory=str(file), duration=0.01, q0=motion.sample([0.0])[0][0])
    assert (
        'joint "link1.axis" is continuous: 1 jump by a whole turn between rows of the motion left '
        "out, so that it goes on"
    ) in run.remarks
    slow = Splined(np.array([0.0, 4.0]), np.array([[0.0, 0.0], [4.0, 4.0]]))
    assert slow.sample([4.0])[0][0, 0] == 4.0  # points given in Python are what they are


def test_a_step_that_is_no_turn_stays_and_rest_to_rest_is_left_alone(tmp_path: Any) -> None:
    file = tmp_path / "m.csv"
    file.write_text("0,0,0\n1,4,4\n2,-2.5,0\n")
    motion = make_trajectory(endless(), str(file))
    assert isinstance(motion, Splined)
    np.testing.assert_allclose(motion.points[:, 0], [0.0, 4.0, -2.5 + TURN])
    np.testing.assert_array_equal(motion.points[:, 1], [0.0, 4.0, 0.0])
    rest = make_trajectory(endless(), f"quintic:{file}")
    assert isinstance(rest, Quintic)
    np.testing.assert_array_equal(rest.points[:, 0], [0.0, 4.0, -2.5])
