"""Motions of `modrobust.model.geometry` as arrays of doubles, for tests that compute so."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from modrobust.checks.types import Array
from modrobust.model import geometry
from modrobust.model.geometry import Transform


def _rounded(motion: Callable[..., Transform]) -> Callable[..., Array]:
    @wraps(motion)
    def make(*args: Any, **kwargs: Any) -> Array:  # arrays too where exact numbers are expected
        return motion(*args, **kwargs).rounded()

    return make


dh_modified = _rounded(geometry.dh_modified)
dh_standard = _rounded(geometry.dh_standard)
from_xyz_rpy = _rounded(geometry.from_xyz_rpy)
giusti2015 = _rounded(geometry.giusti2015)
giusti2015_iit = _rounded(geometry.giusti2015_iit)
rotation_to = _rounded(geometry.rotation_to)
rotation_x = _rounded(geometry.rotation_x)
rotation_y = _rounded(geometry.rotation_y)
rotation_z = _rounded(geometry.rotation_z)
translation = _rounded(geometry.translation)
