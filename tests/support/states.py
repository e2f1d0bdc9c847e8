"""States of a robot: q, dq, dq_a, ddq_a, of any kind of number, one state or rows of many."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

State = tuple[Any, Any, Any, Any]


def state_of(values: Iterable[Any]) -> State:
    """The four in a tuple."""
    q, dq, dq_a, ddq_a = values
    return q, dq, dq_a, ddq_a


def doubles(values: Iterable[Any]) -> State:
    """The four as contiguous arrays of doubles, which the kernel takes."""
    return state_of(np.ascontiguousarray(x, dtype=np.float64) for x in values)
