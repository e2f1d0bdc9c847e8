"""Numbers that are arguments: what is none is refused by name, before numpy or the kernel do."""

from __future__ import annotations

import operator
from numbers import Real
from reprlib import repr as short

import numpy as np

from modrobust.errors import ValueRangeError
from modrobust.kernel import own_environment


def as_number(name: str, value: object, unit: str = "") -> float:
    """The argument as a float, which may be infinite or not a number.

    Args:
        name: What the caller knows the argument as.
        value: The argument: a number, or an array of no dimension.
        unit: Unit for the message, such as ``"s"``.

    Raises:
        ValueRangeError: It is no number; a text that reads like one is none.
    """
    if isinstance(value, float):
        return value
    if isinstance(value, Real) or (
        isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "iuf"
    ):
        try:
            with own_environment():
                return float(value)
        except OverflowError:
            raise ValueRangeError(f"{name}: {short(value)}; too large for a number") from None
    expected = f"a number [{unit}]" if unit else "a number"
    raise ValueRangeError(f"{name}: {short(value)}; must be {expected}")


def as_integer(name: str, value: object, least: int, most: int | None = None) -> int:
    """The argument as an int within its range.

    Args:
        name: What the caller knows the argument as.
        value: The argument: an int or a numpy integer; 1.0 is none.
        least: Smallest value allowed.
        most: Largest value allowed; None = no limit.

    Raises:
        ValueRangeError: It is no whole number, or out of its range.
    """
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueRangeError(f"{name}: {short(value)}; must be a whole number") from None
    if number < least:
        raise ValueRangeError(f"{name}: {number}; must be at least {least}")
    if most is not None and number > most:
        raise ValueRangeError(f"{name}: {number}; must be at most {most}")
    return number


def as_truth(name: str, value: object) -> bool:
    """The argument as a bool: True or False, or numpy's; 1 and "yes" are none.

    Raises:
        ValueRangeError: It is something else.
    """
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise ValueRangeError(f"{name}: {short(value)}; must be True or False")
