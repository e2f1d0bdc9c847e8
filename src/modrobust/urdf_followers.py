"""Joints that follow others: how far they let the joint that leads them move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from modrobust.parts import PlacedJoint

_ROUNDING = 1e-9  # [rad] or [m]: a limit that moved by less is the same limit


def within_followers(joints: Sequence[PlacedJoint], notes: list[str]) -> tuple[PlacedJoint, ...]:
    """The joints, leaders with limits that keep their followers within theirs.

    Args:
        joints: Free ones and those that follow.
        notes: Takes a remark for each limit that became narrower.
    """
    result = list(joints)
    for follower in joints:
        if follower.follows is None:
            continue
        index, multiplier, offset = follower.follows
        leader = result[index]
        position, velocity = leader.item.position, leader.item.velocity
        if follower.item.position is not None:
            ends = sorted((end - offset) / multiplier for end in follower.item.position)
            lo, hi = position or (ends[0], ends[1])
            narrow = (max(lo, ends[0]), min(hi, ends[1]))
            if narrow[0] >= narrow[1]:  # seen in real files, where limits were copied with the sign
                notes.append(
                    f"joint {follower.name}: its position limits left out; following "
                    f"{leader.name} it is never inside them"
                )
            elif position is None or max(narrow[0] - lo, hi - narrow[1]) > _ROUNDING:
                position = narrow
                notes.append(
                    f"joint {leader.name}: position limits [{narrow[0]:g}, {narrow[1]:g}], so that "
                    f"joint {follower.name}, which follows it, keeps its own"
                )
        if follower.item.velocity is not None:
            fastest = follower.item.velocity / abs(multiplier)
            if velocity is None or fastest < velocity - _ROUNDING:
                velocity = fastest
                notes.append(
                    f"joint {leader.name}: speed limit {fastest:g}, so that joint "
                    f"{follower.name}, which follows it, keeps its own"
                )
        item = replace(leader.item, position=position, velocity=velocity)
        result[index] = replace(leader, item=item)
    return tuple(result)
