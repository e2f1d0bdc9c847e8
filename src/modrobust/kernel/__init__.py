"""The C kernel: its sources lie beside this file, its statuses become exceptions here."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from modrobust import _kernel
from modrobust.errors import (
    DivergenceError,
    ModrobustError,
    SingularMassMatrixError,
    TimeOrderError,
    ValueRangeError,
)

BOUNDS = {"hull": _kernel.HULL, "ianea": _kernel.IANEA}
"""How a bound is computed: the exact hull, or the paper's Algorithm 1."""


@contextmanager
def own_environment() -> Iterator[None]:
    """Arithmetic of Python and NumPy as the kernel's own; what the caller had set comes back.

    A context or a decorator. Other libraries leave rounding modes and flushed subnormals behind in
    which the same file gives another robot; see ``mr_environment.h``.
    """
    caller = _kernel.enter_environment()
    try:
        yield
    finally:
        _kernel.leave_environment(caller)


def bound_code(bound: str) -> int:
    """The kernel's number of a bound; ValueRangeError names the known ones."""
    try:
        return BOUNDS[bound]
    except (KeyError, TypeError):
        known = ", ".join(BOUNDS)
        raise ValueRangeError(f"bound: {bound!r} is not known; known: {known}") from None


def status_error(
    problem: _kernel.KernelError, given: Mapping[str, NDArray[np.float64]] | None = None
) -> ModrobustError:
    """The exception that a kernel status stands for; raise it ``from None``.

    Args:
        problem: What the kernel raised; of a batch it has the row, too.
        given: The arguments by name, positions first, so that the message can point at one.
    """
    status, *row = problem.args
    inputs = {name: (row, array[tuple(row)]) for name, array in (given or {}).items()}
    if status == _kernel.STATUS_ANGLE_RANGE:
        return ValueRangeError(
            f"{_largest(dict(list(inputs.items())[:1])) or 'q'}: a joint angle is beyond "
            f"{_kernel.ANGLE_MAX:g} rad; reduce it by whole turns"
        )
    if status == _kernel.STATUS_SINGULAR:
        return SingularMassMatrixError(
            "the mass matrix is not positive definite; every joint must move mass or rotor inertia"
        )
    if status == _kernel.STATUS_TIME:
        return TimeOrderError("t went backwards since the last command; call reset() to start anew")
    if status == _kernel.STATUS_DIVERGED:
        return DivergenceError("the closed loop left the range that can be computed")
    where = _largest(inputs)
    largest = f"{where} is the largest input; " if where else ""
    return ValueRangeError(f"{largest}the result is not finite; the inputs are too large")


def _largest(inputs: Mapping[str, tuple[list[int], NDArray[np.float64]]]) -> str:
    """Name, index and value of the largest entry of all, such as "dq[2] = 1e+200"."""
    found, size = "", -1.0
    for name, (row, array) in inputs.items():
        if array.size == 0:
            continue
        at = np.unravel_index(np.abs(array).argmax(), array.shape)
        if abs(array[at]) > size:
            size = float(abs(array[at]))
            found = f"{name}{''.join(f'[{i}]' for i in (*row, *at))} = {array[at]:g}"
    return found
