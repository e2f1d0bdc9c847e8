"""The one place that checks arrays and words what is wrong with them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modrobust.errors import ShapeError, ValueRangeError

Array = NDArray[np.float64]


def as_array(name: str, value: ArrayLike, shape: tuple[int, ...], owner: str) -> Array:
    """A contiguous float64 array of exactly this shape with finite entries.

    Args:
        name: What the caller knows the argument as.
        value: The argument.
        shape: Required shape.
        owner: Where the shape comes from, such as ``robot "arm6" has 6 joints``.

    Raises:
        ShapeError: The shape differs.
        ValueRangeError: An entry is not a number, or not finite.
    """
    try:
        if np.iscomplexobj(value):
            raise ValueRangeError(f"{name}: has complex entries; expected {_words(shape)} numbers")
        array = np.ascontiguousarray(value, dtype=np.float64)
    except (TypeError, ValueError) as problem:
        raise ValueRangeError(f"{name}: {problem}; expected {_words(shape)} numbers") from None
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


def _words(shape: tuple[int, ...]) -> str:
    return " x ".join(str(k) for k in shape)
