"""Robot -> MJCF, the format of MuJoCo."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np

from modrobust.checks.types import Array
from modrobust.errors import ValueRangeError
from modrobust.export.common import (
    Exported,
    Names,
    body_origin,
    document,
    joint_origin,
    joint_range,
    listed,
    number,
    numbers,
    point_of,
    weighs,
    without_bounds,
)
from modrobust.export.geoms import add_geoms
from modrobust.kernel import own_environment
from modrobust.model import Parameters, Robot
from modrobust.model.orientation import quaternion
from modrobust.model.physical import excess

TIMESTEP = 1e-3  # [s]
_LEAST = 1e-12  # [kg], [kg m^2]: MuJoCo refuses moving bodies of less than 1e-15
_STAND_IN = 1e-14  # [kg], [kg m^2]: written for a link that has no body of its own
_ADJUSTED = 1e-12  # relative change of a tensor that is worth a line


@own_environment()
def mjcf_text(
    robot: Robot,
    parameters: Parameters | None = None,
    *,
    timestep: float = TIMESTEP,
    visual: bool = True,
) -> Exported:
    """The robot as MJCF, at one point of its parameters.

    ``armature`` is k^2 I_m, ``damping`` the viscous and ``frictionloss`` the Coulomb friction; one
    motor a joint, gear 1, named like it. Contacts are disabled; limits are written and switched
    off, as the other plants have none. The integrator is RK4.

    Args:
        robot: Any robot, a tree too.
        parameters: The point to write; the nominal one when None.
        timestep: Step of the integrator [s].
        visual: Whether capsules, drawn from the kinematics alone, show the robot.

    Raises:
        ShapeError: `parameters` belong to another robot.
        ValueRangeError: The time step is not positive, or a body is refused: `refuse_unphysical`.
    """
    root, lost = mjcf_element(robot, parameters, timestep=timestep, visual=visual)
    return Exported(document(root, robot, "MJCF", lost), tuple(lost))


@own_environment()
def mjcf_element(
    robot: Robot,
    parameters: Parameters | None = None,
    *,
    timestep: float = TIMESTEP,
    visual: bool = True,
) -> tuple[ET.Element, list[str]]:
    """The elements of `mjcf_text`, and what is lost."""
    if not (np.isfinite(timestep) and timestep > 0.0):
        raise ValueRangeError(f"timestep: {timestep:g} s; must be positive and finite")
    point = point_of(robot, parameters)
    refuse_unphysical(robot, point)
    lost = _lost(robot, point)
    root = ET.Element("mujoco", model=robot.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="false", inertiafromgeom="false")
    option = ET.SubElement(root, "option", timestep=number(timestep), integrator="RK4")
    option.set("gravity", numbers(robot.gravity))
    ET.SubElement(option, "flag", contact="disable")
    world = ET.SubElement(root, "worldbody")
    names = Names(["world"])  # MuJoCo's own
    bodies = [names.new(name) for name in robot.body_names]
    base = _frame(world, names.new("base"), robot.base)
    frames: dict[int, ET.Element] = {-1: base}
    moved: dict[int, list[int]] = {i: [] for i in range(-1, robot.j)}
    for k, i in enumerate(robot.body_joints):
        moved[int(i)].append(k)
    _fixed_bodies(base, robot, point, moved[-1], bodies, lost)
    for i in range(robot.j):
        own = next((k for k in moved[i] if _can_move(point, k)), None)
        name = names.new(f"{robot.all_joint_names[i]}.link") if own is None else bodies[own]
        frame = _frame(frames[int(robot.parents[i])], name, joint_origin(robot, i))
        frames[i] = frame
        _joint(frame, robot, point, i)
        if own is not None:
            _inertial(frame, robot, point, own, body_origin(robot, own), lost)
        else:
            ET.SubElement(
                frame,
                "inertial",
                pos="0 0 0",
                mass=number(_STAND_IN),
                diaginertia=numbers([_STAND_IN] * 3),
            )
            lost.append(
                f"that {robot.all_joint_names[i]} moves no extended body of its own; "
                f"{_STAND_IN:g} kg and kg m^2 stand in"
            )
        _fixed_bodies(frame, robot, point, [k for k in moved[i] if k != own], bodies, lost)
    if visual:
        add_geoms(frames, robot, point)
    if robot.j > robot.n:
        _mimic_joints(ET.SubElement(root, "equality"), robot)
    actuators = ET.SubElement(root, "actuator")
    for i, name in enumerate(robot.joint_names):
        motor = ET.SubElement(actuators, "motor", name=name, joint=name, gear="1")
        if np.isfinite(robot.effort_limits[i]):
            limit = float(robot.effort_limits[i])
            motor.set("ctrlrange", numbers([-limit, limit]))
            motor.set("ctrllimited", "false")
    return root, lost


def refuse_unphysical(robot: Robot, parameters: Parameters | None = None) -> None:
    """Refuse a robot that MuJoCo would refuse or change: it takes only what a rigid body can have.

    Args:
        robot: Any robot; its nominal point is looked at.
        parameters: Another point, looked at too.

    Raises:
        ValueRangeError: A moving body has a tensor that no rigid body has; the message names it.
    """
    found = dict(robot.unphysical)
    if parameters is not None:
        # At an end of its box a payload may have a tensor and no mass, which MuJoCo takes.
        beyond = excess(np.ones(robot.b), parameters.inertia)
        moving = np.flatnonzero((beyond > 0.0) & (robot.body_joints >= 0))
        found |= {robot.body_names[k]: float(beyond[k]) for k in moving}
    if found:
        names = ", ".join(found)
        raise ValueRangeError(
            f'robot "{robot.name}": MuJoCo takes no body whose inertia no rigid body has, and such '
            f"are {names}; nothing is balanced here; give them figures that a body can have, or "
            "use the built-in plant, Pinocchio or a URDF"
        )


def _frame(parent: ET.Element, name: str, T: Array) -> ET.Element:
    pos, quat = numbers(T[:3, 3]), numbers(quaternion(T[:3, :3]))
    return ET.SubElement(parent, "body", name=name, pos=pos, quat=quat)


def _joint(body: ET.Element, robot: Robot, point: Parameters, i: int) -> None:
    kind = "hinge" if robot.turns[i] else "slide"
    joint = ET.SubElement(body, "joint", name=robot.all_joint_names[i], type=kind, axis="0 0 1")
    limits = joint_range(robot, i)
    if np.isfinite(limits).all():
        joint.set("range", numbers(limits))
        joint.set("limited", "false")
    joint.set("armature", number(robot.gear_ratio[i] ** 2 * point.rotor_inertia[i]))
    joint.set("damping", number(point.viscous[i]))
    joint.set("frictionloss", number(point.coulomb[i]))


def _mimic_joints(equality: ET.Element, robot: Robot) -> None:
    f = robot.mimic
    for k, name in enumerate(f.names):
        line = numbers([f.offset[k], f.multiplier[k], 0.0, 0.0, 0.0])
        leader = robot.joint_names[f.leaders[k]]
        ET.SubElement(equality, "joint", joint1=name, joint2=leader, polycoef=line)


def _fixed_bodies(
    parent: ET.Element,
    robot: Robot,
    point: Parameters,
    which: list[int],
    names: list[str],
    lost: list[str],
) -> None:
    for k in which:
        frame = _frame(parent, names[k], body_origin(robot, k))
        if weighs(point, k):
            _inertial(frame, robot, point, k, np.eye(4), lost)


def _can_move(point: Parameters, k: int) -> bool:
    """Whether MuJoCo takes body k as the body of a joint: neither a point nor a thin rod."""
    return bool(point.mass[k] > _LEAST and np.linalg.eigvalsh(point.inertia[k])[0] > _LEAST)


def _inertial(
    body: ET.Element, robot: Robot, point: Parameters, k: int, T: Array, lost: list[str]
) -> None:
    """Principal axes and moments, because MuJoCo's own decomposition is good to 1e-12 only."""
    moments, axes = np.linalg.eigh(point.inertia[k])
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    kept = np.maximum(moments, 0.0)
    kept[2] = min(kept[2], kept[0] + kept[1])  # MuJoCo takes no excess, not even the last bit
    if np.abs(kept - moments).max() > _ADJUSTED * np.abs(moments).max():
        lost.append(
            f"the tensor of {robot.body_names[k]}, which no rigid body has; the nearest principal "
            "moments that one has are written"
        )
    com = T[:3, :3] @ point.com[k] + T[:3, 3]
    ET.SubElement(
        body,
        "inertial",
        pos=numbers(com),
        quat=numbers(quaternion(T[:3, :3] @ axes)),
        mass=number(point.mass[k]),
        diaginertia=numbers(kept),
    )


def _lost(robot: Robot, point: Parameters) -> list[str]:
    lost = without_bounds(robot)
    if robot.gear_ratio.any():
        lost.append("gear ratio and rotor inertia apart; armature holds k^2 I_m")
    if (point.coulomb > 0.0).any():
        lost.append(
            "Coulomb friction as F_c s(dq); frictionloss holds F_c, MuJoCo makes a constraint of it"
        )
    if robot.j > robot.n:
        mimic = np.isin(np.arange(robot.j), robot.mimic.joints)
        lost.append(f"that {listed(robot, mimic)} mimic exactly; MuJoCo's equality is soft")
    if np.isfinite(robot.velocity_limits).any():
        lost.append("velocity limits")
    return lost
