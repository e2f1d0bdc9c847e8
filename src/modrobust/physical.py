r"""Which inertia tensors a body can have, and how a tensor is pulled to the nearest one it can.

A tensor J about the COM belongs to a distribution of positive mass exactly when the matrix of
second moments is positive semidefinite,

.. math:: \Sigma = \tfrac{1}{2} \operatorname{tr}(J)\, 1 - J \succeq 0,

which says that J is positive semidefinite and that its principal moments keep the triangle
inequality. The set is convex: between a physical tensor and any other there is a last physical one.

What the control law needs is less: a mass matrix that is positive definite. That holds where no
mass and no principal moment is negative and every joint moves something, so that figures which are
a little unphysical, as published ones are, can be taken as written.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TRIANGLE = 1e-9  # relative: flat bodies lie on the boundary, printed figures just beside it
_ROUNDING = 1e-15  # of the trace: what the eigenvalues of an exact boundary case are off by
_BISECTIONS = 60


def least_second_moment(inertia: Array) -> Array:
    """Least eigenvalue of tr(J)/2 1 - J [kg m^2]; inertia ``(..., 3, 3)`` gives ``(...)``."""
    trace = np.trace(inertia, axis1=-2, axis2=-1)
    sigma = 0.5 * trace[..., None, None] * np.eye(3) - inertia
    least: Array = np.linalg.eigvalsh(sigma)[..., 0]
    return least


def least_moment(inertia: Array) -> Array:
    """Least principal moment [kg m^2]; inertia ``(..., 3, 3)`` gives ``(...)``."""
    trace = np.trace(inertia, axis1=-2, axis2=-1)
    return least_second_moment(trace[..., None, None] * np.eye(3) - inertia)


def is_physical(inertia: Array, nominal: Array) -> NDArray[np.bool_]:
    """Whether tensors ``(..., 3, 3)`` are physical, or at least no less so than the nominal one.

    A thin rod lies on the boundary of the physical set and the rounding of its figures may put it a
    little outside; its own box must still hold points. Hence the comparison with `nominal`, of a
    shape that broadcasts against `inertia`: the least second moment is at least its, or 0. Where
    its is negative, the least principal moment is at least its, or 0, too, so that no sampled body
    has less kinetic energy than none.
    """
    trace = np.abs(np.trace(inertia, axis1=-2, axis2=-1))
    lacking = np.minimum(0.0, least_second_moment(nominal))
    second = least_second_moment(inertia) >= lacking - _ROUNDING * trace
    least = np.minimum(0.0, least_moment(nominal)) - 4.0 * _ROUNDING * trace
    result: NDArray[np.bool_] = second & ((lacking == 0.0) | (least_moment(inertia) >= least))
    return result


def excess(mass: Array, inertia: Array) -> Array:
    r"""By how much bodies are beyond the triangle inequality, relative.

    .. math:: \frac{J_3}{J_1 + J_2} - 1, \quad J_1 \le J_2 \le J_3

    Args:
        mass: Masses ``(b,)`` [kg].
        inertia: Tensors about the COM ``(b, 3, 3)`` [kg m^2].

    Returns:
        ``(b,)``: 0 where a body is physical (to 1e-9), infinite where it has a moment about one
        axis alone, or a tensor without mass.
    """
    half = 0.5 * np.trace(inertia, axis1=-2, axis2=-1)
    least = least_second_moment(inertia)
    largest, others = half - least, half + least
    beyond = -2.0 * least > TRIANGLE * largest
    alone = beyond & (others <= TRIANGLE * largest)
    massless = (mass == 0.0) & inertia.any(axis=(-2, -1))
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = largest / others - 1.0
    found: Array = np.where(beyond, relative, 0.0)
    return np.where(alone | massless, np.inf, found)


def pull_to_physical(nominal: Array, inertia: Array) -> Array:
    """The last physical tensor ``(3, 3)`` on the straight way from nominal to `inertia`."""
    lo, hi = 0.0, 1.0
    for _ in range(_BISECTIONS):
        mid = 0.5 * (lo + hi)
        inside = bool(is_physical(nominal + mid * (inertia - nominal), nominal))
        lo, hi = (mid, hi) if inside else (lo, mid)
    pulled = nominal + lo * (inertia - nominal)
    # Clipped, since rounding could carry an entry beyond the tensor it was pulled from.
    result: Array = np.clip(pulled, np.minimum(nominal, inertia), np.maximum(nominal, inertia))
    return result
