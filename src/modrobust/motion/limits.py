"""What a robot's limits and a motion's end allow: checks made before anything runs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from modrobust.checks.types import Array
from modrobust.errors import ValueRangeError
from modrobust.model import Robot
from modrobust.motion.trajectory import Splined, Trajectory

_STILL = 1e-3  # [rad/s] or [m/s]: recordings come to rest to this


def check_limits(robot: Robot, trajectory: Trajectory, duration: float) -> None:
    """Refuse a motion that leaves the robot's limits within ``duration`` [s].

    Position, velocity and acceleration are looked at every millisecond (at least 1000 times, at
    most a million).

    Raises:
        ValueRangeError: Names the joint, its largest excess, the limit and the time.
    """
    count = int(min(max(math.ceil(duration * 1e3), 1000), 1_000_000)) + 1
    for chunk in np.array_split(np.linspace(0.0, duration, count), math.ceil(count / 50_000)):
        for value, kind in zip(trajectory.sample(chunk), _KINDS, strict=True):
            lo, hi = kind.limits(robot)
            found = _largest_excess(value, lo, hi)
            if found is not None:
                k, j = found
                where = f" at t = {chunk[k]:.6g} s"
                raise _refusal(robot, "trajectory", j, value[k, j], kind, where, kind.remedy)


def check_start(robot: Robot, q: tuple[str, Array], dq: tuple[str, Array]) -> None:
    """Refuse a state at the start that is outside the robot's limits.

    Args:
        robot: The robot.
        q: What the caller knows the positions as; positions ``(n,)`` [rad] or [m].
        dq: The same of the velocities, ``(n,)`` [rad/s] or [m/s].

    Raises:
        ValueRangeError: Names the joint and its limits.
    """
    for (name, value), kind in zip((q, dq), _KINDS[:2], strict=True):
        found = _largest_excess(value[None], *kind.limits(robot))
        if found is not None:
            j = found[1]
            raise _refusal(robot, name, j, value[j], kind, "", "start within its limits")


@dataclass(frozen=True)
class _Kind:
    """What is limited, and how a message speaks of it."""

    name: str
    verb: str
    per: str
    remedy: str

    def limits(self, robot: Robot) -> tuple[Array, Array]:
        """Lower and upper limits (n,), infinite where there are none."""
        if self.name == "position":
            return robot.position_limits[:, 0], robot.position_limits[:, 1]
        limit = robot.velocity_limits if self.name == "velocity" else robot.acceleration_limits
        return -limit, limit


_KINDS = (
    _Kind("position", "is at", "", "make the motion smaller"),
    _Kind("velocity", "moves at", "/s", "slow the motion down"),
    _Kind("acceleration", "accelerates at", "/s^2", "slow the motion down"),
)


def _largest_excess(value: Array, lo: Array, hi: Array) -> tuple[int, int] | None:
    """Row and joint of the largest excess of the first joint that leaves its limits; value (k, n).

    A motion up to the limit itself is fine, whatever rounding and spline make of it.
    """
    limits = np.stack([lo, hi])
    scale = np.max(np.where(np.isfinite(limits), np.abs(limits), 0.0), axis=0)
    excess = np.maximum(lo - value, value - hi)
    over = excess > 1e-6 * scale
    if not over.any():
        return None
    j = int(np.flatnonzero(over[int(np.argmax(over.any(axis=1)))])[0])
    return int(np.argmax(excess[:, j])), j


def _refusal(
    robot: Robot, name: str, j: int, value: float, kind: _Kind, where: str, remedy: str
) -> ValueRangeError:
    unit = ("rad" if robot.free_turns[j] else "m") + kind.per
    lo, hi = kind.limits(robot)
    return ValueRangeError(
        f'{name}: joint "{robot.joint_names[j]}" {kind.verb} {value:.6g} {unit}{where}; its '
        f"{kind.name} must stay in [{lo[j]:.6g}, {hi[j]:.6g}] {unit}; {remedy}"
    )


def motion_remarks(robot: Robot, trajectory: Trajectory, duration: float) -> list[str]:
    """What a splined motion was made into or ends with that its file does not say.

    Args:
        robot: The robot.
        trajectory: Its motion.
        duration: Of the run [s].
    """
    if not isinstance(trajectory, Splined):
        return []
    said = [
        f'joint "{name}" is continuous: {count} jump{"s" * (count > 1)} by a whole turn between '
        "rows of the motion left out, so that it goes on"
        for name, count in zip(robot.joint_names, trajectory.unwrapped, strict=False)
        if count
    ]
    end = trajectory.times[-1]
    speed = np.abs(trajectory.sample([end])[1][0])
    j = int(np.argmax(speed))
    if duration > end and speed[j] > _STILL:
        unit = "rad" if robot.free_turns[j] else "m"
        said.append(
            f'the motion is under way at its last row, t = {end:g} s (joint "'
            f'{robot.joint_names[j]}" at {speed[j]:.3g} {unit}/s), and is held from there: the '
            "desired speed jumps; add rows that bring it to rest"
        )
    return said


def check_duration(duration: float, trajectory: Trajectory | None = None) -> None:
    """Refuse a duration [s] that is not positive and finite, or beyond the motion's end."""
    if not (math.isfinite(duration) and duration > 0.0):
        raise ValueRangeError(
            f"duration: {duration:g} s; must be positive and finite; such as 10 s"
        )
    if trajectory is not None and duration > trajectory.end * (1.0 + 1e-12):
        raise ValueRangeError(
            f"duration: {duration:g} s is longer than the motion, which ends at "
            f"{trajectory.end:g} s; shorten it or add rows"
        )
