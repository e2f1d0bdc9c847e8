r"""How bodies move with the joints: their Jacobians, and what they ask of the joints linearly.

.. math::
   M(q, \Delta) &= \sum_b J_b^T \begin{bmatrix} I_o & [h]_\times \\ -[h]_\times & m \end{bmatrix}
     J_b + k^2 I_m, \qquad h = m c \\
   \delta^T \mathrm{NE} &= \sum_b \alpha\,m + g^T h + \langle W, I_o \rangle + \text{drives}

J_b has rows :math:`\omega, \nu` (angular velocity and velocity of the body frame's origin, both in
body axes) for unit joint rates. Everything is linear in (m, h, I_o), which is what the search for
extreme points of the box rests on; see docs/theory/equations.md, (16) and (17).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array, Ints
from modrobust.model import Robot

_STEP = 1e-5  # [s]: of the difference that gives the rate of a Jacobian


@dataclass(frozen=True)
class Weights:
    """What a linear function of the box counts of each body and drive, for x directions."""

    mass: Array
    """alpha, ``(x, b)``."""
    moment: Array
    """g, ``(x, b, 3)``."""
    inertia: Array
    """W, symmetric, ``(x, b, 3, 3)``."""
    rotor: Array
    """Of I_m, ``(x, j)``."""


@dataclass(frozen=True)
class LinkMotion:
    """Velocities and accelerations of the b moving bodies in k states, in body axes."""

    omega: Array
    """``(k, b, 3)`` [rad/s]."""
    alpha: Array
    """Rate of omega, ``(k, b, 3)`` [rad/s^2]."""
    acceleration: Array
    """Of the body frame's origin, minus gravity, ``(k, b, 3)`` [m/s^2]."""


def moving(robot: Robot) -> Ints:
    """Indices of the bodies that a joint moves."""
    return np.flatnonzero(robot.body_joints >= 0).astype(np.int32)


def selection(robot: Robot) -> Array:
    """G of (15): rates of the joints (j, n) for those of the free ones."""
    f = robot.mimic
    G = np.zeros((robot.j, robot.n))
    G[robot.free, np.arange(robot.n)] = 1.0
    G[f.joints, f.leaders] = f.multiplier
    return G


def jacobians(robot: Robot, positions: Array) -> Array:
    """J_b of the moving bodies, rows omega and nu in body axes, ``(k, b, 6, n)``.

    Args:
        robot: Robot with n joints.
        positions: ``(k, n)`` [rad] or [m].
    """
    which = moving(robot)
    on = robot.body_joints[which]
    frames = np.array([_kernel.forward_kinematics(robot.model, q) for q in positions])
    base = np.broadcast_to(np.eye(4), (len(positions), 1, 4, 4))
    parents = np.concatenate([frames, base], axis=1)[:, robot.parents] @ robot.before
    axes, origins = parents[..., :3, 2], parents[..., :3, 3]  # (k, j, 3)
    bodies = frames[:, on] @ robot.placement[which]
    turn, place = bodies[..., :3, :3], bodies[..., :3, 3]
    lever = place[:, :, None] - origins[:, None]
    turns = robot.turns[None, None, :, None]
    axis = np.broadcast_to(axes[:, None], lever.shape)
    omega = np.where(turns, axis, 0.0)
    nu = np.where(turns, np.cross(axis, lever), axis)
    carried = _ancestors(robot)[on][None, :, :, None]
    world = np.stack([omega, nu], axis=2) * carried[:, :, None]  # (k, b, 2, j, 3)
    inside = world @ turn[:, :, None]  # rows x' R are R' x
    columns = np.swapaxes(inside, -1, -2) @ selection(robot)
    return np.asarray(columns.reshape(*columns.shape[:2], 6, robot.n))


def motion(robot: Robot, q: Array, dq: Array, ddq: Array) -> LinkMotion:
    """Velocities and accelerations of the moving bodies in states (k, n)."""
    ahead, behind = (jacobians(robot, q + sign * _STEP * dq) for sign in (1.0, -1.0))
    J = jacobians(robot, q)
    rate = (ahead - behind) / (2.0 * _STEP)
    twist = np.einsum("kbin,kn->kbi", J, dq)
    change = np.einsum("kbin,kn->kbi", J, ddq) + np.einsum("kbin,kn->kbi", rate, dq)
    omega, nu = twist[..., :3], twist[..., 3:]
    return LinkMotion(
        omega, change[..., :3], change[..., 3:] + np.cross(omega, nu) - _gravity(robot, q)
    )


def kinetic_weights(robot: Robot, J: Array, directions: Array) -> Weights:
    """Of v'M v for directions (k, d, n): x = k d rows."""
    k, d, n = directions.shape
    twist = np.einsum("kbin,kdn->kdbi", J, directions).reshape(k * d, -1, 6)
    omega, nu = twist[..., :3], twist[..., 3:]
    rates = (directions.reshape(k * d, n) @ selection(robot).T) * robot.gear_ratio
    return Weights(
        (nu * nu).sum(-1),
        2.0 * np.cross(nu, omega),
        omega[..., :, None] * omega[..., None, :],
        rates * rates,
    )


def torque_weights(
    robot: Robot, J: Array, found: LinkMotion, ddq: Array, directions: Array
) -> Weights:
    """Of delta' NE without friction, for directions (k, d, n) in k states: x = k d rows."""
    k, d, _ = directions.shape
    twist = np.einsum("kbin,kdn->kdbi", J, directions)
    turn, shift = twist[..., :3], twist[..., 3:]
    omega, alpha, a = (x[:, None] for x in (found.omega, found.alpha, found.acceleration))
    along = (shift * omega).sum(-1, keepdims=True)
    square = (omega * omega).sum(-1, keepdims=True)
    moment = np.cross(shift, alpha) + omega * along - shift * square + np.cross(a, turn)
    W = turn[..., :, None] * alpha[..., None, :]
    W = W + np.cross(turn, omega)[..., :, None] * omega[..., None, :]
    W = 0.5 * (W + np.swapaxes(W, -1, -2))
    G = selection(robot)
    rotor = (directions @ G.T) * (ddq @ G.T)[:, None] * robot.gear_ratio**2
    mass = (shift * a).sum(-1)
    b = mass.shape[2]
    return Weights(
        mass.reshape(k * d, b),
        moment.reshape(k * d, b, 3),
        W.reshape(k * d, b, 3, 3),
        rotor.reshape(k * d, robot.j),
    )


def spatial(mass: Array, moment: Array, inertia: Array) -> Array:
    """The 6 x 6 blocks of M's sum for (m, h, I_o) of shapes (...), (..., 3), (..., 3, 3)."""
    block = np.zeros((*mass.shape, 6, 6))
    block[..., :3, :3] = inertia
    x, y, z = moment[..., 0], moment[..., 1], moment[..., 2]
    for row, column, value in ((2, 1, x), (0, 2, y), (1, 0, z)):
        block[..., row, 3 + column] = block[..., 3 + column, row] = value
        block[..., column, 3 + row] = block[..., 3 + row, column] = -value
    for i in range(3, 6):
        block[..., i, i] = mass
    return block


def mass_matrices(robot: Robot, J: Array, blocks: Array, rotor: Array) -> Array:
    """M (k, d, n, n) at k positions for blocks (k, d, b, 6, 6) and rotor inertias (k, d, j)."""
    k, b, _, n = J.shape
    moved = blocks @ J[:, None]  # (k, d, b, 6, n)
    d = moved.shape[1]
    left = np.ascontiguousarray(np.moveaxis(J, 3, 1)).reshape(k, 1, n, b * 6)
    bodies = left @ moved.reshape(k, d, b * 6, n)
    G = selection(robot)
    drives = np.swapaxes(G, 0, 1) @ ((rotor * robot.gear_ratio**2)[..., None] * G)
    return np.asarray(bodies + drives)


def _ancestors(robot: Robot) -> Array:
    """Which joints (j, j) carry the link of which: themselves and all before them."""
    carried = np.eye(robot.j)
    for i, parent in enumerate(robot.parents):
        if parent >= 0:
            carried[i] += carried[parent]
    return carried


def _gravity(robot: Robot, positions: Array) -> Array:
    """Gravity in the axes of the moving bodies (k, b, 3) [m/s^2]."""
    which = moving(robot)
    frames = np.array([_kernel.forward_kinematics(robot.model, q) for q in positions])
    turn = (frames[:, robot.body_joints[which]] @ robot.placement[which])[..., :3, :3]
    return np.asarray((robot.base[:3, :3].T @ robot.gravity) @ turn)
