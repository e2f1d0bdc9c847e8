"""Algorithm 1 of Giusti and Althoff (2017), line by line in NumPy: the readable oracle.

`newton_euler` is NE* when the parameters are real and IANEA* when they are `Interval`s; the
paper writes the two as one algorithm and so does this file. In the right margin stand the paper's
lines: A1:23 is line 23 of Algorithm 1. Where the product is more general than the paper, the extra
term vanishes in the paper's case: a constant transform B_i before the joint (the paper: identity),
several bodies a link with placements (the paper: one body, identity), a parent index (the paper:
i - 1).
The arithmetic takes any number type: q may be complex (for exact derivatives) or long double.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from modrobust.model import Parameters, Robot

Z0 = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Interval:
    """A scalar, vector or matrix of intervals; Definitions 1 to 5 to the letter."""

    lo: Any
    hi: Any
    __array_ufunc__ = None  # an array on the left hands its operators over to this class

    def __add__(self, other: Any) -> Interval:
        y = interval(other)
        return Interval(self.lo + y.lo, self.hi + y.hi)

    def __sub__(self, other: Any) -> Interval:
        y = interval(other)
        return Interval(self.lo - y.hi, self.hi - y.lo)

    def __rsub__(self, other: Any) -> Interval:
        return interval(other) - self

    def __mul__(self, other: Any) -> Interval:
        y = interval(other)
        products = np.stack(
            np.broadcast_arrays(self.lo * y.lo, self.lo * y.hi, self.hi * y.lo, self.hi * y.hi)
        )
        return Interval(products.min(axis=0), products.max(axis=0))

    __radd__ = __add__
    __rmul__ = __mul__

    def __getitem__(self, key: Any) -> Interval:
        return Interval(self.lo[key], self.hi[key])


def interval(x: Any) -> Interval:
    """The degenerate interval of a real number or array (Definition 2)."""
    return x if isinstance(x, Interval) else Interval(x, x)


def stack(entries: list[Any]) -> Any:
    """A vector, or a vector of intervals, from its entries."""
    if any(isinstance(entry, Interval) for entry in entries):
        parts = [interval(entry) for entry in entries]
        return Interval(np.array([p.lo for p in parts]), np.array([p.hi for p in parts]))
    return np.array(entries)


def times(matrix: Any, vector: Any) -> Any:
    """Matrix times vector (Definition 5)."""
    total = matrix[:, 0] * vector[0]
    for k in (1, 2):
        total = total + matrix[:, k] * vector[k]
    return total


def dot(x: Any, y: Any) -> Any:
    """transpose(x) times y (Definition 5)."""
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


def cross(x: Any, y: Any) -> Any:
    """The cross product (Definition 6)."""
    return stack(
        [
            x[1] * y[2] - x[2] * y[1],
            x[2] * y[0] - x[0] * y[2],
            x[0] * y[1] - x[1] * y[0],
        ]
    )


def turn_z(angle: Any) -> Any:
    """Rz(angle), 3x3."""
    c, s = np.cos(angle), np.sin(angle)
    zero, one = 0 * c, 0 * c + 1
    return np.array([[c, -s, zero], [s, c, zero], [zero, zero, one]])


def joint_transforms(robot: Robot, q: Any) -> list[tuple[Any, Any, Any, Any, Any]]:
    """Of each joint: R_i^{i-1}, p_{i-1,i}^i from the joint, z_i, and B_i's axis and position."""
    out = []
    for i in range(robot.n):
        before, after = robot.before[i], robot.after[i]
        rotated = robot.joint_types[i] != "prismatic"
        slide = 0 * q[i] if rotated else q[i]
        joint = turn_z(q[i] if rotated else 0 * q[i])
        R = before[:3, :3] @ joint @ after[:3, :3]  # A1:6: (10)
        z = after[:3, :3].T @ Z0  # A1:8
        p = after[:3, :3].T @ (after[:3, 3] + slide * Z0)  # A1:9: (11)
        out.append((R, p, z, before[:3, :3] @ Z0, before[:3, 3]))
    return out


def newton_euler(
    robot: Robot,
    delta: Any,
    q: Any,
    dq: Any,
    dq_a: Any,
    ddq: Any,
    drives: bool = False,
    gyroscopic_in_omega: bool = False,
) -> Any:
    """NE* or IANEA* of Algorithm 1: [u], shape (n,) [N m] or [N].

    `delta` carries the fields of `Parameters`, real or `Interval`. `gyroscopic_in_omega` writes
    omega x (I omega_a) in A1:30: a wrong factorisation, to see the skew-symmetry test fail.
    """
    n = robot.n  # A1:1
    omega, omega_a, domega, a = ([np.zeros(3)] * (n + 1) for _ in range(4))  # A1:2; [-1] = base
    a[-1] = -(robot.base[:3, :3].T @ robot.gravity)  # A1:3
    joints = joint_transforms(robot, q)  # A1:4 to A1:10
    for i in range(n):  # A1:11
        h = robot.parents[i]
        R, p, z, s, p_before = joints[i]
        R = R.T  # A1:7
        a_h = a[h] + cross(domega[h], p_before) + cross(omega[h], cross(omega_a[h], p_before))
        if robot.joint_types[i] != "prismatic":  # A1:12
            omega[i] = R @ (omega[h] + dq[i] * s)  # A1:13
            omega_a[i] = R @ (omega_a[h] + dq_a[i] * s)  # A1:14
            domega[i] = R @ (domega[h] + ddq[i] * s + cross(omega_a[h], dq[i] * s))  # A1:15
            a[i] = R @ a_h + cross(domega[i], p) + cross(omega[i], cross(omega_a[i], p))  # A1:16
        else:  # A1:17
            omega[i] = R @ omega[h]  # A1:18
            omega_a[i] = R @ omega_a[h]  # A1:19
            domega[i] = R @ domega[h]  # A1:20
            a[i] = R @ a_h + cross(domega[i], p) + cross(omega[i], cross(omega_a[i], p))  # A1:21
            a[i] = a[i] + cross(omega_a[i], dq[i] * z) + cross(omega[i], dq_a[i] * z) + ddq[i] * z
    f: list[Any] = [np.zeros(3)] * (n + 1)  # A1:25; what the children hand down, summed
    torque: list[Any] = [np.zeros(3)] * (n + 1)
    u: list[Any] = [0.0] * n
    for i in reversed(range(n)):  # A1:26
        R, p, z, _, p_before = joints[i]
        for b in np.flatnonzero(robot.body_joints == i):
            R_b, p_b = robot.placement[b, :3, :3], robot.placement[b, :3, 3]
            w, w_a, dw = R_b.T @ omega[i], R_b.T @ omega_a[i], R_b.T @ domega[i]
            a_b = a[i] + cross(domega[i], p_b) + cross(omega[i], cross(omega_a[i], p_b))
            m, c, inertia = delta.mass[b], delta.com[b], delta.inertia[b]  # A1:5
            a_c = R_b.T @ a_b + cross(dw, c) + cross(w, cross(w_a, c))  # A1:23
            F = m * a_c  # A1:27
            if gyroscopic_in_omega:
                spin = cross(w, times(inertia, w_a))
            else:
                spin = cross(w_a, times(inertia, w))
            if robot.framed[b]:
                own = moment_about_frame(m, c, R_b.T @ a_b, cross(w, w_a))
            else:
                own = cross(c, F)
            moment = own + times(inertia, dw) + spin  # A1:29 and A1:30, in body axes
            F = times(R_b, F)
            f[i] = f[i] + F  # A1:28
            torque[i] = torque[i] + times(R_b, moment) + cross(p_b, F)
        torque[i] = torque[i] + cross(p, f[i])  # A1:30
        u[i] = dot(torque[i] if robot.joint_types[i] != "prismatic" else f[i], z)  # A1:31 to A1:35
        handed = times(R, f[i])
        h = robot.parents[i]
        f[h] = f[h] + handed
        torque[h] = torque[h] + times(R, torque[i]) + cross(p_before, handed)
        if drives:
            u[i] = u[i] + drive_torque(robot, delta, i, dq[i], ddq[i])
    return stack(u)


def moment_about_frame(m: Any, c: Any, a: Any, bent: Any) -> Any:
    """``m (c x a + |c|^2 bent)``: in place of c x F where the tensor is about the body's frame.

    Of an interval: c = middle + d, linear in d but for |d|^2, which lies in [0, |radius|^2].
    """
    if not isinstance(c, Interval):
        return m * (cross(c, a) + dot(c, c) * bent)
    middle, radius = (c.lo + c.hi) / 2, (c.hi - c.lo) / 2
    d = Interval(-radius, radius)
    fixed = cross(middle, a) + dot(middle, middle) * bent
    slopes = 2 * np.outer(bent, middle) + np.array(
        [[0 * a[0], a[2], -a[1]], [-a[2], 0 * a[0], a[0]], [a[1], -a[0], 0 * a[0]]]
    )
    return m * (
        fixed + times(slopes, d) + bent * Interval(0 * dot(radius, radius), dot(radius, radius))
    )


def drive_torque(robot: Robot, delta: Any, i: int, dq: Any, ddq: Any) -> Any:
    """Friction and reflected rotor inertia of joint i, added in A1:31 and A1:33."""
    v_c = robot.coulomb_speed[i]
    s = dq / np.sqrt(dq * dq + v_c * v_c)
    if isinstance(delta.coulomb, Interval):  # the hull of s(dq) and sgn(dq)
        s = Interval(min(s, np.sign(dq)), max(s, np.sign(dq)))
        s = Interval(-1.0, 1.0) if abs(dq) <= v_c else s
    rotor = robot.gear_ratio[i] ** 2 * ddq * delta.rotor_inertia[i]
    return rotor + delta.viscous[i] * dq + delta.coulomb[i] * s


@dataclass(frozen=True)
class IntervalParameters:
    """[Delta]: the fields of `Parameters`, each an `Interval`."""

    mass: Interval
    com: Interval
    inertia: Interval
    rotor_inertia: Interval
    viscous: Interval
    coulomb: Interval


def box(robot: Robot) -> IntervalParameters:
    """The robot's [Delta]."""
    names = [field.name for field in fields(Parameters)]
    return IntervalParameters(
        **{k: Interval(getattr(robot.lower, k), getattr(robot.upper, k)) for k in names}
    )


def mass_matrix(robot: Robot, delta: Parameters, q: Any) -> Any:
    """M(q), (n, n), column k = NE*(q, 0, 0, e_k) - NE*(q, 0, 0, 0)."""
    zero = np.zeros(robot.n)
    g = newton_euler(robot, delta, q, zero, zero, zero)
    columns = [newton_euler(robot, delta, q, zero, zero, e) - g for e in np.eye(robot.n)]
    return np.stack(columns, axis=1)


def link_frames(robot: Robot, q: Any) -> Any:
    """Link frames in the base frame, (n, 4, 4)."""
    frames: list[Any] = []
    for i in range(robot.n):
        joint = np.eye(4, dtype=np.result_type(q, float))
        if robot.joint_types[i] != "prismatic":
            joint[:3, :3] = turn_z(q[i])
        else:
            joint[2, 3] = q[i]
        parent = frames[robot.parents[i]] if robot.parents[i] >= 0 else np.eye(4)
        frames.append(parent @ robot.before[i] @ joint @ robot.after[i])
    return np.array(frames)


def potential_energy(robot: Robot, delta: Parameters, q: Any) -> Any:
    """-sum m g . r_c over the moving bodies [J]."""
    gravity = robot.base[:3, :3].T @ robot.gravity
    frames = link_frames(robot, q)
    total = 0.0
    for b, i in enumerate(robot.body_joints):
        if i >= 0:
            T = frames[i] @ robot.placement[b]
            total = total - delta.mass[b] * (gravity @ (T[:3, :3] @ delta.com[b] + T[:3, 3]))
    return total
