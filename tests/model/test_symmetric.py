"""Eigenvalues of symmetric 3x3 matrices: against exact arithmetic, and alike in any company."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from modrobust.model.symmetric import eigenvalues, largest_eigenvalue

SEED = 20261128
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def matrices() -> Any:
    """Of any size, graded, and with eigenvalues that are equal or nearly so."""
    rng = np.random.default_rng(SEED)
    turned = np.linalg.qr(rng.normal(size=(60, 3, 3)))[0]
    values = 10.0 ** rng.uniform(-12.0, 0.0, (60, 3))
    values[::3, 1] = values[::3, 0]
    values[::5, 2] = values[::5, 0] * (1.0 + 1e-14)
    graded = np.einsum("nij,nj,nkj->nik", turned, values, turned)
    wide = rng.normal(size=(60, 3, 3)) * 10.0 ** rng.uniform(-8.0, 8.0, (60, 1, 1))
    found = np.concatenate([graded, wide])
    return (found + np.swapaxes(found, 1, 2)) / 2.0


def six(matrix: Any) -> list[Fraction]:
    return [Fraction(float(matrix[i, j])) for i, j in PAIRS]


def least_minors(m: list[Fraction], u: Fraction) -> bool:
    """Whether u 1 - m is positive semidefinite: all its principal minors are at least 0."""
    xx, xy, xz, yy, yz, zz = (entry - u if k in (0, 3, 5) else entry for k, entry in enumerate(m))
    det = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    pairs = (xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz)
    return max(xx, yy, zz) <= 0 and min(pairs) >= 0 and det <= 0


def test_the_largest_eigenvalue_is_never_understated_and_hardly_overstated() -> None:
    for matrix in matrices():
        entries = six(matrix)
        bound = largest_eigenvalue(entries)
        scale = max(map(abs, entries))
        assert least_minors(entries, bound)
        assert not least_minors(entries, bound - scale / 2**63)
    assert largest_eigenvalue([Fraction(k) for k in (1, 0, 0, 3, 0, 2)]) == 3
    ones = [Fraction(1)] * 6  # of rank one: 3, 0, 0
    assert 3 <= largest_eigenvalue(ones) <= 3 + Fraction(1, 2**60)
    assert largest_eigenvalue([-entry for entry in ones]) <= Fraction(1, 2**60)


def test_eigenvalues_in_doubles_are_near_and_the_same_in_any_company() -> None:
    stack = matrices()
    found = eigenvalues(stack)
    assert (np.diff(found, axis=1) >= 0.0).all()
    for matrix, values in zip(stack, found, strict=True):
        np.testing.assert_array_equal(eigenvalues(matrix), values)
        allowed = 16 * Fraction(1, 2**53) * max(map(abs, six(matrix)))
        assert abs(Fraction(values[2]) - largest_eigenvalue(six(matrix))) <= allowed
        assert abs(Fraction(values[0]) + largest_eigenvalue(six(-matrix))) <= allowed


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e308])
def test_what_is_out_of_range_is_no_number(value: float) -> None:
    assert np.isnan(eigenvalues(np.full((3, 3), value))).all()


def test_diagonal_matrices_and_none_at_all() -> None:
    assert eigenvalues(np.diag([3.0, -1.0, 2.0])).tolist() == [-1.0, 2.0, 3.0]
    assert eigenvalues(np.zeros((0, 3, 3))).shape == (0, 3)
