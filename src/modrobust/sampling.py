"""Points of the parameter box: random physical ones, vertices, vertices pulled to physical."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from modrobust.parameters import Parameters
from modrobust.physical import is_physical, pull_to_physical

Array = NDArray[np.float64]

_ROUNDS = (1, 4, 16, 64, 256, 1024)  # draws per body that still has no physical tensor
_UPPER_TRIANGLE = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])  # xx xy xz yy yz zz
_SCALARS = ("mass", "com", "rotor_inertia", "viscous", "coulomb")


def sample_point(
    nominal: Parameters, lower: Parameters, upper: Parameters, rng: np.random.Generator
) -> Parameters:
    """A point uniform in the box, its tensors by rejection per body until they are physical."""
    drawn = {name: _uniform(getattr(lower, name), getattr(upper, name), rng) for name in _SCALARS}
    inertia = nominal.inertia.copy()
    waiting = np.arange(len(nominal.mass))
    for count in _ROUNDS:
        if not len(waiting):
            break
        lo, hi = _six(lower.inertia[waiting]), _six(upper.inertia[waiting])
        shape = (len(waiting), count, 6)
        lo, hi = np.broadcast_to(lo[:, None], shape), np.broadcast_to(hi[:, None], shape)
        draws = _symmetric(_uniform(lo, hi, rng))
        good = is_physical(draws, nominal.inertia[waiting][:, None])
        inertia[waiting] = draws[np.arange(len(waiting)), np.argmax(good, axis=1)]
        waiting = waiting[~good.any(axis=1)]
    for k in waiting:
        inertia[k] = pull_to_physical(nominal.inertia[k], inertia[k])
    inertia = np.clip(inertia, lower.inertia, upper.inertia)
    return replace(nominal, inertia=inertia, **drawn)


def corner_point(lower: Parameters, upper: Parameters, rng: np.random.Generator) -> Parameters:
    """A vertex of the box: each entry lower or upper by a coin; products appear twice, equal."""
    drawn = {name: _coin(getattr(lower, name), getattr(upper, name), rng) for name in _SCALARS}
    inertia = _symmetric(_coin(_six(lower.inertia), _six(upper.inertia), rng))
    return replace(lower, inertia=inertia, **drawn)


def physical_pull(nominal: Parameters, point: Parameters) -> tuple[Parameters, tuple[int, ...]]:
    """The point with each unphysical tensor pulled straight towards nominal, and their indices."""
    bad = np.flatnonzero(~is_physical(point.inertia, nominal.inertia))
    if not len(bad):
        return point, ()
    inertia = point.inertia.copy()
    for k in bad:
        inertia[k] = pull_to_physical(nominal.inertia[k], inertia[k])
    return replace(point, inertia=inertia), tuple(int(k) for k in bad)


def _uniform(lo: Array, hi: Array, rng: np.random.Generator) -> Array:
    # Clipped, since lo + u (hi - lo) can round beyond hi.
    drawn: Array = np.clip(lo + rng.random(lo.shape) * (hi - lo), lo, hi)
    return drawn


def _coin(lo: Array, hi: Array, rng: np.random.Generator) -> Array:
    return np.where(rng.random(lo.shape) < 0.5, lo, hi)


def _six(inertia: Array) -> Array:
    return inertia[(..., *_UPPER_TRIANGLE)]


def _symmetric(six: Array) -> Array:
    result = np.empty((*six.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(zip(*_UPPER_TRIANGLE, strict=True)):
        result[..., i, j] = result[..., j, i] = six[..., k]
    return result
