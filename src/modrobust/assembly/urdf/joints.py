"""Joints of a URDF as written: ends, origin, axis, limits, dynamics, mimic; numbers stay nodes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from modrobust.assembly.urdf.transmissions import Transmission
from modrobust.assembly.urdf.unmodelled import LIMIT_PASSED, Unmodelled, in_dynamics, in_joint
from modrobust.assembly.urdf.values import (
    UrdfNumber,
    optional,
    read_name,
    read_pose,
    refuse_foreign,
    refuse_slips,
    three,
)
from modrobust.assembly.urdf.xml import Element
from modrobust.checks import did_you_mean, unknown_name
from modrobust.formats import Where
from modrobust.formats.faults import Faults
from modrobust.formats.nodes import shown
from modrobust.model.geometry import IDENTITY, Transform, rotation_to

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
# What a joint may hold; what is not read of it says nothing about the motion.
JOINT = ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic", "calibration",
          "safety_controller", "joint_properties", "hardware", "property")  # fmt: skip
LIMITS = ("lower", "upper", "effort", "velocity", "acceleration", "drake:acceleration",
           "deceleration", "jerk")  # fmt: skip


@dataclass(frozen=True)
class Mimic:
    """q = multiplier * q_leader + offset."""

    leader: str
    multiplier: Fraction
    offset: Fraction
    where: Where


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint from the frame of link `parent` to that of `child`.

    `origin` takes the joint frame to the parent's; `axis` turns z to the axis, in the joint frame.
    Numbers that are not written are None. `armature` is an inertia on the joint's side of the gear,
    added to the diagonal of the mass matrix; `drive` is a transmission's.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Transform
    axis: Transform
    lower: UrdfNumber | None
    upper: UrdfNumber | None
    effort: UrdfNumber | None
    velocity: UrdfNumber | None
    damping: UrdfNumber | None
    friction: UrdfNumber | None
    mimic: Mimic | None
    drive: Transmission | None
    where: Where
    limit_where: Where | None = None
    acceleration: UrdfNumber | None = None
    armature: UrdfNumber | None = None


@dataclass
class JointReader:
    """What reading a joint takes, and what it gives besides."""

    links: Sequence[str]  # names, of those too that could not be read
    drives: dict[str, Transmission]
    version: float
    notes: list[str]
    unmodelled: Unmodelled
    faults: Faults
    unkept: list[str] = field(default_factory=list)  # joints with limits that are not looked at

    def read(self, element: Element) -> Joint | None:
        """The joint; None where something of it is at fault."""
        before = len(self.faults.found)
        joint = None
        with self.faults.caught():
            joint = self._read(element)
        return joint if len(self.faults.found) == before else None

    def _read(self, element: Element) -> Joint:
        name = read_name(element)
        owner = f"joint {name}"
        refuse_slips(element, owner, JOINT, ("name", "type"))
        kind = element.attributes.get("type", "")
        if kind not in JOINT_TYPES:
            found = f"type {shown(kind)}" if kind else 'no "type"'
            raise element.where.error(owner, unknown_name(found, kind, JOINT_TYPES))
        ends = {"parent": "", "child": ""}
        for end in ends:
            with self.faults.caught():
                ends[end] = _end(element, end, owner, self.links)
        if ends["parent"] == ends["child"] != "":
            raise element.where.error(
                owner,
                f'link "{ends["child"]}" is its own parent; a robot is a tree; name another link '
                "as parent or child",
            )
        pose, axis, limits, mimic = IDENTITY, IDENTITY, dict[str, UrdfNumber | None](), None
        friction = dict[str, UrdfNumber | None]()
        limit = None
        with self.faults.caught():
            pose = read_pose(element.one("origin", owner), owner, self.version)[1]
        with self.faults.caught():
            axis = _axis(element, owner, kind, self.notes)
        with self.faults.caught():
            limit = element.one("limit", owner)
            limits = self._limits(limit, name, owner)
        with self.faults.caught():
            friction = self._dynamics(element, name, owner)
        with self.faults.caught():
            mimic = _mimic(element, owner)
        return Joint(
            name=name,
            type=kind,
            parent=ends["parent"],
            child=ends["child"],
            origin=pose,
            axis=axis,
            lower=limits.get("lower"),
            upper=limits.get("upper"),
            effort=limits.get("effort"),
            velocity=limits.get("velocity"),
            damping=friction.get("damping"),
            friction=friction.get("friction"),
            mimic=mimic,
            drive=self.drives.get(name),
            where=element.where,
            limit_where=None if limit is None else limit.where,
            acceleration=limits.get("acceleration") or limits.get("drake:acceleration"),
            armature=friction.get("armature"),
        )

    def _limits(self, limit: Element | None, name: str, owner: str) -> dict[str, UrdfNumber | None]:
        if limit is None:
            return {}
        refuse_foreign(limit, owner, LIMITS, LIMIT_PASSED)
        read = {key: optional(limit, key, owner, endless=True) for key in LIMITS}
        if read["deceleration"] or read["jerk"]:
            self.unkept.append(name)
        return read

    def _dynamics(self, element: Element, name: str, owner: str) -> dict[str, UrdfNumber | None]:
        self.unmodelled.of_joint(name, in_joint(element))
        dynamics = element.one("dynamics", owner)
        if dynamics is not None:
            self.unmodelled.of_joint(name, in_dynamics(dynamics, owner))
        return {
            "damping": optional(dynamics, "damping", owner),
            "friction": optional(dynamics, "friction", owner),
            "armature": optional(dynamics, "armature", owner)
            or optional(element, "armature", owner),
        }


def _end(element: Element, end: str, owner: str, links: Sequence[str]) -> str:
    child = element.one(end, owner)
    if child is None:
        raise element.where.error(owner, f"no <{end}>; a joint connects two links; add it")
    name = read_name(child, "link")
    if name not in links:
        raise child.where.error(
            owner,
            f'{end} link "{name}" does not exist; {did_you_mean(name, links)}'
            "a joint connects two links of the file; correct the name or add the link",
        )
    return name


def _axis(element: Element, owner: str, kind: str, notes: list[str]) -> Transform:
    axis = element.one("axis", owner)
    if kind in ("fixed", "floating"):
        return IDENTITY
    if axis is not None:
        _refuse_axis(axis, owner)
    direction = [number.exact for number in three(axis, "xyz", owner, "1 0 0")]
    if not any(direction):
        raise (axis or element).where.error(
            f"{owner}, axis", "the axis is 0 0 0; an axis has a direction; write e.g. 0 0 1"
        )
    length = math.hypot(*map(float, direction))
    if abs(length - 1.0) > 1e-3:
        notes.append(f"{owner}: axis of length {length:.6g} taken as a direction")
    return rotation_to(direction)


def _refuse_axis(axis: Element, owner: str) -> None:
    """An rpy of zeros stands beside the axis in some files and says nothing."""
    still = not any(text.strip("+-0.") for text in axis.attributes.get("rpy", "").split())
    refuse_foreign(axis, owner, ("xyz",), ("rpy",) if still else ())


def _mimic(element: Element, owner: str) -> Mimic | None:
    mimic = element.one("mimic", owner)
    if mimic is None:
        return None
    refuse_foreign(mimic, owner, ("joint", "multiplier", "offset"))
    multiplier = optional(mimic, "multiplier", owner)
    offset = optional(mimic, "offset", owner)
    return Mimic(
        read_name(mimic, "joint"),
        Fraction(1) if multiplier is None else multiplier.exact,
        Fraction(0) if offset is None else offset.exact,
        mimic.where,
    )
