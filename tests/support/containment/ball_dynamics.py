"""NE* of Algorithm 1 in arb balls, as a linear map of the monomials of the parameters.

For one state the torque is linear in m, m c, m c c', I of each body and in the parameters of each
drive. Its coefficients are what costs; a parameter point is then a matrix product, so that many
points a state are cheap. Forward recursion as the algorithm prints it (numbers in the margin are
its lines); of the backward recursion, which is linear in the forces and moments of the bodies, the
transpose is used: the row that takes a body's force and moment to joint i's torque is carried from
the joint to the bodies, instead of every monomial from the body to the joints.

Matrices are used as they are given, never as if their inverse were their transpose where the
algorithm does not say so. With B_i: docs/theory/equations.md, (14); mimic joints: (15).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from flint import arb

from modrobust.model import Robot
from support.containment.ball_vectors import (
    ZERO,
    Matrix,
    Vector,
    add,
    back,
    cross,
    dot,
    product,
    scale,
)

MONOMIALS = 16  # a body: m, m c (3), m c c' (6), I (6), pairs as xx xy xz yy yz zz
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


class Pose(NamedTuple):
    """A rigid transform: R x + p."""

    R: Matrix
    p: Vector


@dataclass(frozen=True)
class BallRobot:
    """Geometry and constants of a robot in balls; gravity in the base frame."""

    prismatic: Sequence[bool]  # (j)
    parents: Sequence[int]  # (j)
    before: Sequence[Pose]  # (j)
    after: Sequence[Pose]  # (j)
    gravity: Vector
    body_joints: Sequence[int]  # (b)
    placement: Sequence[Pose]  # (b)
    framed: Sequence[bool]  # (b) tensor about the body frame's origin
    gear_ratio: Sequence[arb]  # (j)
    coulomb_speed: Sequence[arb]  # (j)
    moves: Sequence[int]  # (j) joints that entries of vectors move, then those that mimic
    leaders: Sequence[int]  # (j - n) entries of vectors
    multiplier: Sequence[arb]
    offset: Sequence[arb]


class State(NamedTuple):
    """q, dq, dq_a, ddq_a, one ball for each free joint (n)."""

    q: list[arb]
    dq: list[arb]
    dq_a: list[arb]
    ddq_a: list[arb]


@dataclass(frozen=True)
class Coefficients:
    """The torques of one state: bodies (n, 16 b') over the b' bodies that move, drives (n, 3 j)."""

    bodies: list[list[arb]]
    drives: list[list[arb]]
    dq: list[arb]  # (j)
    smooth_sign: list[arb]  # (j) s(dq) of (20)


class _Link(NamedTuple):
    R: Matrix  # link to parent
    p: Vector
    z: Vector
    w: Vector
    wa: Vector
    dw: Vector
    a: Vector


def ball_pose(T: Any) -> Pose:
    """The doubles of a 4x4 transform."""
    R = tuple(arb(float(T[i][k])) for i in range(3) for k in range(3))
    return Pose(R, tuple(arb(float(T[i][3])) for i in range(3)))  # type: ignore[arg-type]


def from_doubles(robot: Robot) -> BallRobot:
    """The doubles of `to_dict()`, taken as real numbers."""
    base = ball_pose(robot.base)
    g = robot.gravity
    f = robot.mimic
    return BallRobot(
        prismatic=[kind == "prismatic" for kind in robot.joint_types],
        parents=robot.parents.tolist(),
        before=[ball_pose(T) for T in robot.before],
        after=[ball_pose(T) for T in robot.after],
        gravity=back(base.R, (arb(float(g[0])), arb(float(g[1])), arb(float(g[2])))),
        body_joints=robot.body_joints.tolist(),
        placement=[ball_pose(T) for T in robot.placement],
        framed=robot.framed.tolist(),
        gear_ratio=[arb(x) for x in robot.gear_ratio.tolist()],
        coulomb_speed=[arb(x) for x in robot.coulomb_speed.tolist()],
        moves=robot.moves.tolist(),
        leaders=f.leaders.tolist(),
        multiplier=[arb(x) for x in f.multiplier.tolist()],
        offset=[arb(x) for x in f.offset.tolist()],
    )


def coefficients(robot: BallRobot, state: State) -> Coefficients:
    """The rows of all torques for one state."""
    n, j = len(state.q), len(robot.parents)
    q, dq, dq_a, ddq_a = (list(vector) for vector in state)
    for k, leader in enumerate(robot.leaders):  # (15)
        mu = robot.multiplier[k]
        q.append(mu * q[leader] + robot.offset[k])
        for vector in (dq, dq_a, ddq_a):
            vector.append(mu * vector[leader])
    for vector in (q, dq, dq_a, ddq_a):
        vector[:] = [x for _, x in sorted(zip(robot.moves, vector, strict=True), key=_joint)]
    links = _forward(robot, q, dq, dq_a, ddq_a)
    moving = [b for b, joint in enumerate(robot.body_joints) if joint >= 0]
    motions = {b: _body_motion(robot, links, b) for b in moving}

    zero = arb(0)
    bodies = [[zero] * (MONOMIALS * len(moving)) for _ in range(j)]
    for i in range(j):
        carried = _transposed(robot, links, i)
        for column, b in enumerate(moving):
            row = carried.get(robot.body_joints[b])
            if row is not None:
                at = MONOMIALS * column
                bodies[i][at : at + MONOMIALS] = _body_row(
                    robot.placement[b], motions[b], row, robot.framed[b]
                )

    drives = [[zero] * (3 * j) for _ in range(j)]
    for i in range(j):  # (20), (21): viscous, coulomb times a sign, rotor inertia
        drives[i][3 * i] = dq[i]
        drives[i][3 * i + 1] = arb(1)
        drives[i][3 * i + 2] = robot.gear_ratio[i] * robot.gear_ratio[i] * ddq_a[i]
    bodies, drives = ([rows[i] for i in robot.moves] for rows in (bodies, drives))
    for k, leader in enumerate(robot.leaders):  # (15): G' tau
        mu = robot.multiplier[k]
        for rows in (bodies, drives):
            rows[leader] = [
                own + mu * other for own, other in zip(rows[leader], rows[n + k], strict=True)
            ]
    return Coefficients(
        bodies[:n],
        drives[:n],
        dq,
        [_smooth_sign(v, v_c) for v, v_c in zip(dq, robot.coulomb_speed, strict=True)],
    )


def _joint(moved: tuple[int, arb]) -> int:
    return moved[0]


def _smooth_sign(dq: arb, v_c: arb) -> arb:
    return arb(0) if dq.is_zero() else dq / (dq * dq + v_c * v_c).sqrt()


def _carried(a: Vector, w: Vector, wa: Vector, dw: Vector, lever: Vector) -> Vector:
    """Acceleration at the end of a lever."""
    return add(add(a, cross(dw, lever)), cross(w, cross(wa, lever)))


def _forward(
    robot: BallRobot, q: list[arb], dq: list[arb], dq_a: list[arb], ddq_a: list[arb]
) -> list[_Link]:
    g = robot.gravity
    base = (-g[0], -g[1], -g[2])  # A1:3
    links: list[_Link] = []
    for i, h in enumerate(robot.parents):  # A1:11
        A, B = robot.after[i], robot.before[i]
        z: Vector = A.R[6:9]  # A1:8: A' z0
        p = back(A.R, A.p)  # A1:9
        turned = A.R
        if robot.prismatic[i]:
            p = add(p, scale(q[i], z))
        else:
            s, c = q[i].sin_cos()
            x, y = A.R[0:3], A.R[3:6]
            turned = (
                *(c * x[0] - s * y[0], c * x[1] - s * y[1], c * x[2] - s * y[2]),
                *(s * x[0] + c * y[0], s * x[1] + c * y[1], s * x[2] + c * y[2]),
                *z,
            )
        R = product(B.R, turned)  # A1:6
        if h < 0:
            w = wa = dw = ZERO
            a = back(R, base)
        else:
            up = links[h]
            w, wa, dw = back(R, up.w), back(R, up.wa), back(R, up.dw)  # A1:18 to A1:20
            a = back(R, _carried(up.a, up.w, up.wa, up.dw, B.p))
        if robot.prismatic[i]:  # the end of 21
            a = add(a, scale(dq[i], cross(wa, z)))
            a = add(a, scale(dq_a[i], cross(w, z)))
            a = add(a, scale(ddq_a[i], z))
        else:
            dw = add(add(dw, scale(ddq_a[i], z)), scale(dq[i], cross(wa, z)))  # 15
            w = add(w, scale(dq[i], z))  # 13
            wa = add(wa, scale(dq_a[i], z))  # 14
        a = _carried(a, w, wa, dw, p)  # A1:16, A1:21
        links.append(_Link(R, p, z, w, wa, dw, a))
    return links


def _body_motion(
    robot: BallRobot, links: list[_Link], b: int
) -> tuple[Vector, Vector, Vector, Vector]:
    """w, wa, dw and the acceleration of the body frame's origin, in body axes."""
    T, link = robot.placement[b], links[robot.body_joints[b]]
    a = _carried(link.a, link.w, link.wa, link.dw, T.p)
    return back(T.R, link.w), back(T.R, link.wa), back(T.R, link.dw), back(T.R, a)


def _transposed(robot: BallRobot, links: list[_Link], i: int) -> dict[int, tuple[Vector, Vector]]:
    """Of each link that joint i carries: the rows (on force, on moment) that make joint i's torque.

    The algorithm adds a link's own wrench (f, n) and p x f (A1:30), takes z . n or z . f (A1:32,
    A1:34), and hands R f and R n + b x (R f) to the parent (A1:28, A1:29).
    """
    rows: dict[int, tuple[Vector, Vector]] = {}
    for k in range(i, len(links)):
        link, h = links[k], robot.parents[k]
        if k == i:
            on_f, on_n = (link.z, ZERO) if robot.prismatic[i] else (ZERO, link.z)
        elif h in rows:
            f, n = rows[h]
            on_f = back(link.R, add(f, cross(n, robot.before[k].p)))
            on_n = back(link.R, n)
        else:
            continue
        rows[k] = (add(on_f, cross(on_n, link.p)), on_n)
    return rows


def _body_row(
    T: Pose,
    motion: tuple[Vector, Vector, Vector, Vector],
    row: tuple[Vector, Vector],
    framed: bool,
) -> list[arb]:
    """One body's 16 coefficients in one torque.

    F = m (a + L c), A1:23 and A1:27; moment about the body frame's origin c x F + I dw
    + wa x (I w), A1:29 and A1:30; both turned into the link's axes, F with the lever of T. Of a
    tensor J about that origin I = J - m (c'c 1 - c c') is what the lines ask for: for
    S = c'c 1 - c c', S dw = c x (dw x c) and wa x (S w) = c'c (wa x w) - wa x c (c . w), so that of
    c x L c - S dw - wa x (S w) only c'c (w x wa) is left.
    """
    w, wa, dw, a = motion
    on_f, on_n = row
    f = back(T.R, add(on_f, cross(on_n, T.p)))
    n = back(T.R, on_n)
    d = dot(w, wa)  # w x (wa x c) = wa (w . c) - (w . wa) c
    L = (
        (wa[0] * w[0] - d, wa[0] * w[1] - dw[2], wa[0] * w[2] + dw[1]),
        (wa[1] * w[0] + dw[2], wa[1] * w[1] - d, wa[1] * w[2] - dw[0]),
        (wa[2] * w[0] - dw[1], wa[2] * w[1] + dw[0], wa[2] * w[2] - d),
    )
    columns = [(L[0][k], L[1][k], L[2][k]) for k in range(3)]
    lever = cross(a, n)  # n . (c x a) = c . (a x n)
    once = [dot(f, columns[k]) + lever[k] for k in range(3)]
    # n . (c x L c) = sum c_i c_k (e_i x L e_k) . n = sum c_i c_k (L e_k x n)_i
    twice = [cross(column, n) for column in columns]
    spin = cross(n, wa)  # n . (wa x I w) = (n x wa) . I w
    result = [dot(f, a), *once]
    bent = dot(n, cross(w, wa))
    for i, k in PAIRS:
        if framed:
            result.append(bent if i == k else arb(0))
        else:
            result.append(twice[i][i] if i == k else twice[k][i] + twice[i][k])
    for i, k in PAIRS:
        entry = n[i] * dw[k] + spin[i] * w[k]
        result.append(entry if i == k else entry + n[k] * dw[i] + spin[k] * w[i])
    return result
