r"""How much heavier or lighter than a model the robot can be: ranges of eigenvalues.

.. math:: [\pi_1, \pi_2] \ni \lambda\left(M(q,\Delta)^{-1} M_s(q)\right), \qquad
          [c_1, c_2] \ni \lambda\left(M(q,\Delta)^{-1} M_c(q)\right), \qquad
          \xi_1 = \min_q \lambda\left(M_c^{-1} M_s\right)                          \quad (36)

The ends are estimates: they are found at points of the box, so the true ranges are at least as
wide. An extreme eigenvector v of one point says in which direction to look; v'M v is linear in
(m, m c, I_o), so the vertex that raises or lowers it is known, and its own eigenvector is the next
direction. This climbs until it stays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modrobust.checks.types import Array
from modrobust.design.box import Box, Lifted, lifted
from modrobust.design.twists import jacobians, kinetic_weights, mass_matrices, spatial
from modrobust.model import Parameters, Robot

_CLIMBS = 3
_KEPT = 2  # directions a position that are followed


@dataclass(frozen=True)
class Spectra:
    """Estimates of (36), each ``(least, largest)`` [1]."""

    light: tuple[float, float]
    """pi_1, pi_2: eigenvalues of M(q, Delta)^-1 M_s."""
    centre: tuple[float, float]
    """c_1, c_2: eigenvalues of M(q, Delta)^-1 M_c."""
    least_share: float
    """xi_1: least eigenvalue of M_c^-1 M_s."""

    @property
    def spread(self) -> float:
        """pi_2 / pi_1: how far apart the heaviest and the lightest robot are."""
        return self.light[1] / self.light[0]


def spectra(robot: Robot, central: Parameters, light: Parameters, positions: Array) -> Spectra:
    """Ranges over the box and the positions ``(k, n)``, found by directed steps.

    Args:
        robot: Its bounds are the box.
        central: D_c of (30).
        light: D_s of (30).
        positions: Where M is looked at, ``(k, n)`` [rad] or [m].

    Source: our own; (36) of docs/theory/equations.md.
    """
    J = jacobians(robot, positions)
    box = Box(robot)
    tried = lifted(robot, [central, robot.nominal])
    M_c, M_s = (_at(robot, J, lifted(robot, [point]))[:, 0] for point in (central, light))
    return Spectra(
        _range(robot, J, box, tried, M_s),
        _range(robot, J, box, tried, M_c),
        float(np.linalg.eigvalsh(_relative(_inverse_factors(M_c), M_s)).min()),
    )


def _range(
    robot: Robot, J: Array, box: Box, tried: Lifted, reference: Array
) -> tuple[float, float]:
    """Least and largest eigenvalue of M^-1 reference, (k, n, n)."""
    root = _inverse_factors(reference)[:, None]
    values, vectors = _eigen(root, _at(robot, J, tried))  # of reference^-1 M
    start = np.swapaxes(vectors[:, 0], -1, -2)  # all n of the centre, one a row
    ends = []
    for sign in (-1.0, 1.0):  # a light robot has the least
        directions = start
        best = (sign * values).max(axis=(1, 2))
        for _ in range(_CLIMBS):
            d = directions.shape[1]
            back = np.einsum("kab,kda->kdb", root[:, 0], directions)  # v = L^-T w
            found = box.extreme(kinetic_weights(robot, J, back), sign)
            M = _at(robot, J, found, d)
            reached, moved = _eigen(root, M)
            column = -1 if sign > 0.0 else 0
            extreme = sign * reached[..., column]  # (k, d)
            best = np.maximum(best, extreme.max(axis=1))
            order = np.argsort(-extreme, axis=1, kind="stable")[:, :_KEPT]
            chosen = moved[..., column]  # (k, d, n)
            directions = np.take_along_axis(chosen, order[..., None], axis=1)
        ends.append(float(sign * best.max()))
    least, most = ends
    return 1.0 / most, 1.0 / least if least > 0.0 else np.inf


def _at(robot: Robot, J: Array, points: Lifted, d: int | None = None) -> Array:
    """M (k, d, n, n): of d points at every position, or of k d points, d of them at each."""
    k = len(J)
    blocks = spatial(points.mass, points.moment, points.inertia)
    rotor = points.rotor
    if d is None:
        blocks = np.broadcast_to(blocks, (k, *blocks.shape))
        rotor = np.broadcast_to(rotor, (k, *rotor.shape))
    else:
        blocks = blocks.reshape(k, d, *blocks.shape[1:])
        rotor = rotor.reshape(k, d, -1)
    return mass_matrices(robot, J, blocks, rotor)


def _inverse_factors(M: Array) -> Array:
    return np.asarray(np.linalg.inv(np.linalg.cholesky(M)))


def _relative(root: Array, M: Array) -> Array:
    """L^-1 M L^-T, made symmetric."""
    W = root @ M @ np.swapaxes(root, -1, -2)
    return np.asarray(0.5 * (W + np.swapaxes(W, -1, -2)))


def _eigen(root: Array, M: Array) -> tuple[Array, Array]:
    values, vectors = np.linalg.eigh(_relative(root, M))
    return values, vectors
