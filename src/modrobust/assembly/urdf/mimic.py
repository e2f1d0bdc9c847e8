"""Mimic joints: how far they let their leader move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from modrobust.assembly.parts import PlacedJoint

_NO_LONGER = "; written as continuous, it is revolute so, and its error not less whole turns"
_ROUNDING = 1e-9  # [rad] or [m]: a limit that moved by less is the same limit


def within_mimic_limits(joints: Sequence[PlacedJoint], notes: list[str]) -> tuple[PlacedJoint, ...]:
    """The joints, leaders with limits that keep their mimic joints within theirs.

    Args:
        joints: Free ones and mimic joints.
        notes: Takes a remark for each limit that became narrower.
    """
    result = list(joints)
    for mimic_joint in joints:
        if mimic_joint.mimic is None:
            continue
        index, multiplier, offset = mimic_joint.mimic
        leader = result[index]
        position, velocity = leader.item.position, leader.item.velocity
        if mimic_joint.item.position is not None:
            ends = sorted((end - offset) / multiplier for end in mimic_joint.item.position)
            lo, hi = position or (ends[0], ends[1])
            narrow = (max(lo, ends[0]), min(hi, ends[1]))
            if narrow[0] >= narrow[1]:  # seen in real files, where limits were copied with the sign
                notes.append(
                    f"joint {mimic_joint.name}: its position limits left out; mimicking "
                    f"{leader.name} it is never inside them"
                )
            elif position is None or max(narrow[0] - lo, hi - narrow[1]) > _ROUNDING:
                position = narrow
                notes.append(
                    f"joint {leader.name}: position limits [{narrow[0]:g}, {narrow[1]:g}], so that "
                    f"joint {mimic_joint.name}, which mimics it, keeps its own"
                    + _NO_LONGER
                    * (leader.item.type == "continuous")
                )
        if mimic_joint.item.velocity is not None:
            fastest = mimic_joint.item.velocity / abs(multiplier)
            if velocity is None or fastest < velocity - _ROUNDING:
                velocity = fastest
                notes.append(
                    f"joint {leader.name}: speed limit {fastest:g}, so that joint "
                    f"{mimic_joint.name}, which mimics it, keeps its own"
                )
        # An end that a mimic joint sets is an end: the joint does not turn endlessly any more.
        endless = leader.item.type == "continuous" and position is None
        kind = leader.item.type if endless or not _turns(leader) else "revolute"
        item = replace(leader.item, type=kind, position=position, velocity=velocity)
        result[index] = replace(leader, item=item)
    notes += _unwrapped(result)
    return tuple(result)


def _unwrapped(joints: Sequence[PlacedJoint]) -> Iterator[str]:
    """Remarks on continuous joints that cannot be brought back by a whole turn, `Robot.wraps`."""
    for mimic_joint in joints:
        if mimic_joint.mimic is None:
            continue
        index, multiplier, _ = mimic_joint.mimic
        leader = joints[index]
        if leader.item.type != "continuous" or (_turns(mimic_joint) and multiplier.is_integer()):
            continue
        moves = f"turns {multiplier:g} times as far" if _turns(mimic_joint) else "slides"
        yield (
            f"joint {leader.name}: continuous, but its error is not taken less whole turns, since "
            f"joint {mimic_joint.name}, which mimics it, {moves}: a turn leads to another pose"
        )


def _turns(joint: PlacedJoint) -> bool:
    return joint.item.type != "prismatic"
