r"""Whether M(q) > 0 at a point of the parameters, and the way back to nominal until it is.

Bodies whose masses and principal moments are not negative have no negative kinetic energy, so that
M(q) is positive semidefinite at every q. Whether it is regular is looked at where that is not
plain: at a number of seeded poses, which is an estimate and no proof for all of them.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.model.parameters import Parameters

POSES = 16
_SEED = 0
_HALVES = 60
_RELATIVE = 1e-12  # of the joint's own diagonal entry: what rounding leaves of a zero pivot
_ABSOLUTE = 1e-15  # of the largest diagonal entry


def singular_joint(M: Array) -> int | None:
    """The joint of the first pivot, from the last joint on, that vanishes; None if M > 0."""
    A = np.array(M)
    floor = _ABSOLUTE * float(np.max(np.diag(A)))
    for i in range(len(A) - 1, -1, -1):
        if not A[i, i] > max(_RELATIVE * M[i, i], floor):
            return i
        A[:i, :i] -= np.outer(A[i, :i], A[i, :i]) / A[i, i]
    return None


def seeded_poses(position_limits: Array) -> Array:
    """Poses ``(POSES, n)`` within limits ``(n, 2)``; within +-1 rad or m where they are endless."""
    lo = np.where(np.isfinite(position_limits[:, 0]), position_limits[:, 0], -1.0)
    hi = np.where(np.isfinite(position_limits[:, 1]), position_limits[:, 1], 1.0)
    lo, hi = np.minimum(lo, hi), np.maximum(lo, hi)
    poses: Array = np.random.default_rng(_SEED).uniform(lo, hi, (POSES, len(lo)))
    return poses


def is_definite(model: _kernel.Model, point: Parameters, poses: Array) -> bool:
    """Whether M(q) > 0, drives included, at every one of the poses ``(k, n)``."""
    for q in poses:
        try:
            M = _kernel.mass_matrix(model, point.packed, q, True)
        except _kernel.KernelError:  # an angle out of range, or figures whose products are
            continue
        if singular_joint(M) is not None:
            return False
    return True


def pulled_to_definite(
    model: _kernel.Model, nominal: Parameters, point: Parameters, poses: Array
) -> Parameters:
    """The point, or the first on the way to nominal, halved each time, at which M(q) > 0."""
    for k in range(_HALVES):
        tried = between(nominal, point, 0.5**k)
        if is_definite(model, tried, poses):
            return tried
    return nominal


def between(nominal: Parameters, point: Parameters, share: float) -> Parameters:
    """The point ``nominal + share (point - nominal)``, each entry between those of both."""
    if share == 1.0:
        return point
    found = {}
    for name in (item.name for item in fields(Parameters)):
        a, b = getattr(nominal, name), getattr(point, name)
        # Clipped, since rounding could carry an entry beyond the box.
        found[name] = np.clip(a + share * (b - a), np.minimum(a, b), np.maximum(a, b))
    return Parameters(**found)
