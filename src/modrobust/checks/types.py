"""Types of the arrays that annotations name."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Real numbers; the shape stands in the docstring or beside the field."""

Ints = NDArray[np.int32]
"""Indices, as the kernel takes them."""

Flags = NDArray[np.bool_]
"""Truth values, one an entry."""
