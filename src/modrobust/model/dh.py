r"""Standard Denavit-Hartenberg table of a serial robot, from its joint axes. For display only.

.. math:: T_{base} \prod_i R_z(\theta_i) T_z(d_i) T_x(a_i) R_x(\alpha_i)\; T_{tool}
          = \prod_i B_i J_i(q_i) E_i

with q_i added to theta_i of a revolute and to d_i of a prismatic joint, for every q. The left side
is computed from the right one, never the other way round: for almost parallel axes the common
normal runs away (d of kilometres), which is why nothing in modrobust calculates with this table.

How: joint frame i followed by the constant screw S_i = Rz(phi_i) Tz(h_i) about its own axis is D-H
frame i. With A_i the constant transform from joint frame i (after its motion) to joint frame i + 1,

.. math:: A_i = R_z(\theta') T_z(d') T_x(a_i) R_x(\alpha_i) T_z(-h_{i+1}) R_z(-\varphi_{i+1}),
          \quad \theta_i = \theta' - \varphi_i, \quad d_i = d' - h_i

since S_i commutes with the joint's motion. The tip frame stands in for the joint after the last.

Source: standard D-H is (10) and (11) of [GA17].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from modrobust.checks.types import Array, Ints
from modrobust.model.geometry import arctan2, cos_sin, rotation_z, translation

_PARALLEL = 2e-14  # sine of the angle between axes; what products of rotations leave of an exact 0
_MERGED = 1e-8  # below it, taking the axes as parallel errs less than the run-away common normal
_NEAR_PARALLEL = 1e-3  # below it, feet of the common normal lose digits
_FAR = 100.0  # [m]; so do feet farther away than this
_TOUCHING = 1e-12  # [m]; axes closer than this intersect, and the sign of a says nothing


@dataclass(frozen=True)
class DHRow:
    """One row of a standard D-H table: a, d [m], alpha, theta [rad].

    near_parallel: this axis and the next are almost but not quite parallel (or their common normal
    is far away); the row is then less accurate than 1e-12.
    """

    a: float
    alpha: float
    d: float
    theta: float
    near_parallel: bool


@dataclass(frozen=True, eq=False)
class DHTable:
    """Rows, and the transforms ``(4, 4)`` from the base frame to row 0 and from the last row on."""

    base: Array
    rows: tuple[DHRow, ...]
    tool: Array


@dataclass(frozen=True)
class _Step:
    """A = Rz(theta) Tz(d) Tx(a) Rx(alpha) Tz(-h) Rz(-phi)."""

    theta: float
    d: float
    a: float
    alpha: float
    h: float
    phi: float
    near_parallel: bool


def dh_table(parents: Sequence[int] | Ints, before: Array, after: Array) -> DHTable:
    """Standard D-H table of a serial chain.

    Args:
        parents: Parent joint of each joint, shape ``(n,)``; ``parents[i] == i - 1`` is required.
        before: Constant transforms before the joints, shape ``(n, 4, 4)`` [m].
        after: Constant transforms after the joints, shape ``(n, 4, 4)`` [m].

    Returns:
        The table; its base transform starts in the robot's base frame, not in the world.

    Raises:
        ValueError: The joints do not form a serial chain.

    Source: docs/theory/equations.md; see the module's docstring for the construction.
    """
    n = len(before)
    if [int(parent) for parent in parents] != list(range(-1, n - 1)):
        raise ValueError("a D-H table needs a serial chain")
    rows = []
    h = phi = 0.0  # D-H frame 0 is the first joint's own frame
    for i in range(n):
        step = _decompose(_product(after[i], before[i + 1]) if i + 1 < n else after[i])
        theta = _wrapped(step.theta - phi)
        rows.append(DHRow(step.a, step.alpha, step.d - h + 0.0, theta, step.near_parallel))
        h, phi = step.h, step.phi
    tool = (translation((0.0, 0.0, -h)) @ rotation_z(-phi)).rounded()
    return DHTable(base=before[0].copy() if n else np.eye(4), rows=tuple(rows), tool=tool)


def _decompose(transform: Array) -> _Step:
    """The six numbers of one step; the free choices stay as near to the given frame as they can."""
    rotation, p = transform[:3, :3], transform[:3, 3]
    w = rotation[:, 2]  # direction of the next axis
    sine = math.hypot(w[0], w[1])
    if sine <= _MERGED:
        return _parallel(rotation, p, near=sine > _PARALLEL)
    u = np.array([-w[1] / sine, w[0] / sine, 0.0])  # common normal, up to its sign
    along = _dot(u, p)
    phi = _angle_in(rotation, u)
    if _flip(along, phi):
        u, along, phi = -u, -along, _angle_in(rotation, -u)
    # Components of p + h w = d e_z + a u along w_xy and along e_z.
    h = -float(p[0] * w[0] + p[1] * w[1]) / (sine * sine)
    d = float(p[2] + h * w[2])
    alpha = arctan2(float(u[0] * -w[1] + u[1] * w[0]), float(w[2]))
    near = sine < _NEAR_PARALLEL or abs(d) + abs(h) > _FAR
    return _Step(_direction(u), d + 0.0, along + 0.0, alpha, h + 0.0, phi, near)


def _parallel(rotation: Array, p: Array, *, near: bool) -> _Step:
    """Parallel axes: the feet may lie anywhere; the next one goes to the next frame (h = 0)."""
    distance = math.hypot(p[0], p[1])
    alpha = 0.0 if rotation[2, 2] > 0.0 else math.pi
    if distance <= _TOUCHING:  # one line: keep the next frame's x axis (phi = 0)
        theta = arctan2(rotation[1, 0], rotation[0, 0])
        cosine, sine = map(float, cos_sin(theta))
        along = float(p[0] * cosine + p[1] * sine)
        return _Step(theta + 0.0, float(p[2]) + 0.0, along + 0.0, alpha, 0.0, 0.0, near)
    u, along = np.array([p[0] / distance, p[1] / distance, 0.0]), distance
    phi = _angle_in(rotation, u)
    if _flip(along, phi):
        u, along, phi = -u, -along, _angle_in(rotation, -u)
    return _Step(_direction(u), float(p[2]) + 0.0, along, alpha, 0.0, phi, near)


def _flip(along: float, phi: float) -> bool:
    """Whether the common normal should point the other way.

    A frame that is a D-H frame already (phi of 0 or pi) keeps its x axis, so that modules described
    by a table give that table back. Otherwise a > 0; intersecting axes turn the least.
    """
    if abs(phi) < 1e-9 or abs(abs(phi) - math.pi) < 1e-9:
        return abs(phi) > 1.0
    if abs(along) > _TOUCHING:
        return along < 0.0
    return not -math.pi / 2 < phi <= math.pi / 2


def _angle_in(rotation: Array, u: Array) -> float:
    """Angle [rad] of the direction u about the next axis, from the next frame's x axis."""
    x, y = (_dot(rotation[:, k], u) for k in (0, 1))
    return arctan2(y + 0.0, x)


def _product(one: Array, other: Array) -> Array:
    """A B (4, 4), summed in order: BLAS chooses the order by the processor."""
    a, b, c, d = (one[:, k, None] * other[k] for k in range(4))
    result: Array = a + b + c + d
    return result


def _dot(x: Array, y: Array) -> float:
    a, b, c = (float(p * q) for p, q in zip(x, y, strict=True))
    return a + b + c


def _direction(u: Array) -> float:
    return arctan2(float(u[1]) + 0.0, float(u[0]))


def _wrapped(angle: float) -> float:
    """The angle [rad] plus a multiple of 2 pi, in (-pi, pi]."""
    if -math.pi < angle <= math.pi:
        return angle + 0.0
    return math.remainder(angle, 2.0 * math.pi) + 0.0
