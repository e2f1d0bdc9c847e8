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

from collections.abc import Callable

import numpy as np

from modrobust.checks.types import Array, Flags
from modrobust.model.symmetric import eigenvalues

ABOUT_COM, ABOUT_FRAME = "com", "frame"  # what a body's tensors are about
TRIANGLE = 1e-9  # relative: flat bodies lie on the boundary, printed figures just beside it
_ROUNDING = 1e-15  # of the trace: what the eigenvalues of an exact boundary case are off by
_ROUNDS = 10  # of cutting the way that is left into 64 parts: 60 binary digits
_BETWEEN = np.arange(1.0, 64.0) / 64.0


def steiner(mass: Array, com: Array) -> Array:
    """``m (c'c 1 - c c')`` (..., 3, 3) [kg m^2] for masses (...) and COMs (..., 3)."""
    outer = com[..., :, None] * com[..., None, :]
    square = com[..., 0] ** 2 + com[..., 1] ** 2 + com[..., 2] ** 2
    moved: Array = mass[..., None, None] * (square[..., None, None] * np.eye(3) - outer)
    return moved


def inertia_about_com(mass: Array, com: Array, inertia: Array, framed: Flags) -> Array:
    """Tensors about the COM (..., 3, 3); those of bodies that are `framed` (...) are moved there.

    docs/theory/equations.md, (16f). The others come back bit by bit.
    """
    moved: Array = np.where(framed[..., None, None], inertia - steiner(mass, com), inertia)
    return moved


def least_second_moment(inertia: Array) -> Array:
    """Least eigenvalue of tr(J)/2 1 - J [kg m^2]; inertia ``(..., 3, 3)`` gives ``(...)``."""
    trace = _trace(inertia)
    sigma = 0.5 * trace[..., None, None] * np.eye(3) - inertia
    least: Array = eigenvalues(sigma)[..., 0]
    return least


def least_moment(inertia: Array) -> Array:
    """Least principal moment [kg m^2]; inertia ``(..., 3, 3)`` gives ``(...)``."""
    return np.asarray(eigenvalues(inertia)[..., 0])


def is_physical(inertia: Array, nominal: Array, moved: Array | float = 0.0) -> Flags:
    """Whether tensors ``(..., 3, 3)`` are physical, or at least no less so than the nominal one.

    A thin rod lies on the boundary of the physical set and the rounding of its figures may put it a
    little outside; its own box must still hold points. Hence the comparison with `nominal`, of a
    shape that broadcasts against `inertia`: the least second moment is at least its, or 0. Where
    its is negative, the least principal moment is at least its, or 0, too, so that no sampled body
    has less kinetic energy than none. `moved` is the trace of what was taken off a tensor on its
    way to the COM, whose rounding it still has.
    """
    rounding = _ROUNDING * (np.abs(_trace(inertia)) + moved)
    lacking = np.minimum(0.0, least_second_moment(nominal))
    second = least_second_moment(inertia) >= lacking - rounding
    least = np.minimum(0.0, least_moment(nominal)) - 4.0 * rounding
    result: Flags = second & ((lacking == 0.0) | (least_moment(inertia) >= least))
    return result


def are_physical(mass: Array, com: Array, inertia: Array, framed: Flags, nominal: Array) -> Flags:
    """`is_physical` for bodies (...) as they are given; `nominal` is about the COM.

    Args:
        mass: Masses (...) [kg].
        com: Centres of mass (..., 3) [m].
        inertia: Tensors (..., 3, 3) [kg m^2], about the frame where `framed` (...).
        framed: What the tensors are about.
        nominal: Nominal tensors about the COM, of a shape that broadcasts against `inertia`.
    """
    at_com = inertia_about_com(mass, com, inertia, framed)
    moved = np.where(framed, _trace(steiner(mass, com)), 0.0)
    return is_physical(at_com, nominal, moved)


def last_inside(nominal: Array, point: Array, inside: Callable[[Array], Flags]) -> Array:
    """The last point found, on the straight way from nominal to `point`, that is inside.

    The nominal one counts as inside. `inside` takes a stack ``(k, ...)`` of points, gives ``(k,)``.
    """
    lo, hi = 0.0, 1.0
    for _ in range(_ROUNDS):
        at = lo + (hi - lo) * _BETWEEN
        good = inside(nominal + at.reshape(-1, *(1,) * point.ndim) * (point - nominal))
        first = len(at) if good.all() else int(np.argmin(good))  # of those outside
        ends = [lo, *at.tolist(), hi]
        lo, hi = ends[first], ends[first + 1]
    pulled = nominal + lo * (point - nominal)
    # Clipped, since rounding could carry an entry beyond the point it was pulled from.
    result: Array = np.clip(pulled, np.minimum(nominal, point), np.maximum(nominal, point))
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
    half = 0.5 * _trace(inertia)
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
    return last_inside(nominal, inertia, lambda tensors: is_physical(tensors, nominal))


def _trace(tensors: Array) -> Array:
    """Summed in order, so that it has the same bits on every machine."""
    xx, yy, zz = (tensors[..., i, i] for i in range(3))
    return np.asarray(xx + yy + zz)
