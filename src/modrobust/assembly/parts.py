"""What a description comes down to before it is a `Robot`: placed joints and placed bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from modrobust.assembly.modules.mounting import JointStep
from modrobust.checks.types import Array
from modrobust.formats import Quantity
from modrobust.model import ModuleNode
from modrobust.model.geometry import IDENTITY, Transform


@dataclass(frozen=True, eq=False)
class PlacedJoint(JointStep):
    """A joint in the tree: index of its parent (-1 = base), ``before`` and ``after`` (4, 4).

    A mimic joint has the index of that one, multiplier and offset [rad] or [m]:
    q = multiplier * q_leader + offset.
    """

    parent: int
    before: Array
    after: Array
    mimic: tuple[int, float, float] | None = None


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """A body that moves with `joint` (-1 = base), its frame at `placement` in that link frame."""

    name: str
    joint: int
    placement: Array
    mass: Quantity
    com: tuple[Quantity, Quantity, Quantity]
    inertia: tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]
    inertia_about: str  # "com" or "frame"


@dataclass(frozen=True, eq=False)
class Parts:
    """Joints, parents first; bodies; named frames where a payload can be.

    Args:
        ends: Name (of an instance, of a link) to joint index and frame (4, 4) in its link frame.
        tip: The frame of a payload that names none; None where the description must name one.
        place: What `ends` are called in messages.
        base: Frame that `base:` places in the world to the base frame, such as root to base link.
        not_modelled: Names of what the description says and the model has no field for.
    """

    joints: tuple[PlacedJoint, ...]
    bodies: tuple[PlacedBody, ...]
    ends: Mapping[str, tuple[int, Array]]
    tip: tuple[int, Array] | None
    place: str = "instance"
    notes: tuple[str, ...] = ()
    nodes: tuple[ModuleNode, ...] = ()
    base: Transform = IDENTITY
    not_modelled: tuple[str, ...] = ()
