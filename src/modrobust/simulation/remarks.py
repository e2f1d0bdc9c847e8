"""What a run did that its verdict does not judge: torques that chatter, motion beyond limits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.design.points import central_parameters, light_parameters
from modrobust.model import ControllerSettings, LoopSettings, Robot
from modrobust.simulation.metrics import CHATTERING_LIMIT

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
    if is_noisy(loop):
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


def is_noisy(loop: LoopSettings) -> bool:
    """Whether the measurement has errors: no torque is without any fast part then."""
    sizes = (
        *(loop.noise_position, loop.noise_velocity),
        *(loop.quantisation_position, loop.quantisation_velocity),
    )
    return loop.velocity == "differentiated" or any(any(size) for size in sizes)


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
    explained = noise_step(robot, controller, loop, q[-1]) if len(t) > 2 else None
    if explained is None or abs(t[1] - t[0] - period) > 0.01 * period:
        return
    step = np.abs(np.diff(tau, axis=0))
    late = step[len(step) // 2 :].mean(axis=0)
    share = late / np.where(explained > 0.0, explained, np.inf)
    worst = int(np.argmax(share))
    if share[worst] > 1.0:
        unit = "N m" if robot.free_turns[worst] else "N"
        yield (
            f'joint "{robot.joint_names[worst]}" steps by {late[worst]:.3g} {unit} a tick in the '
            f"mean, more than the {explained[worst]:.3g} {unit} that the noise explains (3 sigma)"
        )


def noise_step(
    robot: Robot, controller: ControllerSettings, loop: LoopSettings, q: Array
) -> Array | None:
    r"""Largest step of each torque from one tick to the next that noise explains, ``(n,)``.

    .. math:: 3\sqrt{2/3}\;\big\|\,\mathrm{row}_i\,M_s\,
              ((G + \Lambda) N_v + (G + \Lambda) D T N_v + G \Lambda N_q)\big\|

    three standard deviations of the difference of two uniform errors through the gains of the law
    ``sampled``; None for the other laws.
    """
    if controller.law != "sampled" or controller.G is None or controller.Lambda is None:
        return None
    light = light_parameters(robot, central_parameters(robot))
    try:
        M = _kernel.mass_matrix(robot.model, light.packed, q, True)
    except _kernel.KernelError:
        return None
    position, velocity = measurement_errors(robot.n, loop)
    G, Lambda = controller.G, controller.Lambda
    late = loop.delay / loop.rate
    each = (G + Lambda + G * Lambda * late) * velocity + G * Lambda * position
    return np.asarray(3.0 * np.sqrt(2.0 / 3.0) * np.linalg.norm(M * each, axis=1))


def measurement_errors(n: int, loop: LoopSettings) -> tuple[Array, Array]:
    """Half widths of the errors of q and dq, ``(n,)`` each: noise and half a step."""

    def size(noise: tuple[float, ...], step: tuple[float, ...]) -> Array:
        none = np.zeros(n)
        return np.asarray(
            (np.array(noise) if noise else none) + (np.array(step) if step else none) / 2
        )

    position = size(loop.noise_position, loop.quantisation_position)
    velocity = size(loop.noise_velocity, loop.quantisation_velocity)
    if loop.velocity == "differentiated":
        share = -math.expm1(-2.0 * math.pi * loop.filter / loop.rate)
        velocity = 2.0 * position * loop.rate * share
    return position, velocity


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


__all__ = ["is_noisy", "remarks"]
