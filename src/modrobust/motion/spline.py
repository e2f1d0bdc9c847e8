"""A cubic spline through rows, twice continuously differentiable.

SciPy would do; modrobust needs it only here and does not ask its users for it. The end condition
is not-a-knot (the first two pieces are one cubic, and the last two), which reproduces a recorded
cubic exactly and does not force the acceleration to zero at the ends as a natural spline does.
"""

from __future__ import annotations

import numpy as np

from modrobust.checks.types import Array


class CubicSpline:
    """Piecewise cubic with the second derivatives ``m`` at the knots as unknowns.

    Args:
        t: Knots, strictly increasing, (k,); k >= 2. Two knots give a line, three a parabola.
        y: Values, (k, n).
    """

    def __init__(self, t: Array, y: Array) -> None:
        self.t = t
        self.y = y
        self.m = _second_derivatives(t, y)

    def __call__(self, t: Array) -> tuple[Array, Array, Array]:
        """Value and first two derivatives at ``t`` (k,), each (k, n)."""
        i = np.clip(np.searchsorted(self.t, t, "right") - 1, 0, len(self.t) - 2)
        h = (self.t[i + 1] - self.t[i])[:, None]
        x = (t - self.t[i])[:, None]
        m0, m1 = self.m[i], self.m[i + 1]
        third = (m1 - m0) / h
        slope = (self.y[i + 1] - self.y[i]) / h - h * (2.0 * m0 + m1) / 6.0
        value = self.y[i] + x * (slope + x * (m0 / 2.0 + x * third / 6.0))
        return value, slope + x * (m0 + x * third / 2.0), m0 + x * third


def _second_derivatives(t: Array, y: Array) -> Array:
    """Solve the tridiagonal system of C2 continuity, (k, n)."""
    h = np.diff(t)
    slope = np.diff(y, axis=0) / h[:, None]
    m = np.zeros_like(y)
    if len(t) == 2:
        return m
    rhs = 6.0 * np.diff(slope, axis=0)
    if len(t) == 3:
        m[:] = rhs[0] / (3.0 * (h[0] + h[1]))
        return m
    lower, diagonal, upper = h[:-1].copy(), 2.0 * (h[:-1] + h[1:]), h[1:].copy()
    # Not-a-knot: the first (last) unknown is linear in its two neighbours, put in for it.
    first, last = h[0] / h[1], h[-1] / h[-2]
    diagonal[0] += h[0] * (1.0 + first)
    upper[0] -= h[0] * first
    diagonal[-1] += h[-1] * (1.0 + last)
    lower[-1] -= h[-1] * last
    # The matrix is diagonally dominant, so elimination needs no pivoting.
    for i in range(1, len(diagonal)):
        factor = lower[i] / diagonal[i - 1]
        diagonal[i] -= factor * upper[i - 1]
        rhs[i] -= factor * rhs[i - 1]
    m[-2] = rhs[-1] / diagonal[-1]
    for i in range(len(diagonal) - 2, -1, -1):
        m[i + 1] = (rhs[i] - upper[i] * m[i + 2]) / diagonal[i]
    m[0] = (1.0 + first) * m[1] - first * m[2]
    m[-1] = (1.0 + last) * m[-2] - last * m[-3]
    return m
