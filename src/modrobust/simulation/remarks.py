"""What a run did that its verdict does not judge: torques that chatter, motion beyond limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.design.choice import measured_noise
from modrobust.design.points import central_parameters, light_parameters
from modrobust.model import ControllerSettings, LoopSettings, Robot
from modrobust.simulation.metrics import CHATTERING_LIMIT

_LOOKED_AT = 17  # positions at which noise is judged
_TOUCH = 1e-6  # of the limit: a motion up to the limit itself is fine


def remarks(
    robot: Robot,
    controller: ControllerSettings,
    loop: LoopSettings,
    duration: float,
    t: Array,
    q: Array,
    dq: Array,
    tau: Array,
    noisy: Array | None,
) -> list[str]:
    """One sentence each; empty where there is nothing to say.

    Args:
        robot: Robot with n joints.
        controller: Settings of the run's controller.
        loop: Of its loop.
        duration: Of the run [s].
        t: Logged instants (m,) [s].
        q: Positions (m, n) [rad] or [m].
        dq: Velocities (m, n) [rad/s] or [m/s].
        tau: Torques (m, n) [N m] or [N].
        noisy: See `modrobust.simulation.metrics.chattering`.
    """
    if loop.noisy:
        said = [*_restless(robot, controller, loop, t, q, tau)]
    else:
        said = [*_chattering(robot, controller, noisy)]
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


def _chattering(robot: Robot, controller: ControllerSettings, noisy: Array | None) -> Iterator[str]:
    if noisy is None or not len(noisy):
        return
    worst = int(np.argmax(np.nan_to_num(noisy, nan=np.inf)))
    if noisy[worst] <= CHATTERING_LIMIT:
        return
    times = f"{noisy[worst]:.3g} times" if np.isfinite(noisy[worst]) else "beyond all measure of"
    advice = {
        "norm": "; raise phi_P, lower kappa_P",
        "componentwise": "; raise phi_P, lower kappa_P",
        "sampled": "; lower G",
    }[controller.law]
    yield (
        f'the torque chatters, joint "{robot.joint_names[worst]}" most, {times} the variation of '
        f"the same signal at 10 Hz (limit {CHATTERING_LIMIT:g}){advice}"
    )


def _restless(
    robot: Robot,
    controller: ControllerSettings,
    loop: LoopSettings,
    t: Array,
    q: Array,
    tau: Array,
) -> Iterator[str]:
    """Where ticks are logged: torques that move more from tick to tick than the noise explains."""
    period = 1.0 / loop.rate
    if len(t) < 3 or abs(t[1] - t[0] - period) > 0.01 * period:
        return
    half = len(t) // 2
    looked_at = q[np.linspace(half, len(t) - 1, min(_LOOKED_AT, len(t) - half)).astype(int)]
    explained = noise_step(robot, controller, loop, looked_at)
    if explained is None:
        return
    step = np.abs(np.diff(tau, axis=0))
    late = step[half:].mean(axis=0)
    share = late / np.where(explained > 0.0, explained, np.inf)
    worst = int(np.argmax(share))
    if share[worst] > 1.0:
        unit = "N m" if robot.free_turns[worst] else "N"
        yield (
            f'joint "{robot.joint_names[worst]}" steps by {late[worst]:.3g} {unit} a tick in the '
            f"mean, more than the {explained[worst]:.3g} {unit} that the noise explains (3 sigma)"
        )


def noise_step(
    robot: Robot, controller: ControllerSettings, loop: LoopSettings, positions: Array
) -> Array | None:
    r"""Step of each torque from one tick to the next that noise explains, ``(n,)`` [N m] or [N].

    .. math::
       3\sqrt{\tfrac23 \big/ (1 - D T (G + \Lambda) - \tfrac12 D^2 T^2 G \Lambda)}\;
       \max_q \big\|\,\mathrm{row}_i\,M_s(q)\,
       ((G + \Lambda + G \Lambda D T) N_v + G \Lambda N_q)\big\|

    three standard deviations of the difference of two uniform errors through the gains of the law
    ``sampled``, whose predictor feeds the last command back; None for the other laws.

    Args:
        robot: Robot with n joints.
        controller: Its settings.
        loop: What is measured, and how late commands act.
        positions: Where M_s is looked at, ``(k, n)`` [rad] or [m].

    Source: our own, from (31) and (32).
    """
    if controller.law != "sampled" or controller.G is None or controller.Lambda is None:
        return None
    light = light_parameters(robot, central_parameters(robot))
    position, velocity = measured_noise(loop, robot.n)
    both, product = controller.G + controller.Lambda, controller.G * controller.Lambda
    late = loop.delay / loop.rate
    each = (both + product * late) * velocity + product * position
    fed_back = late * both + 0.5 * late * late * product if controller.predictor else 0.0
    try:
        rows = [
            np.linalg.norm(_kernel.mass_matrix(robot.model, light.packed, q, True) * each, axis=1)
            for q in np.ascontiguousarray(positions)
        ]
    except _kernel.KernelError:
        return None
    return np.asarray(3.0 * np.sqrt(2.0 / 3.0 / max(1.0 - fed_back, 0.1)) * np.max(rows, axis=0))


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
