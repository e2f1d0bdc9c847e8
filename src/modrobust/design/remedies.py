"""What would help most where an epsilon cannot be met: the rule once more on changed input."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modrobust.checks.types import Array
from modrobust.design.box import lifted
from modrobust.design.choice import GainChoice, choose
from modrobust.design.need import flat
from modrobust.design.states import MotionStates
from modrobust.design.twists import jacobians, motion, selection, torque_weights
from modrobust.model import SENSOR_SIZES, Bounded, LoopSettings, Parameters, Robot

_BODY = ("mass", "com", "inertia")
_NAMES = {"mass": "mass", "com": "centre of mass", "inertia": "inertia", "rotor_inertia": "rotor"}
_TRIED = 3  # boxes that are halved, those that push most
_GAIN = 0.99  # of the epsilon: what changes less is not said
_ROTOR_SPEED_UP = 1000.0  # [rad/s^2]: what a drive's own limit gives its rotor, when none is known
_ROTOR_SPREAD = 0.1

_Group = tuple[tuple[str, ...], int]  # fields of `Parameters`, and the body's or joint's index


@dataclass(frozen=True)
class Help:
    """One change and what the rule makes of it."""

    change: str
    """In words."""
    epsilon: float
    """That would then be met [rad] or [m]."""
    G: float
    """Largest gain that would then be allowed [1/s]."""

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {"change": self.change, "epsilon": self.epsilon, "G": self.G}


def remedies(
    robot: Robot, loop: LoopSettings, states: MotionStates, epsilon: float, now: GainChoice
) -> tuple[Help, ...]:
    """Changes that bring epsilon down, the best first.

    Tried are twice the rate, no delay, half the noise, half the box of the parameters that push
    most (one body's mass, centre of mass or tensor, one joint's friction or rotor, [d]), drive
    figures where none are known, half the speed, and half as much torque again.

    Args:
        robot: The robot that the rule was run on.
        loop: Its loop.
        states: Of its motion.
        epsilon: What was to be met [rad] or [m].
        now: What the rule found.
    """
    tried = [
        *_of_the_loop(robot, loop, states, epsilon, now),
        *(
            (f"half the box of {name}", choose(narrow, loop, states, epsilon))
            for name, narrow in _narrower(robot, states, now)
        ),
    ]
    helps = [Help(change, found.reached, found.limit) for change, found in tried]
    better = [item for item in helps if item.epsilon < _GAIN * now.reached]
    return tuple(sorted(better, key=lambda item: item.epsilon))


def _of_the_loop(
    robot: Robot, loop: LoopSettings, states: MotionStates, epsilon: float, now: GainChoice
) -> Iterator[tuple[str, GainChoice]]:
    """Changes of loop, drives and motion."""

    def other(loop: LoopSettings) -> GainChoice:
        return choose(robot, loop, states, epsilon, now)

    yield f"twice the rate, {2.0 * loop.rate:g} Hz", other(replace(loop, rate=2.0 * loop.rate))
    if loop.delay > 0.0:
        yield "no delay", other(replace(loop, delay=0.0))
    noisy = {name: tuple(0.5 * x for x in getattr(loop, name)) for name in SENSOR_SIZES}
    if any(any(values) for values in noisy.values()):
        yield "half the noise of the sensors", other(replace(loop, **noisy))  # type: ignore[arg-type]
    driven = _with_rotors(robot)
    if driven is not None:
        yield (
            "drive: figures of the joints that have none (assumed: a rotor that the effort limit "
            f"speeds up at {_ROTOR_SPEED_UP:g} rad/s^2, known to 10 %)",
            choose(driven, loop, states, epsilon),
        )
    slow = states.at_speed(0.5)
    yield "the motion at half the speed", choose(robot, loop, slow, epsilon)
    if np.isfinite(robot.effort_limits).any():
        stronger = replace(robot, effort_limits=1.5 * robot.effort_limits)
        yield "half as much torque again", choose(stronger, loop, states, epsilon, now)


def _with_rotors(robot: Robot) -> Robot | None:
    """The robot with a rotor on every limited joint that has none; None where there is none."""
    reflected = robot.gear_ratio**2 * robot.nominal.rotor_inertia
    limits = np.full(robot.j, np.inf)
    limits[robot.free] = robot.effort_limits
    bare = (reflected == 0.0) & np.isfinite(limits)
    if not bare.any():
        return None
    rotor = np.where(bare, limits, 0.0) / _ROTOR_SPEED_UP

    def point(p: Parameters, factor: float) -> Parameters:
        return replace(p, rotor_inertia=np.where(bare, factor * rotor, p.rotor_inertia))

    return replace(
        robot,
        gear_ratio=np.where(bare, 1.0, robot.gear_ratio),
        nominal=point(robot.nominal, 1.0),
        lower=point(robot.lower, 1.0 - _ROTOR_SPREAD),
        upper=point(robot.upper, 1.0 + _ROTOR_SPREAD),
        scenarios={},
    )


def _narrower(robot: Robot, states: MotionStates, now: GainChoice) -> Iterator[tuple[str, Robot]]:
    """The robot with half the box of one parameter, for those that push most by themselves."""
    inverse = np.asarray(np.linalg.inv(now.light_mass))
    found: list[tuple[float, str, _Group | None]]
    found = [*_bodies(robot, states, inverse), *_joints(robot, states, inverse)]
    d = np.maximum(np.abs(robot.disturbance.lo), np.abs(robot.disturbance.hi))
    pushed = np.linalg.norm(np.abs(inverse) @ d, axis=1).max()
    found.append((float(pushed), "the disturbance", None))
    found.sort(key=lambda item: -item[0])
    for size, name, group in found[:_TRIED]:
        if size > 0.0:
            yield name, _half_disturbance(robot) if group is None else _half(robot, *group)


def _bodies(
    robot: Robot, states: MotionStates, inverse: Array
) -> Iterator[tuple[float, str, _Group]]:
    """How hard each parameter of each body pushes alone, at either end of its box."""
    k, n = states.q.shape
    J = jacobians(robot, states.q)
    moved = motion(robot, states.q, states.dq, states.ddq)
    axes = np.broadcast_to(np.eye(n), (k, n, n))
    regressor = flat(torque_weights(robot, J, moved, states.ddq, axes)).reshape(k, n, -1)
    centre = flat(lifted(robot, [robot.nominal]))
    which = [
        (name, b)
        for name in _BODY
        for b in np.flatnonzero(robot.body_joints >= 0).tolist()
        if (getattr(robot.lower, name)[b] < getattr(robot.upper, name)[b]).any()
    ]
    points = [
        _at_end(robot.nominal, end, name, b)
        for name, b in which
        for end in (robot.lower, robot.upper)
    ]
    if not points:
        return
    off = flat(lifted(robot, points)) - centre
    torque = np.einsum("knp,xp->kxn", regressor, off)
    size = np.linalg.norm(torque @ inverse, axis=2).max(axis=0).reshape(-1, 2).max(axis=1)
    for (name, b), pushed in zip(which, size, strict=True):
        yield float(pushed), f"the {_NAMES[name]} of {robot.body_names[b]}", ((name,), b)


def _joints(
    robot: Robot, states: MotionStates, inverse: Array
) -> Iterator[tuple[float, str, _Group]]:
    """How hard each joint's friction and rotor push alone."""
    G = selection(robot)
    lower, upper = robot.lower, robot.upper
    speed, speed_up = np.abs(states.dq @ G.T), np.abs(states.ddq @ G.T)
    width = {
        x: 0.5 * (getattr(upper, x) - getattr(lower, x))
        for x in ("viscous", "coulomb", "rotor_inertia")
    }
    rubbed = speed * width["viscous"] + width["coulomb"]
    turned = speed_up * robot.gear_ratio**2 * width["rotor_inertia"]
    groups = (("friction", ("viscous", "coulomb"), rubbed), ("rotor", ("rotor_inertia",), turned))
    for what, names, torque in groups:
        for j, joint in enumerate(robot.all_joint_names):
            column = torque[:, j, None] * np.abs(G[j])
            pushed = np.linalg.norm(np.einsum("kij,kj->ki", np.abs(inverse), column), axis=1).max()
            yield float(pushed), f"the {what} of {joint}", (names, j)


def _at_end(nominal: Parameters, end: Parameters, name: str, index: int) -> Parameters:
    values = np.array(getattr(nominal, name))
    values[index] = getattr(end, name)[index]
    return replace(nominal, **{name: values})


def _half(robot: Robot, names: tuple[str, ...], index: int) -> Robot:
    """The robot with half the box of these entries, around nominal."""
    ends = []
    for end in (robot.lower, robot.upper):
        changed = {}
        for name in names:
            middle, values = getattr(robot.nominal, name), np.array(getattr(end, name))
            values[index] = 0.5 * (middle[index] + values[index])
            changed[name] = values
        ends.append(replace(end, **changed))
    return replace(robot, lower=ends[0], upper=ends[1])


def _half_disturbance(robot: Robot) -> Robot:
    d = robot.disturbance
    half = Bounded(d.nominal, 0.5 * (d.nominal + d.lo), 0.5 * (d.nominal + d.hi))
    return replace(robot, disturbance=half)
