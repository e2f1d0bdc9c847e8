"""The one place that checks arrays and words what is wrong with them."""

from __future__ import annotations

import sys
from numbers import Real
from reprlib import repr as short
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modrobust.checks.types import Array, Ints
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.kernel import own_environment

_DOUBLE = np.dtype(np.float64)
_KINDS = {
    "b": "truth values",
    "c": "complex entries",
    "U": "text",
    "S": "text",
    "M": "dates",
    "m": "spans of time",
}


def as_array(name: str, value: ArrayLike, shape: tuple[int, ...], owner: str) -> Array:
    """A contiguous float64 array of exactly this shape with finite entries.

    Args:
        name: What the caller knows the argument as.
        value: The argument.
        shape: Required shape.
        owner: Where the shape comes from, such as ``robot "arm6" has 6 joints``.

    Raises:
        ShapeError: The shape differs.
        ValueRangeError: An entry is not a real number, or not finite; see `as_real`.
    """
    array = np.ascontiguousarray(as_real(name, value, f"{_words(shape)} numbers"))
    if np.ndim(value) == 0 and shape:  # ascontiguousarray makes it one-dimensional
        raise shape_error(name, shape, "a single number", owner)
    if array.shape != shape:
        raise shape_error(name, shape, array.shape, owner)
    finite = np.isfinite(array)
    if not finite.all():
        where = tuple(int(k) for k in np.argwhere(~finite)[0])
        index = "".join(f"[{k}]" for k in where)
        raise ValueRangeError(f"{name}{index} is {array[where]}; every entry must be finite")
    return array


def shape_error(name: str, expected: object, found: object, owner: str) -> ShapeError:
    """The exception for an array of another shape.

    Args:
        name: What the caller knows the array as.
        expected: The shape that it should have, or a text such as ``(..., 6)``.
        found: The shape that it has.
        owner: Where the shape comes from, such as ``robot "arm6" has 6 joints``.
    """
    return ShapeError(f"{name}: expected shape {expected}, got {found}; {owner}")


def as_real(name: str, value: ArrayLike, expected: str) -> Array:
    """A float64 array of any shape, from real numbers and nothing that merely passes for them.

    Raises:
        ValueRangeError: Truth values, texts, dates, complex numbers, other objects, masked arrays
            or lists of different lengths.
    """
    if type(value) is np.ndarray and value.dtype == _DOUBLE:
        return value
    # numpy.ma takes 13 ms to import; who holds a masked array has done it
    if "numpy.ma" in sys.modules and isinstance(value, np.ma.MaskedArray):
        raise ValueRangeError(f"{name}: is a masked array; expected {expected}; fill it")
    try:
        with own_environment():  # where subnormals are flushed, a small float32 would become 0
            array = np.asarray(value)
            if array.dtype.kind in "iuf":
                return array.astype(np.float64, copy=False)
    except (TypeError, ValueError) as problem:
        raise ValueRangeError(f"{name}: {problem}; expected {expected}") from None
    raise ValueRangeError(f"{name}: holds {_found(array)}; expected {expected}")


def as_indices(name: str, value: ArrayLike) -> Ints:
    """An int32 array of any shape, from whole numbers that it can hold; a list may be empty.

    Raises:
        ValueRangeError: Anything else; fractions and truth values are no indices.
    """
    expected = "whole numbers, which are indices"
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as problem:
        raise ValueRangeError(f"{name}: {problem}; expected {expected}") from None
    if array.size and array.dtype.kind not in "iu":
        found = "floats" if array.dtype.kind == "f" else _found(array)
        raise ValueRangeError(f"{name}: holds {found}; expected {expected}")
    limits = np.iinfo(np.int32)
    for item in array[(array < limits.min) | (array > limits.max)].flat:
        raise ValueRangeError(f"{name}: holds {item}; an index must lie in [-2^31, 2^31)")
    return array.astype(np.int32)


def _found(array: NDArray[Any]) -> str:
    """What an array holds instead of numbers; of objects, the first that is none tells most."""
    found = _KINDS.get(array.dtype.kind)
    if found is None:
        odd = (item for item in array.flat if isinstance(item, bool) or not isinstance(item, Real))
        found = short(next(odd, "numbers that are no floats"))
    return found


def _words(shape: tuple[int, ...]) -> str:
    return " x ".join(str(k) for k in shape)
