r"""Motions of a campaign: drawn from rest to rest, as fast as half of the limits allow.

.. math:: |q_1 - q_0| \le \tfrac12 T_m \min(v_{max}, 3)\,/\,1.875

in each joint [rad/s], with half of the limit of accelerations as well where there is one; 3 rad/s
stand for what is faster or without limits (1 rad/s, 0.2 m/s where there is none). A motion is drawn
again, from the fourth time on ever shorter, until the torques that the true robot needs on it are
at most 80 % of their limits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modrobust.checks.types import Array
from modrobust.design.states import position_range
from modrobust.dynamics import inverse_dynamics
from modrobust.model import Parameters, Robot
from modrobust.motion import Quintic
from modrobust.motion.trajectory import QUINTIC_PEAK_ACCELERATION, QUINTIC_PEAK_RATE

TIMES = {"short": 1.0, "long": 10.0}  # [s], from rest to rest
REST = 0.25  # [s], after the motion
LATE = 0.45  # [s], from which errors of a motion of 1 s count
LATE_OF_OTHERS = 1.0  # [s]
_FASTEST = 3.0  # [rad/s] or [m/s], before halving
_UNKNOWN = 1.0, 0.2  # [rad/s], [m/s] where there is no limit
_SHARE = 0.8  # of the torque limits
_TRIES = 60
_SHORTER_EVERY, _SHORTER = 3, 0.85
_INSTANTS = 17


@dataclass(frozen=True, eq=False)
class DrawnMotion:
    """A motion, and whether the true robot has the torque for it.

    Args:
        trajectory: From rest to rest.
        need: Largest torque on it over its limit [1], without disturbance and error.
    """

    trajectory: Quintic
    need: float

    @property
    def feasible(self) -> bool:
        """Whether 80 % of the torque limits suffice."""
        return self.need <= _SHARE


def draw_motion(robot: Robot, truth: Parameters, time: float, seed: int) -> DrawnMotion:
    """A motion of `time` [s] for a robot whose true parameters are known.

    Where no draw leaves the torques within 80 % of their limits, the one that needs least.
    """
    rng = np.random.default_rng([seed, 2])
    lo, hi = position_range(robot)
    longest = _longest(robot, time)
    best: DrawnMotion | None = None
    for attempt in range(_TRIES):
        start = rng.uniform(lo, hi)
        step = np.clip(rng.uniform(lo, hi) - start, -longest, longest)
        end = start + step * _SHORTER ** (attempt // _SHORTER_EVERY)
        motion = Quintic(np.array([0.0, time]), np.array([start, end]), time + REST)
        found = DrawnMotion(motion, _need(robot, truth, motion, time))
        if best is None or found.need < best.need:
            best = found
        if best.feasible:
            break
    assert best is not None
    return best


def _longest(robot: Robot, time: float) -> Array:
    """Largest step of each joint (n,) [rad] or [m]."""
    unknown = np.where(robot.free_turns, *_UNKNOWN)
    limit = robot.velocity_limits
    speed = 0.5 * np.where(np.isfinite(limit), np.minimum(limit, _FASTEST), unknown)
    return np.minimum(
        speed * time / QUINTIC_PEAK_RATE,
        0.5 * robot.acceleration_limits * time**2 / QUINTIC_PEAK_ACCELERATION,
    )


def _need(robot: Robot, truth: Parameters, motion: Quintic, time: float) -> float:
    """Largest torque along a motion over its limit."""
    states = zip(*motion.sample(np.linspace(0.0, time, _INSTANTS)), strict=True)
    torques = [inverse_dynamics(robot, q, dq, dq, ddq, truth) for q, dq, ddq in states]
    return float((np.abs(torques).max(axis=0) / robot.effort_limits).max())
