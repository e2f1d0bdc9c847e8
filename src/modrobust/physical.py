r"""Which inertia tensors a body can have, and how a tensor is pulled to the nearest one it can.

A tensor J about the COM belongs to a distribution of positive mass exactly when the matrix of
second moments is positive semidefinite,

.. math:: \Sigma = \tfrac{1}{2} \operatorname{tr}(J)\, 1 - J \succeq 0,

which says that J is positive semidefinite and that its principal moments keep the triangle
inequality. The set is convex: between a physical tensor and any other there is a last physical one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from modrobust.symmetric import eigenvalues

Array = NDArray[np.float64]

_ROUNDING = 1e-15  # of the trace: what the eigenvalues of an exact boundary case are off by
_ROUNDS = 10  # of cutting the way that is left into 64 parts: 60 binary digits
_BETWEEN = np.arange(1.0, 64.0) / 64.0


def least_second_moment(inertia: Array) -> Array:
    """Least eigenvalue of tr(J)/2 1 - J [kg m^2]; inertia ``(..., 3, 3)`` gives ``(...)``."""
    trace = _trace(inertia)
    sigma = 0.5 * trace[..., None, None] * np.eye(3) - inertia
    least: Array = eigenvalues(sigma)[..., 0]
    return least


def is_physical(inertia: Array, nominal: Array) -> NDArray[np.bool_]:
    """Whether tensors ``(..., 3, 3)`` are physical, or at least no less so than the nominal one.

    A thin rod lies on the boundary of the physical set and the rounding of its figures may put it a
    little outside; its own box must still hold points. Hence the comparison with `nominal`, of a
    shape that broadcasts against `inertia`.
    """
    trace = _trace(inertia)
    allowed = np.minimum(0.0, least_second_moment(nominal)) - _ROUNDING * np.abs(trace)
    result: NDArray[np.bool_] = least_second_moment(inertia) >= allowed
    return result


def pull_to_physical(nominal: Array, inertia: Array) -> Array:
    """The last physical tensor ``(3, 3)`` on the straight way from nominal to `inertia`."""
    lo, hi = 0.0, 1.0
    for _ in range(_ROUNDS):
        at = lo + (hi - lo) * _BETWEEN
        inside = is_physical(nominal + at[:, None, None] * (inertia - nominal), nominal)
        first = len(at) if inside.all() else int(np.argmin(inside))  # of those outside
        ends = [lo, *at.tolist(), hi]
        lo, hi = ends[first], ends[first + 1]
    pulled = nominal + lo * (inertia - nominal)
    # Clipped, since rounding could carry an entry beyond the tensor it was pulled from.
    result: Array = np.clip(pulled, np.minimum(nominal, inertia), np.maximum(nominal, inertia))
    return result


def _trace(tensors: Array) -> Array:
    """Summed in order, so that it has the same bits on every machine."""
    xx, yy, zz = (tensors[..., i, i] for i in range(3))
    return np.asarray(xx + yy + zz)
