"""The C kernel: its sources lie beside this file, its statuses become exceptions here."""

from __future__ import annotations

from modrobust import _kernel
from modrobust.errors import (
    DivergenceError,
    ModrobustError,
    SingularMassMatrixError,
    TimeOrderError,
    ValueRangeError,
)

METHODS = {"hull": _kernel.HULL, "ianea": _kernel.IANEA}
"""How a bound is computed: the exact hull, or the paper's Algorithm 1."""


def method_code(method: str) -> int:
    """The kernel's number of a method; ValueRangeError names the known ones."""
    try:
        return METHODS[method]
    except (KeyError, TypeError):
        known = ", ".join(METHODS)
        raise ValueRangeError(f"method: {method!r} is not known; known: {known}") from None


def status_error(problem: _kernel.KernelError) -> ModrobustError:
    """The exception that a kernel status stands for; raise it ``from None``."""
    status = problem.args[0]
    if status == _kernel.STATUS_ANGLE_RANGE:
        return ValueRangeError(
            f"q: a joint angle is beyond {_kernel.ANGLE_MAX:g} rad; reduce it by whole turns"
        )
    if status == _kernel.STATUS_SINGULAR:
        return SingularMassMatrixError(
            "the mass matrix is not positive definite; every joint must move mass or rotor inertia"
        )
    if status == _kernel.STATUS_TIME:
        return TimeOrderError("t went backwards since the last command; call reset() to start anew")
    if status == _kernel.STATUS_DIVERGED:
        return DivergenceError("the closed loop left the range that can be computed")
    return ValueRangeError("the result is not finite; the inputs are too large")
