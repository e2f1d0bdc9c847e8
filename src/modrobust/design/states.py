"""Where a robot is looked at: seeded configurations, and states along a motion or of any motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.model import Parameters, Robot
from modrobust.motion import Trajectory
from modrobust.motion.trajectory import (
    DEFAULT_DURATION,
    QUINTIC_PEAK_ACCELERATION,
    QUINTIC_PEAK_RATE,
)

CONFIGURATIONS = 24
INSTANTS = 32
_SEED = 20281128
_TORQUE = 0.8  # of the limits: what a motion may need at the centre of the box
_SLOWER = 0.85
_TRIES = 24
_MOVE = 1.0  # [s]: the shortest move from rest to rest that is reckoned with


@dataclass(frozen=True)
class MotionStates:
    """Where the robot is looked at: k states of a motion."""

    q: Array
    """``(k, n)`` [rad] or [m]."""
    dq: Array
    """``(k, n)`` [rad/s] or [m/s]."""
    ddq: Array
    """``(k, n)`` [rad/s^2] or [m/s^2]."""
    of: str
    """What they are of, for the output."""

    @property
    def pace(self) -> float:
        """How fast the motion changes: the root of sum ddq^2 over sum dq^2 [rad/s]; 0 at rest."""
        speed = float(np.sqrt((self.dq**2).sum()))
        return float(np.sqrt((self.ddq**2).sum())) / speed if speed > 0.0 else 0.0

    def at_speed(self, factor: float) -> MotionStates:
        """The same path at another speed."""
        return MotionStates(self.q, factor * self.dq, factor**2 * self.ddq, self.of)


def position_range(robot: Robot) -> tuple[Array, Array]:
    """Ends (n,), (n,) [rad] or [m] of the middle 80 % of what each joint may reach.

    A joint without limits is taken within a turn, or +-0.25 m; one with a single limit within half
    a turn, or 0.5 m, of it.
    """
    lo, hi = robot.position_limits.T
    turns = robot.free_turns
    half = np.where(turns, math.pi, 0.25)  # [rad], [m]
    span = np.where(turns, math.pi, 0.5)
    known_lo, known_hi = np.isfinite(lo), np.isfinite(hi)
    low = np.where(known_lo, lo, np.where(known_hi, hi - span, -half))
    high = np.where(known_hi, hi, np.where(known_lo, lo + span, half))
    low, high = (
        np.where(turns & (high > -math.pi), np.maximum(low, -math.pi), low),
        np.where(turns & (low < math.pi), np.minimum(high, math.pi), high),
    )
    width = high - low
    return low + 0.1 * width, high - 0.1 * width


def configurations(robot: Robot, count: int = CONFIGURATIONS) -> Array:
    """Seeded positions ``(count, n)`` [rad] or [m] inside `position_range`, ever the same."""
    lo, hi = position_range(robot)
    drawn = np.random.default_rng(_SEED).random((count, robot.n))
    return np.asarray(lo + drawn * (hi - lo))


def states_along(motion: Trajectory) -> MotionStates:
    """`INSTANTS` states, evenly spaced in time over the motion."""
    duration = motion.duration or DEFAULT_DURATION
    q, dq, ddq = motion.sample(np.linspace(0.0, duration, INSTANTS))
    return MotionStates(q, dq, ddq, f"the motion given, {duration:g} s")


def states_of_any_motion(robot: Robot, central: Parameters) -> MotionStates:
    r"""Seeded states inside the limits: positions of `configurations`, any speed, any acceleration.

    .. math:: |\dot q| \le \dot q_{max},\quad
              |\ddot q| \le \min(\ddot q_{max},\; 5.77 / 1.875 \; \dot q_{max} / 1\,\mathrm{s})

    the acceleration of a quintic from rest to rest in one second that reaches the speed. Without a
    speed limit, 1 rad/s or 0.2 m/s. A state whose torque at the centre of the box is beyond 80 %
    of a limit is slowed down until it is not.
    """
    q = configurations(robot)
    turns = robot.free_turns
    usual = np.where(turns, 1.0, 0.2)  # [rad/s], [m/s]
    speed = np.where(np.isfinite(robot.velocity_limits), robot.velocity_limits, usual)
    quick = speed * (QUINTIC_PEAK_ACCELERATION / QUINTIC_PEAK_RATE) / _MOVE
    rng = np.random.default_rng(_SEED + 1)
    dq = (2.0 * rng.random(q.shape) - 1.0) * speed
    ddq = (2.0 * rng.random(q.shape) - 1.0) * np.minimum(quick, robot.acceleration_limits)
    limit = _TORQUE * robot.effort_limits
    for k in range(len(q)):
        for _ in range(_TRIES):
            tau = _kernel.inverse_dynamics(
                robot.model, central.packed, q[k], dq[k], dq[k], ddq[k], True
            )
            if (np.abs(tau) <= limit).all():
                break
            dq[k] *= _SLOWER
            ddq[k] *= _SLOWER**2
    return MotionStates(q, dq, ddq, "any motion within the joint and velocity limits")
