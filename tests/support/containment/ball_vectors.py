"""Vectors of three and 3x3 matrices of arb balls, unrolled: plain scalars are the fastest."""

from __future__ import annotations

from flint import arb

Vector = tuple[arb, arb, arb]
Matrix = tuple[arb, arb, arb, arb, arb, arb, arb, arb, arb]  # row by row

ZERO: Vector = (arb(0), arb(0), arb(0))


def add(a: Vector, b: Vector) -> Vector:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(k: arb, a: Vector) -> Vector:
    return (k * a[0], k * a[1], k * a[2])


def dot(a: Vector, b: Vector) -> arb:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def times(R: Matrix, x: Vector) -> Vector:
    """R x."""
    return (
        R[0] * x[0] + R[1] * x[1] + R[2] * x[2],
        R[3] * x[0] + R[4] * x[1] + R[5] * x[2],
        R[6] * x[0] + R[7] * x[1] + R[8] * x[2],
    )


def back(R: Matrix, x: Vector) -> Vector:
    """R' x."""
    return (
        R[0] * x[0] + R[3] * x[1] + R[6] * x[2],
        R[1] * x[0] + R[4] * x[1] + R[7] * x[2],
        R[2] * x[0] + R[5] * x[1] + R[8] * x[2],
    )


def product(A: Matrix, B: Matrix) -> Matrix:
    """A B."""
    columns = [times(A, (B[k], B[3 + k], B[6 + k])) for k in range(3)]
    return tuple(columns[k][i] for i in range(3) for k in range(3))  # type: ignore[return-value]
