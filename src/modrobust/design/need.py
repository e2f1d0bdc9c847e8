r"""How hard what is unknown can push the joints, as an acceleration: b of (38).

.. math::
   b = 2 \max \left( \lVert M_s^{-1} (\mathrm{NE}(\Delta) - \mathrm{NE}(\Delta_c)) \rVert
       + \lVert |M_s^{-1}|\, f \rVert \right) + \max \lVert |M_s^{-1}|\,|d| \rVert

over states and box, f half the width of what friction can be. The first norm is searched for with
directed steps as in `modrobust.design.spectra`; an estimate, whence the 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modrobust.checks.types import Array
from modrobust.design.box import Box, Lifted, lifted
from modrobust.design.states import MotionStates
from modrobust.design.twists import Weights, jacobians, motion, selection, torque_weights
from modrobust.model import Parameters, Robot

_CLIMBS = 2
_KEPT = 2  # directions a state that are followed


@dataclass(frozen=True)
class Need:
    """Largest accelerations that the causes can give [rad/s^2] or [m/s^2], norms over joints."""

    parameters: float
    """Of masses, centres of mass, tensors and rotor inertias."""
    friction: float
    """Of viscous and Coulomb friction."""
    disturbance: float
    """Of [d]."""
    total: float
    """b of (38)."""


def need(robot: Robot, central: Parameters, light_mass: Array, states: MotionStates) -> Need:
    """The accelerations for a robot in k states.

    Args:
        robot: Its bounds are the box.
        central: D_c of (30).
        light_mass: M_s at the states, ``(k, n, n)``.
        states: Where NE is looked at.

    Source: our own; (38) of docs/theory/equations.md.
    """
    inverse = np.asarray(np.linalg.inv(light_mass), dtype=np.float64)
    rigid = _rigid(robot, central, inverse, states)
    G = selection(robot)
    half = [
        0.5 * (getattr(robot.upper, x) - getattr(robot.lower, x)) for x in ("viscous", "coulomb")
    ]
    friction = (np.abs(states.dq @ G.T) * half[0] + half[1]) @ np.abs(G)
    d = np.maximum(np.abs(robot.disturbance.lo), np.abs(robot.disturbance.hi))
    rubbed, pushed = (
        np.linalg.norm(
            np.einsum("kij,kj->ki", np.abs(inverse), np.broadcast_to(x, states.q.shape)), axis=1
        )
        for x in (friction, d)
    )
    total = 2.0 * float((rigid + rubbed).max()) + float(pushed.max())
    return Need(float(rigid.max()), float(rubbed.max()), float(pushed.max()), total)


def _rigid(robot: Robot, central: Parameters, inverse: Array, states: MotionStates) -> Array:
    """Largest norm found in each state (k,)."""
    k, n = states.q.shape
    J = jacobians(robot, states.q)
    moved = motion(robot, states.q, states.dq, states.ddq)
    axes = np.broadcast_to(np.eye(n), (k, n, n))
    regressor = flat(torque_weights(robot, J, moved, states.ddq, axes)).reshape(k, n, -1)
    box, centre = Box(robot), flat(lifted(robot, [central]))
    directions = np.concatenate([axes, -axes], axis=1)  # of the acceleration
    best = np.zeros(k)
    for _ in range(_CLIMBS):
        d = directions.shape[1]
        back = directions @ inverse  # M_s is symmetric
        found = box.extreme(torque_weights(robot, J, moved, states.ddq, back), 1.0)
        off = (flat(found) - centre).reshape(k, d, -1)
        pushed = off @ np.swapaxes(regressor, 1, 2) @ inverse  # (k, d, n)
        size = np.linalg.norm(pushed, axis=2)
        best = np.maximum(best, size.max(axis=1))
        order = np.argsort(-size, axis=1, kind="stable")[:, :_KEPT, None]
        chosen = np.take_along_axis(pushed, order, axis=1)
        directions = (
            chosen / np.maximum(np.take_along_axis(size, order[..., 0], axis=1), 1e-300)[..., None]
        )
    return best


def flat(parts: Weights | Lifted) -> Array:
    """One row a point, ``(x, 13 b + j)``: a linear function of a point is a product of rows."""
    rows = len(parts.mass)
    return np.concatenate(
        [x.reshape(rows, -1) for x in (parts.mass, parts.moment, parts.inertia, parts.rotor)],
        axis=1,
    )
