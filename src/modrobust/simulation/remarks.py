"""What a run did that its verdict does not judge: torques that chatter, motion beyond limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from modrobust.checks.types import Array
from modrobust.model import Robot
from modrobust.simulation.metrics import CHATTERING_LIMIT

_TOUCH = 1e-6  # of the limit: a motion up to the limit itself is fine


def remarks(
    robot: Robot, duration: float, t: Array, q: Array, dq: Array, noisy: Array | None
) -> list[str]:
    """One sentence each; empty where there is nothing to say.

    Args:
        robot: Robot with n joints.
        duration: Of the run [s].
        t: Logged instants (m,) [s].
        q: Positions (m, n) [rad] or [m].
        dq: Velocities (m, n) [rad/s] or [m/s].
        noisy: See `modrobust.simulation.metrics.chattering`.
    """
    said = [*_chattering(robot, noisy)]
    lo, hi = robot.position_limits.T
    said += _overruns(robot, t, q, lo, hi, "position")
    limit = robot.velocity_limits
    said += _overruns(robot, t, dq, -limit, limit, "velocity")
    own = robot.trajectory
    if own is not None and own.times and own.duration == duration < own.times[-1]:
        said.append(
            f"the motion of the file has its last point at {own.times[-1]:g} s, after its "
            f"duration of {duration:g} s; raise the duration"
        )
    return said


def _chattering(robot: Robot, noisy: Array | None) -> Iterator[str]:
    if noisy is None or not len(noisy):
        return
    worst = int(np.argmax(np.nan_to_num(noisy, nan=np.inf)))
    if noisy[worst] <= CHATTERING_LIMIT:
        return
    times = f"{noisy[worst]:.3g} times" if np.isfinite(noisy[worst]) else "beyond all measure of"
    yield (
        f'the torque chatters, joint "{robot.joint_names[worst]}" most, {times} the variation of '
        f"the same signal at 10 Hz (limit {CHATTERING_LIMIT:g}); raise phi_P, lower kappa_P"
    )


def _overruns(
    robot: Robot, t: Array, value: Array, lo: Array, hi: Array, what: str
) -> Iterator[str]:
    if not len(t):
        return
    excess: Any = np.maximum(lo - value, value - hi)
    for j, name in enumerate(robot.joint_names):
        k = int(np.argmax(np.nan_to_num(excess[:, j], nan=-np.inf)))
        limit = lo[j] if value[k, j] < lo[j] else hi[j]
        if not excess[k, j] > _TOUCH * abs(limit):
            continue
        unit = "rad" if robot.free_turns[j] else "m"
        if what == "velocity":
            unit += "/s"
        yield (
            f'joint "{name}" went {excess[k, j]:.3g} {unit} beyond its {what} limit of '
            f"{limit:.6g} {unit}, at t = {t[k]:.4g} s"
        )


__all__ = ["remarks"]
