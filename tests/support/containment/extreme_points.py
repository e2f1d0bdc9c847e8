"""Points of a parameter box: those that drive one joint's torque to its ends, and random ones.

The hull is the range itself (but at speeds of at most v_c, (20)), so that these points touch it:
whatever rounding took from a bound shows. They are found in doubles from the exact coefficients; a
point that is a little off the best is still a point of the box.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from flint import arb

from modrobust.model import Robot
from support.containment.ball_dynamics import MONOMIALS, Coefficients

CORNERS = np.array(list(product((0, 1), repeat=3)), dtype=bool)  # (8, 3)


def sign_options(robot: Robot, rows: Coefficients) -> list[list[arb]]:
    """For each joint the signs that (20) allows: smooth and sgn(dq), or any where |dq| <= v_c."""
    options = []
    speeds = robot.coulomb_speed.tolist()
    for dq, smooth, v_c in zip(rows.dq, rows.smooth_sign, speeds, strict=True):
        slow = bool(abs(dq) < 0.999 * v_c)  # decided in balls; faster, dq is not 0
        options.append([smooth, arb(1), arb(-1)] if slow else [smooth, arb(1 if dq > 0 else -1)])
    return options


def parameter_points(
    rng: np.random.Generator, robot: Robot, rows: Coefficients, most: int
) -> tuple[Any, list[list[arb]]]:
    """Packed points (k, 10 b + 3 j) and the signs of their Coulomb friction (k, j).

    Nominal, corners and interior with random signs, then both extremes of some joints.
    """
    lower, upper = robot.lower.packed, robot.upper.packed
    joints = np.arange(robot.n)
    if 2 * robot.n > most:
        joints = rng.choice(joints, most // 2, replace=False)
    inside = np.clip(lower + rng.random((4, len(lower))) * (upper - lower), lower, upper)
    corners = [robot.corner_parameters(rng).packed for _ in range(2)]
    points = [robot.nominal.packed, *corners, *inside]
    options = sign_options(robot, rows)
    signs = [[option[rng.integers(len(option))] for option in options] for _ in points]
    bodies = np.array([[float(x) for x in rows.bodies[i]] for i in joints])
    bodies = bodies.reshape(len(joints), -1, MONOMIALS)
    drives = np.array([[float(x) for x in rows.drives[i]] for i in joints])
    drives = drives.reshape(len(joints), -1, 3)
    with np.errstate(all="ignore"):
        for upwards in (1.0, -1.0):
            heavy = _extreme_bodies(robot, upwards * bodies)
            stiff, chosen = _extreme_drives(robot, upwards * drives, options)
            points += list(np.concatenate([heavy, stiff], axis=1))
            signs += chosen
    return np.array(points), signs


def _extreme_bodies(robot: Robot, f: Any) -> Any:
    """mass, com and inertia of largest torque under coefficients f (rows, b', 16)."""
    lower, nominal, upper = robot.lower, robot.nominal, robot.upper
    moving = robot.body_joints >= 0
    full = [
        np.repeat(values[None], len(f), axis=0)
        for values in (nominal.mass, nominal.com, _six(nominal.inertia))
    ]
    full[0][:, moving], full[1][:, moving] = _mass_and_com(
        f,
        (lower.mass[moving], nominal.mass[moving], upper.mass[moving]),
        (lower.com[moving], nominal.com[moving], upper.com[moving]),
    )
    ends = (_six(point.inertia[moving]) for point in (upper, lower))
    full[2][:, moving] = np.where(f[..., 10:] >= 0.0, *ends)
    return np.concatenate([x.reshape(len(f), -1) for x in full], axis=1)


def _extreme_drives(robot: Robot, f: Any, options: list[list[arb]]) -> tuple[Any, list[list[arb]]]:
    """Rotor inertia, viscous, coulomb of largest torque under f (rows, j, 3); and the signs."""
    up = f >= 0.0
    lower, upper = robot.lower, robot.upper
    rotor = np.where(up[..., 2], upper.rotor_inertia, lower.rotor_inertia)
    viscous = np.where(up[..., 0], upper.viscous, lower.viscous)
    ends = [(max(option, key=float), min(option, key=float)) for option in options]
    signs = [[end[not x] for end, x in zip(ends, row, strict=True)] for row in up[..., 1]]
    pushing = np.array([[float(x) for x in row] for row in signs]).reshape(f.shape[:2])
    coulomb = np.where((pushing >= 0.0) == up[..., 1], upper.coulomb, lower.coulomb)
    return np.concatenate([rotor, viscous, coulomb], axis=1), signs


def _mass_and_com(f: Any, mass: Any, com: Any) -> tuple[Any, Any]:
    """Mass and COM of largest m (k + g . c + c' Q c): ascent along the axes from every corner."""
    (m_lo, m0, m_hi), (c_lo, c0, c_hi) = mass, com
    Q = np.empty((*f.shape[:-1], 3, 3))
    for at, (i, k) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
        Q[..., i, k] = Q[..., k, i] = f[..., 4 + at] * (1.0 if i == k else 0.5)
    slope = f[..., 1:4] + 2.0 * np.einsum("jbik,bk->jbi", Q, c0)  # at the nominal com
    at_nominal = (
        f[..., 0]
        + np.einsum("jbi,bi->jb", f[..., 1:4], c0)
        + np.einsum("bi,jbik,bk->jb", c0, Q, c0)
    )
    shape = (8, *f.shape[:2], 3)
    c = np.where(CORNERS[:, None, None, :], c_hi, c_lo) * np.ones(shape)
    for axis in (0, 1, 2, 0, 1):
        d = c - c0
        d[..., axis] = 0.0
        b = slope[..., axis] + 2.0 * np.einsum("jbk,sjbk->sjb", Q[..., axis, :], d)
        a = Q[..., axis, axis]
        still = np.nan_to_num(-b / (2.0 * a)) + c0[:, axis]
        still = np.clip(still, c_lo[:, axis], c_hi[:, axis])
        ends = np.stack([np.broadcast_to(x, b.shape) for x in (c_lo[:, axis], c_hi[:, axis])])
        choices = np.concatenate([ends, still[None]])
        x = choices - c0[:, axis]
        best = np.argmax(b * x + a * x * x, axis=0)
        c[..., axis] = np.take_along_axis(choices, best[None], axis=0)[0]
    d = c - c0
    gain = np.einsum("jbi,sjbi->sjb", slope, d) + np.einsum("sjbi,jbik,sjbk->sjb", d, Q, d)
    start = np.argmax(np.nan_to_num(gain, nan=-np.inf), axis=0)
    c = np.take_along_axis(c, start[None, ..., None], axis=0)[0]
    gain = np.take_along_axis(gain, start[None], axis=0)[0]
    values = [(m - m0) * at_nominal + m * gain for m in (m_lo, m_hi)]
    return np.where(values[0] > values[1], m_lo, m_hi), c


def _six(inertia: Any) -> Any:
    return inertia[..., (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)]


def monomials(
    robot: Robot, packed: Any, rows: Coefficients, signs: list[arb]
) -> tuple[list[Any], list[Any], list[Any]]:
    """The point's vectors for the rows of `Coefficients`, exact.

    Bodies (16 b'), drives (3 j) with the given signs of Coulomb friction, and with the smooth law.
    """
    b, j = robot.b, robot.j
    mass, com = packed[:b].tolist(), packed[b : 4 * b].reshape(b, 3).tolist()
    six = packed[4 * b : 10 * b].reshape(b, 6).tolist()
    rotor, viscous, coulomb = packed[10 * b :].reshape(3, j).tolist()
    bodies: list[Any] = []
    for k, joint in enumerate(robot.body_joints.tolist()):
        if joint < 0:
            continue
        m = arb(mass[k])
        x, y, z = (arb(value) for value in com[k])
        mx, my, mz = m * x, m * y, m * z
        bodies += [m, mx, my, mz, mx * x, mx * y, mx * z, my * y, my * z, mz * z]
        bodies += six[k]
    drives: list[Any] = []
    smooth: list[Any] = []
    for i in range(j):
        drives += [viscous[i], signs[i] * coulomb[i], rotor[i]]
        smooth += [viscous[i], rows.smooth_sign[i] * coulomb[i], rotor[i]]
    return bodies, drives, smooth
