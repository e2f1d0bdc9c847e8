"""The figures that `modrobust assemble` shows: masses, reach, static torques, what is exact.

Reach and torque are found by search over seeded poses: they are the largest found, not bounds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from modrobust.assembly.magnitudes import magnitudes
from modrobust.checks.types import Array
from modrobust.dynamics import inverse_dynamics_bounds_batch
from modrobust.kernel import own_environment
from modrobust.model import ModuleNode, Robot
from modrobust.model.dh import DHTable

POSES = 10_000
SEED = 0
_FREE_STROKE = 1.0  # [m], half the stroke taken where a prismatic joint has no limits


@dataclass(frozen=True)
class MassFigures:
    """Nominal mass and its bounds [kg]."""

    nominal: float
    lo: float
    hi: float


@dataclass(frozen=True)
class LinkFigures:
    """What moves with one joint ("base" for what does not move)."""

    joint: str
    bodies: tuple[str, ...]
    mass: MassFigures


@dataclass(frozen=True)
class JointFigures:
    """A joint with its limits (None = not given) and its largest static torque found.

    static_torque: Largest magnitude of the gravity torque [N m] or [N] over the poses, at the
        upper end of its `hull` bound.
    share: static_torque over the effort limit; above 1 the joint cannot hold the arm everywhere.
    """

    name: str
    type: str
    position: tuple[float, float] | None
    velocity: float | None
    effort: float | None
    static_torque: float
    share: float | None


@dataclass(frozen=True, eq=False)
class Report:
    """All figures of one robot.

    `reach` [m] is the largest distance found of a link or body frame from the origin of the base
    frame; `exact` groups the names of `Robot.exact` for reading.
    """

    robot: str
    modules: tuple[ModuleNode, ...]
    dh: DHTable | None
    links: tuple[LinkFigures, ...]
    joints: tuple[JointFigures, ...]
    total_mass: MassFigures
    reach: float
    poses: int
    exact: tuple[str, ...]
    not_modelled: tuple[str, ...]
    notes: tuple[str, ...]


@own_environment()
def report(robot: Robot, poses: int = POSES, seed: int = SEED) -> Report:
    """The figures of a robot, from `poses` random poses within its position limits."""
    q = _poses(robot, poses, seed)
    torque = _static_torque(robot, q)
    reach = _reach(robot, q)
    return Report(
        robot=robot.name,
        modules=robot.modules,
        dh=robot.dh,
        links=_links(robot),
        joints=tuple(_joint(robot, i, float(torque[i])) for i in range(robot.n)),
        total_mass=_mass(robot, range(robot.b)),
        reach=reach,
        poses=poses,
        exact=exact_groups(robot),
        not_modelled=robot.not_modelled,
        notes=(*robot.notes, *_pose_notes(robot), *magnitudes(robot, reach, torque)),
    )


def exact_groups(robot: Robot) -> tuple[str, ...]:
    """`Robot.exact` with one line for a body, a drive or a friction of which all is exact."""
    exact = dict.fromkeys(robot.exact)
    whole: list[tuple[str, tuple[str, ...]]]
    whole = [(name, ("mass", "com", "inertia")) for name in robot.body_names]
    whole += [(f"{name}.friction", ("viscous", "coulomb")) for name in robot.joint_names]
    groups: dict[str, str] = {}
    for name, parts in whole:
        members = [f"{name}.{part}" for part in parts]
        if all(member in exact for member in members):
            groups |= dict.fromkeys(members, name)
    return tuple(dict.fromkeys(groups.get(name, name) for name in exact))


def _links(robot: Robot) -> tuple[LinkFigures, ...]:
    found = []
    for i in range(-1, robot.j):
        members = [int(k) for k in np.flatnonzero(robot.body_joints == i)]
        if members or i >= 0:
            names = tuple(robot.body_names[k] for k in members)
            joint = "base" if i < 0 else robot.all_joint_names[i]
            found.append(LinkFigures(joint, names, _mass(robot, members)))
    return tuple(found)


def _mass(robot: Robot, members: Sequence[int]) -> MassFigures:
    points = (robot.nominal, robot.lower, robot.upper)
    return MassFigures(*(math.fsum(point.mass[list(members)]) for point in points))


def _joint(robot: Robot, i: int, torque: float) -> JointFigures:
    lo, hi = (float(limit) for limit in robot.position_limits[i])
    effort = _finite(robot.effort_limits[i])
    return JointFigures(
        name=robot.joint_names[i],
        type=robot.free_types[i],
        position=(lo, hi) if math.isfinite(lo) and math.isfinite(hi) else None,
        velocity=_finite(robot.velocity_limits[i]),
        effort=effort,
        static_torque=torque,
        share=None if effort is None else torque / effort if effort > 0.0 else math.inf,
    )


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _poses(robot: Robot, count: int, seed: int) -> Array:
    """Poses ``(count, n)``, uniform within the limits; +-pi or +-1 m where there are none."""
    prismatic = np.array([kind == "prismatic" for kind in robot.free_types])
    free = np.where(prismatic, _FREE_STROKE, math.pi)
    lo = np.where(np.isfinite(robot.position_limits[:, 0]), robot.position_limits[:, 0], -free)
    hi = np.where(np.isfinite(robot.position_limits[:, 1]), robot.position_limits[:, 1], free)
    q: Array = np.random.default_rng(seed).uniform(lo, hi, (count, robot.n))
    return q


def _pose_notes(robot: Robot) -> list[str]:
    return [
        f"{name}: no position limits; reach and torque searched within +-{_FREE_STROKE:g} m"
        for name, kind, limits in zip(
            robot.joint_names, robot.free_types, robot.position_limits, strict=True
        )
        if kind == "prismatic" and not np.isfinite(limits).all()
    ]


def _static_torque(robot: Robot, q: Array) -> Array:
    """Largest magnitude ``(n,)`` of both ends of the `hull` bound at rest, drives left out."""
    rest = np.zeros_like(q)
    lo, hi = inverse_dynamics_bounds_batch(robot, q, rest, rest, rest, drives=False)
    result: Array = np.maximum(-lo, hi).max(axis=0)
    return result


def _reach(robot: Robot, q: Array) -> float:
    """Largest distance of a link or body frame's origin from the base frame's, poses ``(k, n)``."""
    motions = np.ascontiguousarray(robot.all_positions(q).T)
    rotated = np.cos(motions), np.sin(motions)
    points = {(i, (0.0, 0.0, 0.0)) for i in range(robot.j)}
    for i, T in zip(robot.body_joints, robot.placement, strict=True):
        points.add((int(i), tuple(T[:3, 3].tolist())))
    squares = (np.sum(_positions(robot, motions, rotated, *p) ** 2, axis=0) for p in points)
    return math.sqrt(max(float(np.max(square)) for square in squares))


def _positions(
    robot: Robot, q: Array, rotated: tuple[Array, Array], i: int, point: tuple[float, ...]
) -> Array:
    """The point of link i in the base frame, ``(3, k)``; q and its cosines and sines ``(j, k)``."""
    p = np.repeat(np.array(point)[:, None], q.shape[1], axis=1)
    while i >= 0:
        p = robot.after[i, :3, :3] @ p + robot.after[i, :3, 3:]
        if robot.joint_types[i] == "prismatic":
            p[2] += q[i]
        else:
            c, s = rotated[0][i], rotated[1][i]
            p[0], p[1] = c * p[0] - s * p[1], s * p[0] + c * p[1]
        p = robot.before[i, :3, :3] @ p + robot.before[i, :3, 3:]
        i = int(robot.parents[i])
    return p
