r"""The range of the torque as found by search: an inner bound, to hold the guaranteed one against.

It knows inverse dynamics at points of the box and nothing of the hull's formulas, only that the
torque is linear in masses, inertias and drives and quadratic in each body's centre of mass, and
that bodies do not mix. A few points then tell each body's share, its best point is searched for,
and what is returned is the torque at the points so found: attained, whatever the search missed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_array, as_truth
from modrobust.checks.types import Array
from modrobust.kernel import own_environment, status_error
from modrobust.model import Robot, check_robot, owner_of

_SWEEPS = 4
_PAIRS = ((0, 1), (0, 2), (1, 2))
_CORNERS = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])


@own_environment()
def found_range(
    robot: Robot,
    q: ArrayLike,
    dq: ArrayLike,
    dq_a: ArrayLike,
    ddq_a: ArrayLike,
    drives: bool = True,
) -> tuple[Array, Array]:
    r"""Smallest and largest torque of each joint that a search of the parameter box attains.

    Friction is that of the smooth law (20); the bounds also hold for true Coulomb friction, so
    that at speeds about ``coulomb_speed`` and below they are wider than what is found here.

    Args:
        robot: Robot with n joints.
        q: Joint positions of k states (k, n) [rad].
        dq: Joint velocities (k, n) [rad/s].
        dq_a: Auxiliary velocities (k, n) [rad/s].
        ddq_a: Auxiliary accelerations (k, n) [rad/s^2].
        drives: Whether friction (20) and reflected rotor inertia (21) are included.

    Returns:
        Torques (k, n), (k, n) [N m]; `inverse_dynamics_bounds` contain them.

    Raises:
        ShapeError: The arrays are not all (k, n).
        ValueRangeError: An entry is not finite, or an angle is beyond 1e5 rad.
    """
    check_robot(robot)
    shape = (*np.shape(q)[:1], robot.n)
    owner = owner_of(robot)
    named = {"q": q, "dq": dq, "dq_a": dq_a, "ddq_a": ddq_a}
    columns = (as_array(name, value, shape, owner) for name, value in named.items())
    states = list(zip(*columns, strict=True))
    drives = as_truth("drives", drives)
    box = _Box(robot)
    try:
        shares = np.array([box.torques(box.probes, state, drives) for state in states])
        best = box.best(shares)
        found = np.array([box.torques(t, s, drives) for t, s in zip(best, states, strict=True)])
    except _kernel.KernelError as problem:
        raise status_error(problem) from None
    return found.min(axis=1), found.max(axis=1)


def probe_count(robot: Robot) -> int:
    """Number of parameter points at which `found_range` evaluates one state."""
    return len(_Box(robot).probes) + 2 * robot.n


class _Box:
    """The box of parameters as t in [-1, 1] and the points of it that tell the shares apart."""

    def __init__(self, robot: Robot) -> None:
        self.model, self.b = robot.model, robot.b
        self.lower, self.upper = robot.lower.packed, robot.upper.packed
        self.middle = self.lower / 2 + self.upper / 2
        self.half = self.upper / 2 - self.lower / 2
        b, free = robot.b, self.half > 0.0
        self.bodies = np.flatnonzero(free[b : 4 * b].reshape(b, 3).any(axis=1))
        self.com = b + 3 * self.bodies[:, None] + np.arange(3)
        self.single = np.flatnonzero(free)
        size = len(self.half)
        eye = np.eye(size)
        pairs = [eye[self.com[:, i]] + eye[self.com[:, j]] for i, j in _PAIRS]
        self.probes = np.concatenate(
            [np.zeros((1, size)), eye[self.single], -eye[self.com.ravel()], *pairs]
        )

    def torques(self, points: Array, state: tuple[Array, ...], drives: bool) -> Array:
        """Torques at each point t of one state, (points, n)."""
        # rounding must not carry a point out of the box
        inside = np.clip(self.middle + self.half * points, self.lower, self.upper)
        q, dq, dq_a, ddq_a = state
        evaluate = _kernel.inverse_dynamics
        return np.array([evaluate(self.model, p, q, dq, dq_a, ddq_a, drives) for p in inside])

    def best(self, torques: Array) -> Array:
        """Where each joint's torque is largest and smallest: t (k, 2 n, ...) for (k, probes, n)."""
        k, _, n = torques.shape
        count, single = len(self.bodies), len(self.single)
        change = (torques[:, 1:] - torques[:, :1]).swapaxes(1, 2)  # (k, n, probes)
        up = np.zeros((k, n, len(self.half)))
        up[..., self.single] = change[..., :single]
        down, *pairs = np.split(change[..., single:], np.cumsum([3 * count, count, count]), axis=-1)
        plus, minus = up[..., self.com], down.reshape(k, n, count, 3)
        # the change g . t + t' A t that the centre of mass of each body makes
        g = (plus - minus) / 2
        A = np.zeros((*g.shape, 3))
        for i in range(3):
            A[..., i, i] = (plus[..., i] + minus[..., i]) / 2
        for (i, j), both in zip(_PAIRS, pairs, strict=True):
            A[..., i, j] = A[..., j, i] = (both - plus[..., i] - plus[..., j]) / 2
        out = []
        for sign in (1.0, -1.0):
            t = np.where(sign * up < 0.0, -1.0, 1.0)
            t[..., self.com], gain = _climb(sign * g, sign * A)
            # the mass multiplies that change, too
            ratio = self.half[self.bodies] / self.middle[self.bodies]
            heavier = sign * up[..., self.bodies] + ratio * gain
            t[..., self.bodies] = np.where(heavier < 0.0, -1.0, 1.0)
            out.append(t)
        return np.concatenate(out, axis=1)


def _climb(g: Array, A: Array) -> tuple[Array, Array]:
    """Highest point of g . t + t' A t over [-1, 1]^3 found by coordinate ascent from each corner.

    g (..., 3), A (..., 3, 3) symmetric; returns points (..., 3) and values (...).
    """
    t = np.broadcast_to(_CORNERS, (*g.shape[:-1], *_CORNERS.shape)).copy()
    for _ in range(_SWEEPS):
        for k in range(3):
            bend = A[..., None, k, k]
            i, j = (k + 1) % 3, (k + 2) % 3
            across = A[..., None, k, i] * t[..., i] + A[..., None, k, j] * t[..., j]
            slope = g[..., None, k] + 2.0 * across
            concave = bend < 0.0
            inside = np.clip(slope / np.where(concave, -2.0 * bend, 1.0), -1.0, 1.0)
            t[..., k] = np.where(concave, inside, np.where(slope < 0.0, -1.0, 1.0))
    value = np.einsum("...cj,...cj->...c", t, g[..., None, :] + t @ A)
    best = value.argmax(axis=-1)[..., None]
    return (
        np.take_along_axis(t, best[..., None], axis=-2)[..., 0, :],
        np.take_along_axis(value, best, axis=-1)[..., 0],
    )
