"""The exact range of every joint's torque over the parameter box, quickly and in any precision.

The kinematics are those of Algorithm 1. Each body then hands its wrench down to the base for
sixteen unit points: one kilogram with its centre of mass at ten places, and one unit in each of the
six entries of the inertia. These give the coefficients of the torque, which is linear in mass and
inertia and quadratic in the centre of mass; no formula of the kernel's hull is used. The
quadratic's range is the best of all 27 faces of the box, whatever the signs of its slopes.

The arithmetic is that of a `Number`: long double (64 bits) or balls of 300 bits.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import flint
import numpy as np

from modrobust.model import Robot

SIX = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
PAIRS = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class Number:
    """Arrays of one kind of real number, and what numpy does not know of it."""

    array: Callable[[Any], Any]
    sincos: Callable[[Any], tuple[Any, Any]]
    sqrt: Callable[[Any], Any]


def _balls(x: Any) -> Any:
    flat = [flint.arb(value) for value in np.ravel(x).tolist()]
    out = np.empty(len(flat), dtype=object)
    out[:] = flat
    return out.reshape(np.shape(x))


LONG = Number(
    lambda x: np.asarray(x, dtype=np.longdouble), lambda x: (np.sin(x), np.cos(x)), np.sqrt
)
BALLS = Number(_balls, lambda x: x.sin_cos(), lambda x: x.sqrt())


@contextmanager
def bits(precision: int) -> Iterator[None]:
    """Precision of the balls made inside."""
    before, flint.ctx.prec = flint.ctx.prec, precision
    try:
        yield
    finally:
        flint.ctx.prec = before


def cross(x: Any, y: Any) -> Any:
    """Vectors in the last axis."""
    return np.stack(
        [
            x[..., 1] * y[..., 2] - x[..., 2] * y[..., 1],
            x[..., 2] * y[..., 0] - x[..., 0] * y[..., 2],
            x[..., 0] * y[..., 1] - x[..., 1] * y[..., 0],
        ],
        axis=-1,
    )


def turn(R: Any, x: Any) -> Any:
    """R times each vector in the last axis."""
    return x[..., :1] * R[:, 0] + x[..., 1:2] * R[:, 1] + x[..., 2:] * R[:, 2]


def unit_points() -> tuple[Any, Any, Any]:
    """The sixteen points: mass (16,), com (16, 3), inertia (16, 3, 3); all small integers."""
    unit = np.eye(3)
    places = [np.zeros(3), *unit, *-unit, *(unit[i] + unit[j] for i, j in PAIRS)]
    tensors = []
    for i, j in SIX:
        entry = np.zeros((3, 3))
        entry[i, j] = entry[j, i] = 1
        tensors.append(entry)
    mass = np.array([1.0] * 10 + [0.0] * 6)
    com = np.concatenate([places, np.zeros((6, 3))])
    return mass, com, np.concatenate([np.zeros((10, 3, 3)), tensors])


def unit_torques(robot: Robot, state: Any, number: Number) -> Any:
    """What each body at each unit point asks of each joint, (b, 16, n)."""
    array, n = number.array, robot.n
    q, dq, dq_a, ddq_a = (array(x) for x in state)
    before, after, placement = array(robot.before), array(robot.after), array(robot.placement)
    mass, com, inertia = (array(x) for x in unit_points())
    zero = array(np.zeros(3))
    gravity = turn(array(robot.base[:3, :3].T), array(robot.gravity))
    rest = (zero, zero, zero, -gravity)
    motions: list[Any] = []
    joints: list[Any] = []
    for i in range(n):  # A1:4 to A1:22, the lines of Algorithm 1
        w, w_a, dw, a = motions[h] if (h := robot.parents[i]) >= 0 else rest
        B, E, lever = before[i, :3, :3], after[i, :3, :3], before[i, :3, 3]
        a = a + cross(dw, lever) + cross(w, cross(w_a, lever))
        J, slide = array(np.eye(3)), array([0.0, 0.0, 0.0])
        revolute = robot.joint_types[i] != "prismatic"
        if revolute:
            s, c = number.sincos(q[i])
            J[0, 0], J[0, 1], J[1, 0], J[1, 1] = c, -s, s, c
        else:
            slide[2] = q[i]
        R = B @ J @ E
        z, p, s = E[2], turn(E.T, after[i, :3, 3] + slide), B[:, 2]
        if revolute:
            dw = dw + ddq_a[i] * s + cross(w_a, dq[i] * s)
            w, w_a = w + dq[i] * s, w_a + dq_a[i] * s
        w, w_a, dw = turn(R.T, w), turn(R.T, w_a), turn(R.T, dw)
        a = turn(R.T, a) + cross(dw, p) + cross(w, cross(w_a, p))
        if not revolute:
            a = a + cross(w_a, dq[i] * z) + cross(w, dq_a[i] * z) + ddq_a[i] * z
        motions.append((w, w_a, dw, a))
        joints.append((R, z, p, lever, revolute))

    torques = array(np.zeros((robot.b, 16, n)))
    for b in np.flatnonzero(robot.body_joints >= 0):
        i = robot.body_joints[b]
        w, w_a, dw, a = motions[i]
        R, p = placement[b, :3, :3], placement[b, :3, 3]
        a = turn(R.T, a + cross(dw, p) + cross(w, cross(w_a, p)))
        w, w_a, dw = turn(R.T, w), turn(R.T, w_a), turn(R.T, dw)
        F = mass[:, None] * (a + cross(dw, com) + cross(w, cross(w_a, com)))
        lever = cross(com, F)
        if robot.framed[b]:  # the tensor's share of m |c|^2 taken off again
            square = (com * com).sum(axis=-1)[:, None]
            lever = mass[:, None] * (cross(com, a) + square * cross(w, w_a))
        N = lever + inertia @ dw + cross(w_a, inertia @ w)
        F, N = turn(R, F), turn(R, N)
        N = N + cross(p, F)
        while i >= 0:  # A1:26 to A1:36: down to the base
            R, z, p, lever, revolute = joints[i]
            N = N + cross(p, F)
            torques[b, :, i] = (N if revolute else F) @ z
            F, N = turn(R, F), turn(R, N)
            N = N + cross(lever, F)
            i = robot.parents[i]
    return torques


def largest(A: Any, g: Any, lo: Any, hi: Any) -> Any:
    """Largest x' A x + g . x over each box [lo, hi]: A (k, 3, 3), the rest (k, 3); returns (k,)."""
    best = None
    for face in itertools.product("lhf", repeat=3):  # the first has no free direction
        free = [i for i in range(3) if face[i] == "f"]
        x = np.stack([hi[:, i] if face[i] == "h" else lo[:, i] for i in range(3)], axis=-1)
        if free:
            x[:, free] = 0 * x[:, free]
            slope = (g + 2 * (A * x[:, None, :]).sum(axis=-1))[:, free]
            y = stationary(-2 * A[:, free][:, :, free], slope)
            x[:, free] = y
            held = np.all((y >= lo[:, free]) & (y <= hi[:, free]), axis=-1)
            # nan where a face has no stationary point: its border holds the extremum then
            x = np.where(held[:, None], x, lo)
        value = (x * (g + (A * x[:, None, :]).sum(axis=-1))).sum(axis=-1)
        best = value if best is None else np.where(value > best, value, best)
    return best


def stationary(M: Any, right: Any) -> Any:
    """Solves M y = right, (k, m, m) and (k, m), by Cramer's rule."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if M.shape[-1] == 1:
            return right / M[:, 0]
        if M.shape[-1] == 2:
            determinant = M[:, 0, 0] * M[:, 1, 1] - M[:, 0, 1] * M[:, 1, 0]
            return (
                np.stack(
                    [
                        right[:, 0] * M[:, 1, 1] - right[:, 1] * M[:, 0, 1],
                        right[:, 1] * M[:, 0, 0] - right[:, 0] * M[:, 1, 0],
                    ],
                    axis=-1,
                )
                / determinant[:, None]
            )
        rows = [cross(M[:, 1], M[:, 2]), cross(M[:, 2], M[:, 0]), cross(M[:, 0], M[:, 1])]
        determinant = (M[:, 0] * rows[0]).sum(axis=-1)
        total = sum(right[:, k, None] * rows[k] for k in range(3))
        return total / determinant[:, None]


def exact_range(robot: Robot, state: Any, drives: bool, number: Number = LONG) -> tuple[Any, Any]:
    """Exact (lo, hi) of NE* over the box, (n,) each.

    Friction and reflected inertia if `drives`, as `docs/theory/equations.md` (20) and (21) state
    them.
    """
    array = number.array
    torques = unit_torques(robot, state, number)
    # in float a structural zero is a zero, too: only joints that carry the body stay
    body, joint = np.nonzero(carries(robot))
    t = torques[body, :, joint]
    k, plus, minus = t[:, 0], t[:, 1:4], t[:, 4:7]
    A = array(np.zeros((len(body), 3, 3)))
    for i in range(3):
        A[:, i, i] = (plus[:, i] + minus[:, i]) / 2 - k
    for column, (i, j) in enumerate(PAIRS):
        A[:, i, j] = A[:, j, i] = (t[:, 7 + column] - plus[:, i] - plus[:, j] + k) / 2
    g = (plus - minus) / 2
    # about the nominal centre of mass, so that a narrow box is not lost against its place
    lower, nominal, upper = (
        (array(point.mass)[body], array(point.com)[body], array(point.inertia)[body])
        for point in (robot.lower, robot.nominal, robot.upper)
    )
    c = nominal[1]
    k = k + (c * (g + (A * c[:, None, :]).sum(axis=-1))).sum(axis=-1)
    g = g + 2 * (A * c[:, None, :]).sum(axis=-1)
    least = k - largest(-A, -g, lower[1] - c, upper[1] - c)
    most = k + largest(A, g, lower[1] - c, upper[1] - c)
    lo = smaller(lower[0] * least, upper[0] * least)
    hi = -smaller(-lower[0] * most, -upper[0] * most)
    for column, (i, j) in enumerate(SIX):
        ends = (t[:, 10 + column] * lower[2][:, i, j], t[:, 10 + column] * upper[2][:, i, j])
        lo = lo + smaller(*ends)
        hi = hi - smaller(*(-end for end in ends))
    total_lo, total_hi = array(np.zeros(robot.n)), array(np.zeros(robot.n))
    for at, (below, above) in zip(joint, zip(lo, hi, strict=True), strict=True):
        total_lo[at] += below
        total_hi[at] += above
    if drives:
        for i in range(robot.n):
            below, above = drive_range(robot, i, state, number)
            total_lo[i] += below
            total_hi[i] += above
    return total_lo, total_hi


def drive_range(robot: Robot, i: int, state: Any, number: Number) -> tuple[Any, Any]:
    """Friction and reflected rotor inertia of joint i."""
    (dq,), (ddq_a,) = number.array(state[1][[i]]), number.array(state[3][[i]])
    (speed,), (ratio,) = (number.array(x[[i]]) for x in (robot.coulomb_speed, robot.gear_ratio))
    s = dq / number.sqrt(dq * dq + speed * speed)
    sign = number.array([np.sign(state[1][i])])[0]
    directions = (-1 + 0 * s, 1 + 0 * s) if abs(state[1][i]) <= speed else (s, sign)
    lo = hi = 0 * s
    for name, factors in (
        ("rotor_inertia", (ratio * ratio * ddq_a,)),
        ("viscous", (dq,)),
        ("coulomb", directions),
    ):
        ends = [number.array(getattr(p, name)[[i]])[0] for p in (robot.lower, robot.upper)]
        products = sorted((x * y for x in ends for y in factors), key=float)
        lo, hi = lo + products[0], hi + products[-1]
    return lo, hi


def carries(robot: Robot) -> Any:
    """Whether body b hangs on joint j, (b, n)."""
    out = np.zeros((robot.b, robot.n), dtype=bool)
    for b, i in enumerate(robot.body_joints):
        while i >= 0:
            out[b, i] = True
            i = robot.parents[i]
    return out


def smaller(x: Any, y: Any) -> Any:
    """Element-wise, for any kind of number."""
    return np.where(x < y, x, y)
