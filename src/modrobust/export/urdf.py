"""Robot -> URDF."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np

from modrobust.checks.types import Array, Flags
from modrobust.export.common import (
    Exported,
    Names,
    body_origin,
    document,
    entry_of,
    joint_origin,
    joint_range,
    leaves,
    listed,
    number,
    numbers,
    point_of,
    weighs,
    without_bounds,
)
from modrobust.kernel import own_environment
from modrobust.model import Parameters, Robot
from modrobust.model.orientation import roll_pitch_yaw

NO_LIMIT = 1e9  # written where URDF demands a limit and none is known [N m, N, rad/s, m/s, m]
_STANDARD_GRAVITY = (0.0, 0.0, -9.81)  # [m/s^2], what readers of URDF assume


@own_environment()
def urdf_text(robot: Robot, parameters: Parameters | None = None) -> Exported:
    """The robot as URDF, at one point of its parameters.

    Every joint turns about or slides along z of its frame; a link's frame is that of its joint.
    Every body stays a body of its own: the first of a link is the link's inertial, further ones are
    links on fixed joints. The root link is ``world``, so that the mounting of the base is kept.
    Where the last link's frame ends, a massless link ``<joint>.tip`` stands.

    Args:
        robot: Any robot, a tree too.
        parameters: The point to write; the nominal one when None.

    Raises:
        ShapeError: `parameters` belong to another robot.
    """
    point = point_of(robot, parameters)
    root = ET.Element("robot", name=robot.name)
    names = Names(robot.body_names)
    joints = Names(robot.all_joint_names)
    world, base = names.new("world"), names.new("base")
    ET.SubElement(root, "link", name=world)
    _fixed(root, joints.new("base.mount"), world, base, robot.base)
    links: dict[int, str] = {-1: base}
    ET.SubElement(root, "link", name=base)
    moved: dict[int, list[int]] = {i: [] for i in range(-1, robot.j)}
    for k, i in enumerate(robot.body_joints):
        moved[int(i)].append(k)
    for i in range(robot.j):
        own = moved[i]
        links[i] = (
            robot.body_names[own[0]] if own else names.new(f"{robot.all_joint_names[i]}.link")
        )
    for i in range(robot.j):
        _joint(root, robot, point, i, links[int(robot.parents[i])], links[i])
        link = ET.SubElement(root, "link", name=links[i])
        if moved[i]:
            _inertial(link, robot, point, moved[i][0], body_origin(robot, moved[i][0]))
    for i in range(-1, robot.j):
        for k in moved[i] if i < 0 else moved[i][1:]:
            name = robot.body_names[k]
            _fixed(root, joints.new(f"{name}.fixed"), links[i], name, body_origin(robot, k))
            _inertial(ET.SubElement(root, "link", name=name), robot, point, k, np.eye(4))
    for i in leaves(robot):
        tip = names.new(f"{robot.all_joint_names[i]}.tip")
        _fixed(root, joints.new(f"{robot.all_joint_names[i]}.tip"), links[i], tip, robot.after[i])
        ET.SubElement(root, "link", name=tip)
    for i in np.flatnonzero(robot.gear_ratio):
        _transmission(root, robot, int(i))
    lost = _lost(robot, point)
    return Exported(document(root, robot, "URDF", lost), tuple(lost))


def _origin(parent: ET.Element, T: Array) -> None:
    xyz, rpy = numbers(T[:3, 3]), numbers(roll_pitch_yaw(T[:3, :3]))
    ET.SubElement(parent, "origin", xyz=xyz, rpy=rpy)


def _fixed(root: ET.Element, name: str, parent: str, child: str, T: Array) -> None:
    joint = ET.SubElement(root, "joint", name=name, type="fixed")
    _origin(joint, T)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)


def _joint(
    root: ET.Element, robot: Robot, point: Parameters, i: int, parent: str, child: str
) -> None:
    lo, hi = joint_range(robot, i)
    endless = not (np.isfinite(lo) and np.isfinite(hi))
    kind = robot.joint_types[i]
    if robot.turns[i]:  # a mimic joint has no end nor error of its own
        kind = "continuous" if endless and (i >= robot.n or kind == "continuous") else "revolute"
    joint = ET.SubElement(root, "joint", name=robot.all_joint_names[i], type=kind)
    _origin(joint, joint_origin(robot, i))
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    ET.SubElement(joint, "axis", xyz="0 0 1")
    limit = ET.SubElement(joint, "limit")
    if kind != "continuous":
        if kind == "revolute" and endless:  # nor one end: readers want both or none
            lo, hi = -NO_LIMIT, NO_LIMIT
        limit.set("lower", number(np.clip(lo, -NO_LIMIT, NO_LIMIT)))
        limit.set("upper", number(np.clip(hi, -NO_LIMIT, NO_LIMIT)))
    entry = entry_of(robot, i)
    free = entry < robot.n
    for name, limits in (("effort", robot.effort_limits), ("velocity", robot.velocity_limits)):
        limit.set(name, number(min(limits[entry], NO_LIMIT) if free else NO_LIMIT))
    if not free:
        f, k = robot.mimic, entry - robot.n
        leader = robot.joint_names[f.leaders[k]]
        ratio = {"multiplier": number(f.multiplier[k]), "offset": number(f.offset[k])}
        ET.SubElement(joint, "mimic", {"joint": leader, **ratio})
    viscous, coulomb = number(point.viscous[i]), number(point.coulomb[i])
    ET.SubElement(joint, "dynamics", damping=viscous, friction=coulomb)


def _inertial(link: ET.Element, robot: Robot, point: Parameters, k: int, T: Array) -> None:
    """Mass properties of body k whose frame is at T in the link: COM there, axes of the body."""
    if not weighs(point, k):
        return
    at_com = T.copy()
    at_com[:3, 3] = T[:3, :3] @ point.com[k] + T[:3, 3]
    inertial = ET.SubElement(link, "inertial")
    _origin(inertial, at_com)
    ET.SubElement(inertial, "mass", value=number(point.mass[k]))
    entries = {
        f"i{'xyz'[a]}{'xyz'[b]}": number(point.inertia[k, a, b])
        for a in range(3)
        for b in range(a, 3)
    }
    ET.SubElement(inertial, "inertia", entries)


def _transmission(root: ET.Element, robot: Robot, i: int) -> None:
    name = robot.all_joint_names[i]
    transmission = ET.SubElement(root, "transmission", name=f"{name}.transmission")
    ET.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
    joint = ET.SubElement(transmission, "joint", name=name)
    ET.SubElement(joint, "hardwareInterface").text = "hardware_interface/EffortJointInterface"
    actuator = ET.SubElement(transmission, "actuator", name=f"{name}.motor")
    ET.SubElement(actuator, "mechanicalReduction").text = number(robot.gear_ratio[i])


def _lost(robot: Robot, point: Parameters) -> list[str]:
    lost = without_bounds(robot)
    reflected = robot.gear_ratio**2 * point.rotor_inertia > 0.0
    if reflected.any():
        lost.append(f"rotor inertia of {listed(robot, reflected)}")
    if (point.coulomb > 0.0).any():
        lost.append(
            f"coulomb_speed of {listed(robot, point.coulomb > 0.0)}: "
            "the speed within which Coulomb friction is smoothed"
        )
    if tuple(robot.gravity) != _STANDARD_GRAVITY:
        lost.append(f"gravity ({numbers(robot.gravity)}) m/s^2; readers assume (0 0 -9.81)")
    revolute = robot.free_turns
    continuous = np.array([kind == "continuous" for kind in robot.free_types])
    finite = np.isfinite(robot.position_limits)
    half_open = revolute & (finite.sum(axis=1) == 1)
    if half_open.any():
        lost.append(f"the one-sided position limit of {listed(robot, half_open)}")
    missing = (
        ("position", ~continuous & ~finite.all(axis=1)),
        ("velocity", _without_limit(robot, robot.velocity_limits)),
        ("effort", _without_limit(robot, robot.effort_limits)),
    )
    for what, where in missing:
        if where.any():
            lost.append(f"that {listed(robot, where)} has no {what} limit; {NO_LIMIT:g} is written")
    return lost


def _without_limit(robot: Robot, limits: Array) -> Flags:
    """Which of the j joints have no finite limit; mimic joints have none of their own."""
    everything = np.ones(robot.j, dtype=np.bool_)
    everything[robot.free] = ~np.isfinite(limits)
    return everything
