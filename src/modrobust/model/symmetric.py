r"""Eigenvalues of symmetric 3x3 matrices, with the same bits on every machine.

LAPACK, and NumPy's `linalg` on top of it, choose their code by the processor, and its last bits
with it. Here everything is + - * / and roots entry by entry, determined by IEEE 754, or rational.

Source: the cyclic Jacobi method, Golub and Van Loan, "Matrix Computations", 8.5; Laguerre's bounds
of the roots of a polynomial whose roots are all real.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from modrobust.checks.types import Array

PLACES = {"xx": (0, 0), "xy": (0, 1), "xz": (0, 2), "yy": (1, 1), "yz": (1, 2), "zz": (2, 2)}
"""Row and column of each entry of a tensor, in the order in which six entries stand everywhere."""

ENTRIES = tuple(PLACES)

_SWEEPS = 30  # rounding is reached after four or five
_DIGITS = 64  # binary ones of the largest root that are right
_PLANES = ((0, 1, 2), (0, 2, 1), (1, 2, 0))


def eigenvalues(matrices: Array) -> Array:
    """Eigenvalues in ascending order, ``(..., 3, 3)`` symmetric gives ``(..., 3)``.

    Errors stay below 16 times 2^-53 of the largest entry. A matrix has the same bits whichever
    others stand beside it. What is not finite gives NaN.
    """
    a = np.array(matrices, dtype=np.float64)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for _ in range(_SWEEPS):
            if not (a[..., [0, 0, 1], [1, 2, 2]] != 0.0).any():
                break
            for p, q, r in _PLANES:
                _rotate(a, p, q, r)
        diagonal = a[..., [0, 1, 2], [0, 1, 2]]
    finite = np.asarray(np.isfinite(a).all(axis=(-2, -1)))
    return np.sort(np.where(finite[..., None], diagonal, np.nan))


def _rotate(a: Array, p: int, q: int, r: int) -> None:
    """Turns the plane (p, q) so that its entry off the diagonal vanishes; r is the third axis."""
    app, aqq, apq = a[..., p, p].copy(), a[..., q, q].copy(), a[..., p, q].copy()
    apr, aqr = a[..., p, r].copy(), a[..., q, r].copy()
    nothing = (app + 0.5 * apq == app) & (aqq + 0.5 * apq == aqq)
    theta = (aqq - app) / np.where(apq != 0.0, 2.0 * apq, 1.0)
    size = np.abs(theta)
    small = np.minimum(size, 1e8)  # beyond it the root is theta itself, whose square could overflow
    root = np.where(size > 1e8, size, np.sqrt(small * small + 1.0))
    t = np.where(theta < 0.0, -1.0, 1.0) / (size + root)
    t = np.where(nothing, 0.0, t)
    c = 1.0 / np.sqrt(t * t + 1.0)
    s = t * c
    a[..., p, p] = app - t * apq
    a[..., q, q] = aqq + t * apq
    a[..., p, q] = a[..., q, p] = 0.0
    a[..., p, r] = a[..., r, p] = c * apr - s * aqr
    a[..., q, r] = a[..., r, q] = s * apr + c * aqr


def largest_eigenvalue(six: Sequence[Fraction]) -> Fraction:
    """A rational at or above the largest eigenvalue, by less than 2^-64 of the largest entry.

    Args:
        six: The matrix, xx, xy, xz, yy, yz, zz. A diagonal one has its largest entry back.

    Newton's method from above, in rationals: beyond its largest root x, a cubic p with real roots
    is convex, and u - 3 p(u) / p'(u) <= x <= u - p(u) / p'(u).
    """
    xx, xy, xz, yy, yz, zz = six
    if xy == xz == yz == 0:
        return max(xx, yy, zz)
    scale = max(map(abs, six))
    trace = xx + yy + zz
    minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz
    whole = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    grid = scale / 2 ** (_DIGITS + 8)  # keeps the digits of u few
    u = max(xx + abs(xy) + abs(xz), yy + abs(xy) + abs(yz), zz + abs(xz) + abs(yz))  # Gershgorin
    while True:
        value = ((u - trace) * u + minors) * u - whole
        if value == 0:
            return u
        step = value / ((3 * u - 2 * trace) * u + minors)
        if 3 * step * 2**_DIGITS < scale:
            return u
        u = min(u, math.ceil((u - step) / grid) * grid)
