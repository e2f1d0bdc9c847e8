"""Capsules and cylinders, drawn from the kinematics alone, so that one sees a robot.

They have no mass and touch nothing. A capsule runs from each joint to the next, another from a
joint to a COM that lies aside; a cylinder shows each axis of rotation, a rail each prismatic joint.
"""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np

from modrobust.checks.types import Array
from modrobust.export.common import body_origin, joint_origin, joint_range, number, numbers
from modrobust.model import Parameters, Robot
from modrobust.model.orientation import quaternion

_LINK = "0.86 0.87 0.88 1"
_JOINT = "0.95 0.45 0.10 1"
_BODY = "0.55 0.58 0.62 1"
_PAYLOAD = "0.75 0.15 0.15 1"
_BASE = "0.25 0.27 0.30 1"
_DENSITY = 1500.0  # [kg/m^3], of the box that stands for a payload
_NEAR = 0.5  # of the radius: a point so near is not worth a capsule


def reach(robot: Robot) -> float:
    """Length of the longest path from the base over the joints to a tip [m], at q = 0; not 0."""
    ends = np.zeros(robot.j)
    for i in range(robot.j):
        parent = int(robot.parents[i])
        ends[i] = _length(joint_origin(robot, i)) + (ends[parent] if parent >= 0 else 0.0)
    tips = [ends[i] + _length(robot.after[i]) for i in range(robot.j)]
    return float(max([*tips, 1e-2]))


def radii(robot: Robot) -> Array:
    """Radius with which each link is drawn (n,) [m], thinner towards the tips."""
    lengths = [_length(joint_origin(robot, i)) for i in range(robot.j)]
    lengths += [_length(robot.after[i]) for i in range(robot.j)]
    thick = min(0.05 * reach(robot), 0.35 * max([*lengths, 1e-2]))
    depth = np.zeros(robot.j)
    for i in range(robot.j):
        parent = int(robot.parents[i])
        depth[i] = 0.0 if parent < 0 else depth[parent] + 1.0
    return np.asarray(thick * (1.0 - 0.45 * depth / max(float(depth.max(initial=0.0)), 1.0)))


def add_geoms(frames: dict[int, ET.Element], robot: Robot, point: Parameters) -> None:
    """Geoms for every link's body element; -1 is the base."""
    r = radii(robot)
    children: dict[int, list[int]] = {i: [] for i in range(-1, robot.j)}
    for i, parent in enumerate(robot.parents):
        children[int(parent)].append(i)
    thick = float(r.max(initial=0.01))
    plate = {"pos": numbers([0.0, 0.0, -0.25 * thick]), "size": numbers([2 * thick, thick / 4])}
    _geom(frames[-1], "cylinder", _BASE, plate)
    for i, frame in frames.items():
        size = thick if i < 0 else float(r[i])
        if i >= 0:
            _axis(frame, robot, i, size)
        ends = [joint_origin(robot, c)[:3, 3] for c in children[i]]
        if i >= 0 and not children[i]:
            ends.append(robot.after[i][:3, 3])
        for end in ends:
            _capsule(frame, end, size, _LINK)
        for c in children[i]:
            if robot.joint_types[c] == "prismatic":
                _rail(frame, robot, c, 0.6 * size)
        for k in np.flatnonzero(robot.body_joints == i):
            _body(frame, robot, point, int(k), 0.7 * size)


def _axis(frame: ET.Element, robot: Robot, i: int, r: float) -> None:
    if robot.turns[i]:
        _geom(frame, "cylinder", _JOINT, {"size": numbers([1.22 * r, 1.15 * r])})
    else:
        _geom(frame, "box", _JOINT, {"size": numbers([1.3 * r, 1.3 * r, 1.6 * r])})


def _capsule(frame: ET.Element, end: Array, r: float, colour: str) -> None:
    if np.linalg.norm(end) > _NEAR * r:
        where = {"fromto": numbers([0.0, 0.0, 0.0, *end]), "size": number(r)}
        _geom(frame, "capsule", colour, where)


def _rail(frame: ET.Element, robot: Robot, c: int, r: float) -> None:
    """What joint c slides along: all of its way where that has ends."""
    lo, hi = joint_range(robot, c)
    if not (np.isfinite(lo) and np.isfinite(hi)):
        return
    T = joint_origin(robot, c)
    middle = T[:3, 3] + 0.5 * (lo + hi) * T[:3, 2]
    size = [0.6 * r, 0.6 * r, 0.5 * (hi - lo) + 2.0 * r]
    where = {"pos": numbers(middle), "quat": numbers(quaternion(T[:3, :3])), "size": numbers(size)}
    _geom(frame, "box", _BASE, where)


def _body(frame: ET.Element, robot: Robot, point: Parameters, k: int, r: float) -> None:
    T = body_origin(robot, k)
    com = T[:3, :3] @ point.com[k] + T[:3, 3]
    if robot.body_names[k] == "payload":
        half = max(0.5 * (float(point.mass[k]) / _DENSITY) ** (1.0 / 3.0), 0.5 * r)
        where = {"pos": numbers(com), "quat": numbers(quaternion(T[:3, :3]))}
        _geom(frame, "box", _PAYLOAD, {**where, "size": numbers([half] * 3)})
        return
    _capsule(frame, com, r, _BODY)


def _geom(frame: ET.Element, kind: str, colour: str, where: dict[str, str]) -> None:
    fixed = {"contype": "0", "conaffinity": "0", "mass": "0", "rgba": colour}
    ET.SubElement(frame, "geom", {"type": kind, **where, **fixed})


def _length(T: Array) -> float:
    return float(np.linalg.norm(T[:3, 3]))
