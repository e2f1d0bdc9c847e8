r"""Joints of Timor's module database: every spelling of a key that Timor reads, and no other.

Timor takes camelCase and snake_case names in any case, from the joint or its limits. Its friction

.. math:: F_v\,\dot q + F_c \sin(\arctan(100\,\dot q))
          = F_v\,\dot q + F_c\,\frac{\dot q}{\sqrt{\dot q^2 + 0.01^2}}

is (20) with a Coulomb speed of 0.01; its rotors reflect k^2 I_m, whatever the sign of k.

Source: Timor Python 1.1, ``Joint.from_json_data``, ``Robot.friction`` and ``Robot.motor_inertias``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from modrobust.checks import did_you_mean, unknown_name
from modrobust.formats import MapNode, Node, ScalarNode, Where
from modrobust.formats.nodes import shown
from modrobust.model.geometry import Transform
from modrobust.timor.database import TimorBody, finite, member, members, number, read_pose, text_of

COULOMB_SPEED = "0.01"  # [rad/s] or [m/s]
_EFFORT = {"revolute": "torque", "continuous": "torque", "prismatic": "force"}
_TYPES = {kind: kind for kind in _EFFORT} | {
    "revolute_active": "revolute",
    "prismatic_active": "prismatic",
    "JointModelRZ": "revolute",
    "JointModelPZ": "prismatic",
}
_STRUCTURE = ("ID", "parent", "child", "type", "passive", "limits")
# Our word for a field, and those of Timor, which reads them in any case and from both places.
_SPELLINGS = {
    "poseParent": ("poseParent", "parent2joint"),
    "poseChild": ("poseChild", "joint2child"),
    "gearRatio": ("gearRatio", "gear_ratio"),
    "motorInertia": ("motorInertia", "motor_inertia"),
    "frictionCoulomb": ("frictionCoulomb", "friction_coulomb"),
    "frictionViscous": ("frictionViscous", "friction_viscous"),
    "peakTorque": ("peakTorque", "torque_limit"),
    "velocity": ("velocity", "velocity_limit"),
    "acceleration": ("acceleration", "acceleration_limit"),
}
_ENDS = {"positionLower": ("positionLower", "lower"), "positionUpper": ("positionUpper", "upper")}


@dataclass(frozen=True, eq=False)
class TimorJoint:
    """A joint between two bodies; `fields` has what is written of `_SPELLINGS` and `_ENDS`."""

    id: str
    parent: str
    child: str
    type: str
    to_joint: Transform  # parent body to joint
    to_child: Transform  # joint to child body
    fields: Mapping[str, Node]
    where: Where


def read_joints(node: Node, name: str, bodies: Mapping[str, TimorBody]) -> list[TimorJoint]:
    """The joints of a module.

    Raises:
        DescriptionError: Something is missing, doubled, unknown, or of a kind that is not imported.
    """
    found = []
    for index, entry in enumerate(members(member(node, "joints", name), f"{name}.joints")):
        field = f"{name}.joints[{index}]"
        ends = [text_of(entry, key, field) for key in ("parent", "child")]
        for end in ends:
            if end not in bodies:
                raise entry.where.error(
                    field, unknown_name(f"no body with the ID {shown(end)}", end, bodies)
                )
        kind = text_of(entry, "type", field)
        assert isinstance(entry, MapNode)
        if kind not in _TYPES or _is_passive(entry, field):
            raise entry.where.error(
                field,
                f"a {'passive ' if kind in _TYPES else ''}{kind} joint; joints are driven and "
                f"one of {', '.join(_EFFORT)}",
            )
        fields = _fields(entry, field)
        for pose in ("poseParent", "poseChild"):
            if pose not in fields:
                raise entry.where.error(field, f'no "{pose}"; a Timor module database has it')
        to_joint, to_child = (read_pose(fields[p], field) for p in ("poseParent", "poseChild"))
        found.append(
            TimorJoint(
                text_of(entry, "ID", field),
                ends[0],
                ends[1],
                _TYPES[kind],
                to_joint,
                to_child,
                fields,
                entry.where,
            )
        )
    return found


def _is_passive(entry: MapNode, field: str) -> bool:
    passive = entry.entries.get("passive")
    said = passive.text if isinstance(passive, ScalarNode) else "" if passive else "false"
    if said.lower() in ("true", "1"):
        return True
    if said.lower() not in ("false", "0"):
        raise entry.where.error(f"{field}.passive", f"{shown(said)} is neither true nor false")
    return False


def _fields(entry: MapNode, field: str) -> dict[str, Node]:
    """What the joint and its limits say, by our words; an unknown key or a doubled one is refused.

    A key that is passed over could be a drive, friction or a limit that is lost.
    """
    found: dict[str, Node] = {}
    limits = entry.entries.get("limits")
    if limits is not None and not isinstance(limits, MapNode):
        raise limits.where.error(f"{field}.limits", "not a mapping; a Timor joint has one there")
    parts: list[tuple[MapNode, str, Mapping[str, tuple[str, ...]], tuple[str, ...]]]
    parts = [(entry, field, _SPELLINGS, _STRUCTURE)]
    if limits is not None:
        parts.append((limits, f"{field}.limits", _SPELLINGS | _ENDS, ()))
    for part, place, spellings, structure in parts:
        words = {each.casefold(): word for word, known in spellings.items() for each in known}
        for key, value in part.entries.items():
            if key in structure:
                continue
            word = words.get(key.casefold())
            if word is None:
                known = [*structure, *(each for every in spellings.values() for each in every)]
                raise part.place(key).error(
                    place,
                    f"unknown key {shown(key)}; {did_you_mean(key, known)}Timor does not read it, "
                    "and it could be a drive, friction or a limit; correct or remove it",
                )
            if word in found:
                raise part.place(key).error(
                    place, f"{shown(key)} says {word} a second time; it is said once; remove one"
                )
            found[word] = value
    return found


def joint_lines(joint: TimorJoint, name: str, notes: list[str]) -> list[str]:
    """The joint as an entry of a module's chain; remarks go to `notes`.

    Raises:
        DescriptionError: A figure is no number.
    """
    lines = [f"  - joint: {name}", f"    type: {joint.type}"]
    limits = _limits(joint, name, notes)
    if limits:
        lines.append(f"    limits: {{{', '.join(limits)}}}")
    motor, gear = (_figure(joint, key) for key in ("motorInertia", "gearRatio"))
    ratio = Fraction(gear or 1)
    if ratio < 0:
        notes.append(
            f"joint {name}: gear ratio {gear} taken as {gear[1:]}: its sign is the direction of "
            "the motor, and inertia goes with its square"
        )
        gear = gear[1:]
    if motor and Fraction(motor) and not ratio:
        notes.append(f"joint {name}: a gear ratio of 0 reflects no rotor inertia; no drive taken")
    elif motor and Fraction(motor):
        lines.append(f"    drive: {{gear_ratio: {gear or 1}, rotor_inertia: {motor}}}")
    friction = [
        f"{key}: {value}"
        for key, theirs in (("viscous", "frictionViscous"), ("coulomb", "frictionCoulomb"))
        if (value := _figure(joint, theirs)) and Fraction(value)
    ]
    if friction:
        smooth = f", coulomb_speed: {COULOMB_SPEED}" if friction[-1].startswith("coulomb") else ""
        lines.append(f"    friction: {{{', '.join(friction)}{smooth}}}")
    return lines


def _limits(joint: TimorJoint, name: str, notes: list[str]) -> list[str]:
    """Entries of ``limits:``; what stands for no limit is left out, with a remark if in doubt."""
    parts = []
    lo, hi = (finite(joint.fields.get(key)) for key in _ENDS)
    given = [end for end in (lo, hi) if end is not None]
    if joint.type == "continuous" and given:
        raise joint.where.error(
            f"joint {joint.id}",
            "a continuous joint with position limits, which Timor refuses too; make it revolute or "
            "remove them",
        )
    if len(given) == 2:
        parts.append(f"position: [{', '.join(given)}]")
    elif given:
        notes.append(
            f"joint {name}: a position limit on one side only, {given[0]}: left out, since a joint "
            "has two limits or none; complete it"
        )
    keys = (("velocity", "velocity"), (_EFFORT[joint.type], "peakTorque"))
    for key, theirs in (*keys, ("acceleration", "acceleration")):
        value = finite(joint.fields.get(theirs))
        if value is not None and Fraction(value):
            parts.append(f"{key}: {value}")
        elif value is not None:
            notes.append(f"joint {name}: {theirs} limit of 0 taken as not given")
    return parts


def _figure(joint: TimorJoint, key: str) -> str:
    """The number as written without a plus sign; empty where there is none."""
    node = joint.fields.get(key)
    return "" if node is None else number(node, f"joint {joint.id}.{key}").lstrip("+")
