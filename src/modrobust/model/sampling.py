"""Points of the parameter box: random physical ones, vertices, vertices pulled to physical."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from modrobust.checks.types import Array, Flags
from modrobust.model.parameters import Parameters
from modrobust.model.physical import (
    are_physical,
    inertia_about_com,
    last_inside,
    pull_to_physical,
)

_ROUNDS = (1, 4, 16, 64, 256, 1024)  # draws per body that still has no physical tensor
_UPPER_TRIANGLE = ([0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2])  # xx xy xz yy yz zz
_SCALARS = ("mass", "com", "rotor_inertia", "viscous", "coulomb")


def sample_point(
    nominal: Parameters,
    lower: Parameters,
    upper: Parameters,
    framed: Flags,
    rng: np.random.Generator,
) -> Parameters:
    """A point uniform in the box, its tensors by rejection per body until they are physical.

    Where the tensor is about the frame, `framed` (b,), mass and COM take part in the rejection.
    """
    drawn = {name: _uniform(getattr(lower, name), getattr(upper, name), rng) for name in _SCALARS}
    mass, com, inertia = drawn["mass"], drawn["com"], nominal.inertia.copy()
    at_com = inertia_about_com(nominal.mass, nominal.com, nominal.inertia, framed)
    waiting = np.arange(len(nominal.mass))
    for count in _ROUNDS:
        if not len(waiting):
            break
        k = len(waiting)
        masses = np.repeat(mass[waiting, None], count, axis=1)
        coms = np.repeat(com[waiting, None], count, axis=1)
        tensors = _symmetric(
            _spread(_six(lower.inertia[waiting]), _six(upper.inertia[waiting]), count, rng)
        )
        again = framed[waiting]
        if count > 1 and again.any():  # else those drawn above
            which = waiting[again]
            masses[again] = _spread(lower.mass[which], upper.mass[which], count, rng)
            coms[again] = _spread(lower.com[which], upper.com[which], count, rng)
        good = are_physical(masses, coms, tensors, again[:, None], at_com[waiting][:, None])
        first = np.arange(k), np.argmax(good, axis=1)
        mass[waiting], com[waiting], inertia[waiting] = masses[first], coms[first], tensors[first]
        waiting = waiting[~good.any(axis=1)]
    point = replace(nominal, inertia=inertia, **drawn)
    point = _pulled(nominal, point, framed, waiting)
    return replace(point, inertia=np.clip(point.inertia, lower.inertia, upper.inertia))


def corner_point(lower: Parameters, upper: Parameters, rng: np.random.Generator) -> Parameters:
    """A vertex: each entry lower or upper with equal probability; products stay equal."""
    drawn = {name: _coin(getattr(lower, name), getattr(upper, name), rng) for name in _SCALARS}
    inertia = _symmetric(_coin(_six(lower.inertia), _six(upper.inertia), rng))
    return replace(lower, inertia=inertia, **drawn)


def physical_bodies(nominal: Parameters, point: Parameters, framed: Flags) -> Flags:
    """Whether each body (b,) of a point is one that there can be, as far as the nominal one is."""
    at_com = inertia_about_com(nominal.mass, nominal.com, nominal.inertia, framed)
    return are_physical(point.mass, point.com, point.inertia, framed, at_com)


def physical_pull(
    nominal: Parameters, point: Parameters, framed: Flags
) -> tuple[Parameters, tuple[int, ...]]:
    """The point with each unphysical tensor pulled straight towards nominal, and their indices.

    Where the tensor is about the frame, `framed` (b,), mass and COM come along: at theirs it might
    be unphysical whatever the bounds allow.
    """
    bad = np.flatnonzero(~physical_bodies(nominal, point, framed))
    if not len(bad):
        return point, ()
    return _pulled(nominal, point, framed, bad), tuple(int(k) for k in bad)


def _pulled(
    nominal: Parameters, point: Parameters, framed: Flags, which: NDArray[np.intp]
) -> Parameters:
    mass, com, inertia = point.mass.copy(), point.com.copy(), point.inertia.copy()
    for k in which:
        if not framed[k]:
            inertia[k] = pull_to_physical(nominal.inertia[k], inertia[k])
            continue
        start, end = (
            np.concatenate([[p.mass[k]], p.com[k], p.inertia[k].ravel()]) for p in (nominal, point)
        )
        figures = last_inside(start, end, _body_is_physical(start))
        mass[k], com[k], inertia[k] = figures[0], figures[1:4], figures[4:].reshape(3, 3)
    return replace(point, mass=mass, com=com, inertia=inertia)


def _body_is_physical(nominal: Array) -> Callable[[Array], Flags]:
    """The test of bodies (k, 13): mass, COM, tensor about the frame row by row."""
    framed = np.array(True)

    def parts(figures: Array) -> tuple[Array, Array, Array]:
        tensors = figures[..., 4:].reshape(*figures.shape[:-1], 3, 3)
        return figures[..., 0], figures[..., 1:4], tensors

    at_com = inertia_about_com(*parts(nominal), framed)
    return lambda figures: are_physical(*parts(figures), framed, at_com)


def _spread(lo: Array, hi: Array, count: int, rng: np.random.Generator) -> Array:
    """`count` draws of each row of a box: (k, count, ...)."""
    shape = (len(lo), count, *lo.shape[1:])
    return _uniform(np.broadcast_to(lo[:, None], shape), np.broadcast_to(hi[:, None], shape), rng)


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
