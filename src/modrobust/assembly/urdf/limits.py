"""Limits of a URDF's joints as entries of ``limits:``; what is no limit is left out and said."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, field

from modrobust.assembly.urdf.joints import Joint
from modrobust.assembly.urdf.values import UrdfNumber
from modrobust.formats import ListNode, Node, ScalarNode
from modrobust.formats.nodes import shown

FARTHEST = 1e5  # [rad], [m], [N m], ...: what tools write for "no limit" lies beyond


@dataclass
class JointRemarks:
    """Joints by what is to be said of their limits, for one sentence each on all of them."""

    notes: list[str] = field(default_factory=list)
    joints: dict[str, list[str]] = field(default_factory=dict)

    def add(self, what: str, joint: str) -> None:
        """One more joint of which this is to be said."""
        self.joints.setdefault(what, []).append(joint)

    def sentences(self) -> list[str]:
        """What is to be said."""
        return [
            *self.notes,
            *(f"{what}: {', '.join(joints)}" for what, joints in self.joints.items()),
        ]


def read_limits(joint: Joint, given: Container[str], remarks: JointRemarks) -> dict[str, Node]:
    """What ``<limit>`` says; a speed or an effort of 0 says nothing, a figure beyond 1e5 neither.

    Args:
        joint: As written.
        given: Keys of ``limits:`` that an overlay gives; those of the URDF are not looked at.
        remarks: Takes what is left out.

    Raises:
        DescriptionError: Position limits between which nothing moves, or without one end.
    """
    entries: dict[str, Node] = {}
    if joint.type != "continuous" and "position" not in given:
        position = _position(joint, remarks)
        if position is not None:
            entries["position"] = position
    effort = "force" if joint.type == "prismatic" else "torque"
    for key, word, number in (
        ("velocity", "velocity", joint.velocity),
        (effort, "effort", joint.effort),
        ("acceleration", "acceleration", joint.acceleration),
    ):
        if key in given:
            continue
        if number is None:
            if joint.type != "continuous" and key != "acceleration":
                remarks.add(f"no {word} limit is written, so there is none", joint.name)
        elif number.value == 0.0:
            remarks.notes.append(f"joint {joint.name}: {word} limit of 0 taken as not given")
        elif number.value > FARTHEST:
            remarks.add(f"{word} limits beyond {FARTHEST:g} taken as none", joint.name)
        else:
            entries[key] = number.node
    return entries


def _position(joint: Joint, remarks: JointRemarks) -> ListNode | None:
    """Both ends, None where there are none; an end that is not written is 0, as the format says."""
    if joint.lower is None and joint.upper is None:
        remarks.add("no position limits are written, so there are none", joint.name)
        return None
    place = joint.limit_where or joint.where
    zero = UrdfNumber(ScalarNode("0", place), 0.0)
    lower, upper = joint.lower or zero, joint.upper or zero
    if lower.value < -FARTHEST and upper.value > FARTHEST:
        remarks.add(f"position limits beyond {FARTHEST:g} taken as none", joint.name)
        return None
    field = f"joint {joint.name}, limits"
    overlay = f"(joints: {{{joint.name}: {{limits: {{position: [..., ...]}}}}}})"
    if lower.value == upper.value:
        turns = ""
        if lower.value == 0.0 and joint.type == "revolute":
            turns = 'write type="continuous" if it turns without end, '
        raise place.error(
            field,
            f"lower and upper limit are both {lower.value:g}; such a joint cannot move; correct "
            f"them, {turns}or freeze it (lock: {{{joint.name}: {lower.value:g}}})",
        )
    for end, number in (("lower", lower), ("upper", upper)):
        if abs(number.value) > FARTHEST and lower.value < upper.value:
            raise place.error(
                field,
                f"{end} limit {shown(number.node.text)} alone is beyond {FARTHEST:g}; a joint has "
                f"two limits or none; write both, neither for a joint without, or give them in an "
                f"assembly file {overlay}",
            )
    return ListNode((lower.node, upper.node), place)
