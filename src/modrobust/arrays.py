"""The one place that checks arrays and words what is wrong with them."""

from __future__ import annotations

import sys
from numbers import Real
from reprlib import repr as short

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modrobust.errors import ShapeError, ValueRangeError

Array = NDArray[np.float64]

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
        raise ShapeError(f"{name}: expected shape {shape}, got a single number; {owner}")
    if array.shape != shape:
        raise ShapeError(f"{name}: expected shape {shape}, got {array.shape}; {owner}")
    finite = np.isfinite(array)
    if not finite.all():
        where = tuple(int(k) for k in np.argwhere(~finite)[0])
        index = "".join(f"[{k}]" for k in where)
        raise ValueRangeError(f"{name}{index} is {array[where]}; every entry must be finite")
    return array


def as_real(name: str, value: ArrayLike, expected: str) -> Array:
    """A float64 array of any shape, from real numbers and nothing that merely passes for them.

    Raises:
        ValueRangeError: Truth values, texts, dates, complex numbers, other objects, masked arrays
            or lists of different lengths.
    """
    # numpy.ma takes 13 ms to import; who holds a masked array has done it
    if "numpy.ma" in sys.modules and isinstance(value, np.ma.MaskedArray):
        raise ValueRangeError(f"{name}: is a masked array; expected {expected}; fill it")
    try:
        array = np.asarray(value)
        if array.dtype.kind in "iuf":
            return array.astype(np.float64, copy=False)
    except (TypeError, ValueError) as problem:
        raise ValueRangeError(f"{name}: {problem}; expected {expected}") from None
    found = _KINDS.get(array.dtype.kind)
    if found is None:  # objects: the first that is no number tells most
        odd = (item for item in array.flat if isinstance(item, bool) or not isinstance(item, Real))
        found = short(next(odd, "numbers that are no floats"))
    raise ValueRangeError(f"{name}: holds {found}; expected {expected}")


def _words(shape: tuple[int, ...]) -> str:
    return " x ".join(str(k) for k in shape)
