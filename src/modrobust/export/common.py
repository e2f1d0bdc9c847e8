"""What the exporters share: names, numbers, frames, and what is said about the losses."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree as ET

import numpy as np

from modrobust.checks.types import Array, Flags
from modrobust.model import Parameters, Robot, check_parameters
from modrobust.model.physical import inertia_about_com


@dataclass(frozen=True)
class Exported:
    """A robot in another format: the file's text, and what it could not hold, one line each."""

    text: str
    lost: tuple[str, ...]


class Names:
    """Hands out names that are not taken yet; a repeat gets ``-2``, ``-3``."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def new(self, wanted: str) -> str:
        """The name itself if it is free, else with a number."""
        name, number = wanted, 1
        while name in self._taken:
            number += 1
            name = f"{wanted}-{number}"
        self._taken.add(name)
        return name


def number(value: float) -> str:
    """Shortest text that reads back to the same double; no negative zero."""
    return repr(float(value) + 0.0)


def numbers(values: Iterable[float]) -> str:
    """Numbers with blanks between."""
    return " ".join(number(value) for value in values)


def point_of(robot: Robot, parameters: Parameters | None) -> Parameters:
    """The parameters to write, every tensor about its COM, as the other formats want them.

    Raises:
        ShapeError: They belong to another robot.
    """
    if parameters is None:
        parameters = robot.nominal
    check_parameters(robot, parameters)
    inertia = inertia_about_com(parameters.mass, parameters.com, parameters.inertia, robot.framed)
    return replace(parameters, inertia=inertia)


def joint_origin(robot: Robot, i: int) -> Array:
    """Joint frame i in its parent's *joint* frame (or the base frame), shape ``(4, 4)``.

    The other formats put a link's frame at its joint, so that ``after`` belongs to what follows.
    """
    parent = int(robot.parents[i])
    frame: Array = robot.before[i] if parent < 0 else robot.after[parent] @ robot.before[i]
    return frame


def body_origin(robot: Robot, k: int) -> Array:
    """Body frame k in the joint frame of the joint that moves it (or the base frame)."""
    joint = int(robot.body_joints[k])
    frame: Array = robot.placement[k] if joint < 0 else robot.after[joint] @ robot.placement[k]
    return frame


def leaves(robot: Robot) -> list[int]:
    """Joints whose links carry no further joint."""
    return sorted(set(range(robot.j)) - set(robot.parents.tolist()))


def entry_of(robot: Robot, i: int) -> int:
    """Where joint i stands in a vector of the n free joints, or n + k for the k-th mimic joint."""
    return int(np.flatnonzero(robot.moves == i)[0])


def joint_range(robot: Robot, i: int) -> tuple[float, float]:
    """Position limits of any joint; a mimic joint's are its leader's, carried over."""
    entry = entry_of(robot, i)
    if entry < robot.n:
        lo, hi = robot.position_limits[entry]
    else:
        f, k = robot.mimic, entry - robot.n
        ends = f.multiplier[k] * robot.position_limits[f.leaders[k]] + f.offset[k]
        lo, hi = ends.min(), ends.max()
    return float(lo), float(hi)


def weighs(point: Parameters, k: int) -> bool:
    """Whether body k has anything to write; an unknown payload at its lower bound has not."""
    return bool(point.mass[k] > 0.0 or point.inertia[k].any())


def without_bounds(robot: Robot) -> list[str]:
    """What neither format has room for."""
    lost = []
    if not np.array_equal(robot.lower.packed, robot.upper.packed):
        lost.append("the bounds of the dynamic parameters; one point of them is written")
    if not np.array_equal(robot.disturbance.lo, robot.disturbance.hi) or robot.disturbance.lo.any():
        lost.append("the disturbance [d]")
    lost.append("controller settings, trajectory and scenarios")
    return lost


def listed(robot: Robot, which: Array | Flags) -> str:
    """Names of the joints for which `which` (n,) or (j,) holds; "every joint" for all."""
    names = robot.joint_names if len(which) == robot.n else robot.all_joint_names
    chosen = [name for name, yes in zip(names, which, strict=True) if yes]
    return "every joint" if len(chosen) == robot.j else ", ".join(chosen)


def document(root: ET.Element, robot: Robot, kind: str, lost: Sequence[str]) -> str:
    """The file: a comment with what is lost, then the elements, indented."""
    lines = [f"{robot.name}, written by modrobust as {kind}. Not held by this format:", *lost]
    # Two hyphens would end the comment; names may hold them.
    body = "\n".join(f"  {line}" for line in lines).replace("--", "- -").replace("--", "- -")
    root.insert(0, ET.Comment(f"\n{body}\n"))
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'
