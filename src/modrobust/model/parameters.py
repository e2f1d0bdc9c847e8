"""Dynamic parameters as frozen arrays: one point, or a nominal value with bounds."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from types import MappingProxyType

import numpy as np

from modrobust.checks import as_array, as_indices, as_real
from modrobust.checks.types import Array
from modrobust.errors import ShapeError

_INDICES = "Ints"  # as a field is annotated; all other arrays hold float64


def freeze(instance: object) -> None:
    """Replaces every array of a frozen dataclass by a read-only copy of its own.

    Raises:
        ValueRangeError: A field annotated as an array holds something else than real numbers, or
            one of indices something else than whole numbers of 32 bits.
    """
    for item in fields(instance):  # type: ignore[arg-type]
        value = getattr(instance, item.name)
        if value is None or not str(item.type).startswith(("Array", _INDICES)):
            continue
        if item.type == _INDICES:
            copy = np.array(as_indices(item.name, value), order="C")
        else:
            copy = np.array(as_real(item.name, value, "numbers"), order="C")
        copy.setflags(write=False)
        object.__setattr__(instance, item.name, copy)


def remade(instance: object) -> tuple[type, tuple[object, ...]]:
    """What pickle and copy make a frozen dataclass from again: its type and its fields.

    So that a copy is checked and read-only too, and holds nothing that was only cached.
    """
    values = (getattr(instance, item.name) for item in fields(instance))  # type: ignore[arg-type]
    return type(instance), tuple(
        dict(value) if isinstance(value, MappingProxyType) else value for value in values
    )


@dataclass(frozen=True, eq=False)
class Bounded:
    """A nominal value with hard closed bounds, arrays of one shape.

    Args:
        nominal: The value that a controller computes with, ``(n,)`` [N m] or [N].
        lo, hi: Ends of the interval, both in it, ``(n,)`` [N m] or [N].

    Raises:
        ValueRangeError: An array holds something else than real numbers.
    """

    nominal: Array
    lo: Array
    hi: Array

    __reduce__ = remade

    def __post_init__(self) -> None:
        freeze(self)


@dataclass(frozen=True, eq=False)
class Parameters:
    """One point of the dynamic parameters, in the order of the robot's bodies and joints.

    The arrays are copied and read-only. With mimic joints, arrays of joint data have one entry
    for each of them too.

    Args:
        mass: ``(b,)`` [kg].
        com: Centres of mass in body axes, ``(b, 3)`` [m].
        inertia: Tensors in body axes, ``(b, 3, 3)`` [kg m^2], about the COM, or about the body
            frame's origin where the robot's `inertia_about` says "frame".
        rotor_inertia: Motor side, ``(n,)`` [kg m^2].
        viscous: Friction on the joint's side, ``(n,)`` [N m s/rad] or [N s/m].
        coulomb: Friction on the joint's side, ``(n,)`` [N m] or [N].

    Raises:
        ShapeError: The arrays do not agree in b or in n, or an inertia is not symmetric.
        ValueRangeError: An entry is infinite or not a number.
    """

    mass: Array
    com: Array
    inertia: Array
    rotor_inertia: Array
    viscous: Array
    coulomb: Array

    __reduce__ = remade

    def __post_init__(self) -> None:
        b, n = np.size(self.mass), np.size(self.rotor_inertia)
        owner = f"{b} bodies from mass, {n} joints from rotor_inertia"
        for name, shape in _shapes(b, n).items():
            object.__setattr__(self, name, as_array(name, getattr(self, name), shape, owner))
        if not np.array_equal(self.inertia, np.swapaxes(self.inertia, 1, 2)):
            raise ShapeError("inertia: found a tensor that is not symmetric; give symmetric ones")
        freeze(self)

    @cached_property
    def packed(self) -> Array:
        r"""All parameters in the kernel's order, one contiguous vector ``(10 b + 3 n,)``.

        .. math:: \Delta = (m, c, I_{xx}, I_{xy}, I_{xz}, I_{yy}, I_{yz}, I_{zz}, I_m, F_v, F_c)

        each for all bodies, or joints, in [kg], [m], [kg m^2] and as for the fields.

        Source: Section III of [GA17].
        """
        i = self.inertia
        six = np.stack([i[:, 0, 0], i[:, 0, 1], i[:, 0, 2], i[:, 1, 1], i[:, 1, 2], i[:, 2, 2]], 1)
        parts = (self.mass, self.com, six, self.rotor_inertia, self.viscous, self.coulomb)
        vector = np.concatenate([np.ravel(part) for part in parts])
        vector.setflags(write=False)
        return vector


def _shapes(b: int, n: int) -> dict[str, tuple[int, ...]]:
    return {
        "mass": (b,),
        "com": (b, 3),
        "inertia": (b, 3, 3),
        "rotor_inertia": (n,),
        "viscous": (n,),
        "coulomb": (n,),
    }
