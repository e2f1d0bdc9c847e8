"""The exact range of the torque over the parameter box again, slowly: a check of `exact_range`.

Per body and joint the torque is m times a quadratic in the centre of mass plus a linear form in the
inertia. The coefficients are read off the oracle by evaluating it (no formula of the kernel is
used), and the quadratic's range is the best of all 27 faces of the box. Long double throughout.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from modrobust.model import Robot
from modrobust.reference import Interval, box, drive_torque, newton_euler

SIX = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
LONG = np.longdouble


def quadratic_range(A: Any, b: Any, k: Any, lo: Any, hi: Any) -> tuple[Any, Any]:
    """Smallest and largest value of c' A c + b' c + k over the box [lo, hi], A symmetric."""
    values = []
    for face in itertools.product("lfh", repeat=3):
        free = [i for i in range(3) if face[i] == "f"]
        c = np.array([hi[i] if face[i] == "h" else lo[i] for i in range(3)], dtype=LONG)
        if free:
            # stationary point on the face; none where the block is singular, and then the face's
            # own boundary holds the extremum
            block = 2 * A[np.ix_(free, free)]
            c[free] = 0
            right = -(b[free] + 2 * A[free] @ c)
            determinant = np.linalg.det(block.astype(float))
            if abs(determinant) <= 1e-12 * np.abs(block).max() ** len(free):
                continue
            x = solve(block, right)
            if np.any(x < lo[free]) or np.any(x > hi[free]):
                continue
            c[free] = x
        values.append(c @ A @ c + b @ c + k)
    return min(values), max(values)


def solve(matrix: Any, right: Any) -> Any:
    """Solve in long double: double solution, refined twice."""
    double = matrix.astype(float)
    x = np.zeros(len(right), dtype=LONG)
    for _ in range(3):
        x = x + np.linalg.solve(double, (right - matrix @ x).astype(float))
    return x


def alone(robot: Robot, body: int) -> Robot:
    """The robot with that one body only."""
    keep = slice(body, body + 1)
    points = {
        name: replace(
            point, mass=point.mass[keep], com=point.com[keep], inertia=point.inertia[keep]
        )
        for name in ("nominal", "lower", "upper")
        if (point := getattr(robot, name))
    }
    return replace(
        robot,
        body_names=robot.body_names[keep],
        body_joints=robot.body_joints[keep],
        placement=robot.placement[keep],
        inertia_about=robot.inertia_about[keep],
        **points,
    )


def exact_bounds(
    robot: Robot, q: Any, dq: Any, dq_a: Any, ddq_a: Any, drives: bool = False
) -> tuple[Any, Any]:
    """(lo, hi), each (n,): the exact range of each torque over the whole box."""
    q, dq, dq_a, ddq_a = (np.asarray(x, dtype=LONG) for x in (q, dq, dq_a, ddq_a))
    zero3, zero33, unit = np.zeros(3), np.zeros((3, 3)), np.eye(3)
    total = Interval(np.zeros(robot.n, dtype=LONG), np.zeros(robot.n, dtype=LONG))
    for body in np.flatnonzero(robot.body_joints >= 0).tolist():
        one = alone(robot, body)

        def torque(mass: float, com: Any, inertia: Any, one: Robot = one) -> Any:
            point = SimpleNamespace(mass=[mass], com=[com], inertia=[inertia])
            return newton_euler(one, point, q, dq, dq_a, ddq_a)

        k = torque(1, zero3, zero33)
        plus = [torque(1, e, zero33) for e in unit]
        minus = [torque(1, -e, zero33) for e in unit]
        A = np.zeros((robot.n, 3, 3), dtype=LONG)
        b = np.zeros((robot.n, 3), dtype=LONG)
        for i in range(3):
            A[:, i, i] = (plus[i] + minus[i]) / 2 - k
            b[:, i] = (plus[i] - minus[i]) / 2
        for i, j in ((0, 1), (0, 2), (1, 2)):
            both = torque(1, unit[i] + unit[j], zero33)
            A[:, i, j] = A[:, j, i] = (both - plus[i] - plus[j] + k) / 2
        lo, hi = robot.lower.com[body], robot.upper.com[body]
        ranges = [quadratic_range(A[j], b[j], k[j], lo, hi) for j in range(robot.n)]
        quadratic = Interval(*(np.array(side) for side in zip(*ranges, strict=True)))
        total = total + Interval(robot.lower.mass[body], robot.upper.mass[body]) * quadratic
        for i, j in SIX:
            entry = np.zeros((3, 3))
            entry[i, j] = entry[j, i] = 1
            bounds = Interval(robot.lower.inertia[body, i, j], robot.upper.inertia[body, i, j])
            total = total + bounds * torque(0, zero3, entry)
    if drives:
        delta = box(robot)
        extra = [drive_torque(robot, delta, i, dq[i], ddq_a[i]) for i in range(robot.n)]
        total = total + Interval(np.array([x.lo for x in extra]), np.array([x.hi for x in extra]))
    return total.lo, total.hi
