"""What a robot's limits and a motion's end allow: checks made before anything runs."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from modrobust.errors import ValueRangeError
from modrobust.robot import Robot
from modrobust.trajectory import Trajectory

Array = NDArray[np.float64]


def check_limits(robot: Robot, trajectory: Trajectory, duration: float) -> None:
    """Refuse a motion that leaves the robot's position or velocity limits within ``duration`` [s].

    The motion is looked at every millisecond (at least 1000 times, at most a million).

    Raises:
        ValueRangeError: Names the joint, its largest excess, the limit and the time.
    """
    count = int(min(max(math.ceil(duration * 1e3), 1000), 1_000_000)) + 1
    for chunk in np.array_split(np.linspace(0.0, duration, count), math.ceil(count / 50_000)):
        q, dq, _ = trajectory.sample(chunk)
        lo, hi = robot.position_limits.T
        _refuse(robot, chunk, q, np.maximum(lo - q, q - hi), (lo, hi), "position")
        limit = robot.velocity_limits
        _refuse(robot, chunk, dq, np.abs(dq) - limit, (-limit, limit), "velocity")


def _refuse(
    robot: Robot, t: Array, value: Array, excess: Array, limits: tuple[Array, Array], what: str
) -> None:
    # A motion up to the limit itself is fine, whatever rounding and spline make of it.
    scale = np.max(np.where(np.isfinite(limits), np.abs(limits), 0.0), axis=0)
    over = excess > 1e-6 * scale
    if not over.any():
        return
    j = int(np.flatnonzero(over[int(np.argmax(over.any(axis=1)))])[0])
    k = int(np.argmax(excess[:, j]))
    unit = "rad" if robot.joint_types[j] == "revolute" else "m"
    verb = "is at"
    if what == "velocity":
        unit += "/s"
        verb = "moves at"
    remedy = "slow the motion down" if what == "velocity" else "make the motion smaller"
    raise ValueRangeError(
        f'trajectory: joint "{robot.joint_names[j]}" {verb} {value[k, j]:.6g} {unit} at '
        f"t = {t[k]:.6g} s; its {what} must stay in "
        f"[{limits[0][j]:.6g}, {limits[1][j]:.6g}] {unit}; {remedy}"
    )


def check_duration(duration: float, trajectory: Trajectory | None = None) -> None:
    """Refuse a duration [s] that is not positive and finite, or beyond the motion's end."""
    if not (math.isfinite(duration) and duration > 0.0):
        raise ValueRangeError(f"duration: {duration:g} s; must be positive and finite")
    if trajectory is not None and duration > trajectory.end * (1.0 + 1e-12):
        raise ValueRangeError(
            f"duration: {duration:g} s is longer than the motion, which ends at "
            f"{trajectory.end:g} s; shorten it or add rows"
        )
