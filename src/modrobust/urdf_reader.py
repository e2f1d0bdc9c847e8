"""From the XML tree to links and joints as written: structure and numbers are checked here.

Numbers stay nodes with file and line, so that the grammar, the tolerances and the physics checks of
module files apply to them unchanged. Parsers in use take a missing ixx as 1, a cut file as a
smaller robot and a wrong parent as none; everything here is either right or refused.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeVar

from modrobust.errors import DescriptionError
from modrobust.formats import ScalarNode, Where
from modrobust.formats.nodes import shown
from modrobust.geometry import IDENTITY, Transform, rotation_to
from modrobust.names import did_you_mean
from modrobust.urdf_values import (
    MAX_NAME,
    Number,
    optional,
    read_name,
    read_number,
    read_pose,
    refuse_slips,
    required,
    slip,
    three,
)
from modrobust.urdf_xml import Element

T = TypeVar("T", "Link", "Joint")

JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

# What an element may hold; what is missing here says nothing about the motion.
_LINK = ("inertial", "visual", "collision", "contact", "self_filter", "collision_checking",
         "kinematic", "gravity", "surface", "origin", "sensor", "inertia_scaling", "material",
         "audio_source", "stiffness", "damping", "friction_anchor")  # fmt: skip
_JOINT = ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic", "calibration",
          "safety_controller", "joint_properties", "hardware", "property")  # fmt: skip
_ROBOT = ("link", "joint", "transmission", "material", "gazebo", "sensor", "ros2_control",
          "mujoco", "drake", "plugin", "group", "group_state", "disable_collisions", "author",
          "deformable", "loop_joint", "model", "robotInterface", "root", "static")  # fmt: skip


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass, centre and tensor as written; `origin` is the inertial frame in the link."""

    mass: Number
    xyz: tuple[Number, Number, Number]
    origin: Transform
    turned: bool  # whether rpy is not zero
    tensor: tuple[Number, ...]  # xx, xy, xz, yy, yz, zz
    where: Where


@dataclass(frozen=True)
class Link:
    """A link; without `inertial` it is a frame without mass."""

    name: str
    inertial: Inertial | None
    where: Where


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
    Numbers that are not written are None; `reduction` is a transmission's.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Transform
    axis: Transform
    lower: Number | None
    upper: Number | None
    effort: Number | None
    velocity: Number | None
    damping: Number | None
    friction: Number | None
    mimic: Mimic | None
    reduction: Number | None
    where: Where
    limit_where: Where | None = None


@dataclass(frozen=True)
class Description:
    """A URDF as written: a tree of links with one root."""

    name: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    root: str
    notes: tuple[str, ...]
    where: Where
    parent_joint: dict[str, Joint] = field(default_factory=dict)  # by child link
    child_joints: dict[str, list[Joint]] = field(default_factory=dict)  # by parent link


def read_description(root: Element) -> Description:
    """The robot of an XML tree.

    Raises:
        DescriptionError: Anything that is missing, doubled, unknown or not a number; a structure
            of links and joints that is no tree.
    """
    if root.tag != "robot":
        raise root.where.error(
            "", f"the first element is <{root.tag[:60]}>; a URDF holds one <robot>; give a URDF"
        )
    _refuse_xacro(root)
    notes: list[str] = []
    for child in root.children:
        if child.tag not in _ROBOT and ":" not in child.tag:
            hint = slip(child.tag, ("link", "joint", "transmission"))
            if hint:
                raise child.where.error(
                    "robot", f"unknown element <{child.tag}>; {hint}correct or remove it"
                )
            notes.append(f"<{child.tag}> (line {child.where.line}) says nothing that is used here")
    links = _unique([_link(element) for element in root.all("link")], "link")
    reductions = _reductions(root, notes)
    joints = _unique(
        [_joint(element, links, reductions, notes) for element in root.all("joint")], "joint"
    )
    unknown = [name for name in reductions if name not in joints]
    if unknown:
        notes.append(f"transmissions of joints that do not exist: {', '.join(unknown)}")
    if not links:
        raise root.where.error("robot", "no <link>; a robot has links; give a complete URDF")
    for joint in joints.values():
        _check_mimic(joint, joints)
    return _structured(root, links, joints, notes)


def _refuse_xacro(root: Element) -> None:
    pending = [root]
    while pending:
        element = pending.pop()
        pending += element.children
        used = any("${" in value or "$(" in value for value in element.attributes.values())
        if element.tag.startswith("xacro:") or used:
            raise element.where.error(
                f"<{element.tag[:60]}>",
                "xacro that was not expanded; a URDF holds plain numbers; name the file .xacro "
                'and install the package "xacro" (pip install "modrobust[xacro]"), or expand it '
                "first: xacro FILE > robot.urdf",
            )


def _structured(
    root: Element, links: dict[str, Link], joints: dict[str, Joint], notes: list[str]
) -> Description:
    """The description with its tree, after every way not to be one has been excluded."""
    above: dict[str, Joint] = {}
    below: dict[str, list[Joint]] = {}
    for joint in joints.values():
        if joint.child in above:
            raise joint.where.error(
                f"joint {joint.name}",
                f'link "{joint.child}" is already the child of joint "{above[joint.child].name}" '
                f"(line {above[joint.child].where.line}); a link has one parent, loops cannot be "
                "described; cut the loop",
            )
        above[joint.child] = joint
        below.setdefault(joint.parent, []).append(joint)
    roots = [name for name in links if name not in above]
    if not roots:
        raise _loop(_cycle(next(iter(links)), above), above)
    if len(roots) > 1:
        listed = ", ".join(f'"{name}" (line {links[name].where.line})' for name in roots[:8])
        raise links[roots[1]].where.error(
            f"link {roots[1]}",
            f"{len(roots)} links without a parent: {listed}; a robot is a tree with one root; "
            "connect them by joints or remove what is not the robot",
        )
    reached: set[str] = set()
    pending = [roots[0]]
    while pending:
        name = pending.pop()
        reached.add(name)
        pending += [joint.child for joint in below.get(name, [])]
    lost = [name for name in links if name not in reached]
    if lost:
        raise _loop(_cycle(lost[0], above), above)
    name = read_name(root)
    return Description(name, links, joints, roots[0], tuple(notes), root.where, above, below)


def _loop(cycle: Sequence[str], above: dict[str, Joint]) -> DescriptionError:
    joint = above[cycle[0]]
    return joint.where.error(
        f"joint {joint.name}",
        f"a loop of links: {' -> '.join([cycle[-1], *cycle])}; a robot is a tree with one root; "
        "cut the loop",
    )


def _cycle(start: str, above: dict[str, Joint]) -> list[str]:
    """The loop that going up from `start` ends in, downwards."""
    seen: list[str] = []
    link = start
    while link not in seen:
        seen.append(link)
        link = above[link].parent
    return seen[seen.index(link) :][::-1]


def _unique(items: Sequence[T], kind: str) -> dict[str, T]:
    found: dict[str, T] = {}
    for item in items:
        if item.name in found:
            raise item.where.error(
                f"{kind} {item.name}",
                f"a second {kind} of this name (first on line {found[item.name].where.line}); "
                "names differ; rename one",
            )
        found[item.name] = item
    return found


def _link(element: Element) -> Link:
    name = read_name(element)
    owner = f"link {name}"
    refuse_slips(element, owner, _LINK, ("name", "type"))
    inertial = element.one("inertial", owner)
    return Link(name, None if inertial is None else _inertial(inertial, owner), element.where)


def _inertial(element: Element, owner: str) -> Inertial:
    refuse_slips(element, owner, ("origin", "mass", "inertia"), ())
    parts = {}
    for tag in ("mass", "inertia"):
        part = element.one(tag, owner)
        if part is None:
            raise element.where.error(
                owner,
                f"<inertial> has no <{tag}>; nothing is guessed; add it, or remove <inertial> from "
                "a frame without mass",
            )
        parts[tag] = part
    refuse_slips(parts["mass"], owner, (), ("value",))
    refuse_slips(parts["inertia"], owner, (), _ENTRIES)
    origin = element.one("origin", owner)
    xyz, pose, turned = read_pose(origin, owner)
    if origin is None:
        zero = ScalarNode("0", element.where)
        xyz = (Number(zero, 0.0), Number(zero, 0.0), Number(zero, 0.0))
    tensor = tuple(required(parts["inertia"], entry, owner) for entry in _ENTRIES)
    mass = required(parts["mass"], "value", owner)
    return Inertial(mass, xyz, pose, turned, tensor, element.where)


def _joint(
    element: Element, links: dict[str, Link], reductions: dict[str, Number], notes: list[str]
) -> Joint:
    name = read_name(element)
    owner = f"joint {name}"
    refuse_slips(element, owner, _JOINT, ("name", "type"))
    kind = element.attributes.get("type", "")
    if kind not in JOINT_TYPES:
        found = f"type {shown(kind)}" if kind else 'no "type"'
        raise element.where.error(
            owner,
            f"{found}; {did_you_mean(kind, JOINT_TYPES)}known: {', '.join(JOINT_TYPES)}",
        )
    ends = {end: _end(element, end, owner, links) for end in ("parent", "child")}
    if ends["parent"] == ends["child"]:
        raise element.where.error(
            owner, f'link "{ends["child"]}" is its own parent; a robot is a tree; correct it'
        )
    origin = element.one("origin", owner)
    _, pose, _ = read_pose(origin, owner)
    limit, dynamics = element.one("limit", owner), element.one("dynamics", owner)
    if limit is not None:
        refuse_slips(limit, owner, (), ("lower", "upper", "effort", "velocity"))
    if dynamics is not None:
        refuse_slips(dynamics, owner, (), ("damping", "friction"))
    return Joint(
        name=name,
        type=kind,
        parent=ends["parent"],
        child=ends["child"],
        origin=pose,
        axis=_axis(element, owner, kind, notes),
        lower=optional(limit, "lower", owner),
        upper=optional(limit, "upper", owner),
        effort=optional(limit, "effort", owner),
        velocity=optional(limit, "velocity", owner),
        damping=optional(dynamics, "damping", owner),
        friction=optional(dynamics, "friction", owner),
        mimic=_mimic(element, owner),
        reduction=reductions.get(name),
        where=element.where,
        limit_where=None if limit is None else limit.where,
    )


def _end(element: Element, end: str, owner: str, links: dict[str, Link]) -> str:
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
        refuse_slips(axis, owner, (), ("xyz",))
    direction = [number.exact for number in three(axis, "xyz", owner, "1 0 0")]
    if not any(direction):
        raise (axis or element).where.error(
            f"{owner}, axis", "the axis is 0 0 0; an axis has a direction; write e.g. 0 0 1"
        )
    length = math.hypot(*map(float, direction))
    if abs(length - 1.0) > 1e-3:
        notes.append(f"{owner}: axis of length {length:.6g} taken as a direction")
    return rotation_to(direction)


def _mimic(element: Element, owner: str) -> Mimic | None:
    mimic = element.one("mimic", owner)
    if mimic is None:
        return None
    refuse_slips(mimic, owner, (), ("joint", "multiplier", "offset"))
    multiplier = optional(mimic, "multiplier", owner)
    offset = optional(mimic, "offset", owner)
    return Mimic(
        read_name(mimic, "joint"),
        Fraction(1) if multiplier is None else multiplier.exact,
        Fraction(0) if offset is None else offset.exact,
        mimic.where,
    )


def _check_mimic(joint: Joint, joints: dict[str, Joint]) -> None:
    chain = [joint.name]
    while (mimic := joints[chain[-1]].mimic) is not None:
        if mimic.leader not in joints:
            raise mimic.where.error(
                f"joint {chain[-1]}, mimic",
                f'joint "{mimic.leader}" does not exist; {did_you_mean(mimic.leader, joints)}'
                "a joint mimics another of the file; correct the name",
            )
        if mimic.leader in chain:
            raise mimic.where.error(
                f"joint {chain[-1]}, mimic",
                f"joints that mimic each other in a circle: {' -> '.join([*chain, mimic.leader])}; "
                "one of them leads; remove its <mimic>",
            )
        chain.append(mimic.leader)


def _reductions(root: Element, notes: list[str]) -> dict[str, Number]:
    """Reduction by joint name of the transmissions that have one joint and one reduction."""
    found: dict[str, Number] = {}
    for element in root.all("transmission"):
        owner = f"transmission {element.attributes.get('name', '')[:MAX_NAME]}".strip()
        joints = list(element.all("joint"))
        places = [element, *element.all("actuator"), *joints]
        given = [part for place in places for part in place.all("mechanicalReduction")]
        if not given or not joints:
            continue
        if len(joints) > 1 or len(given) > 1:
            notes.append(
                f"{owner}: {len(joints)} joints and {len(given)} reductions; only transmissions "
                "from one motor to one joint are used; its reduction is left out"
            )
            continue
        try:
            number = read_number(given[0], "mechanicalReduction", given[0].text, owner)
        except DescriptionError as problem:
            # Placeholders such as "reduction" stand in real files; without a rotor inertia, which
            # a URDF cannot give, the number acts on nothing.
            notes.append(f"{problem.field}: left out: {problem.message}")
            continue
        if number.value == 0.0:
            raise given[0].where.error(
                owner, "mechanicalReduction is 0; motor over joint is not 0; correct it"
            )
        name = read_name(joints[0])
        if name in found:
            notes.append(f"{owner}: joint {name} has a transmission already; left out")
            continue
        # The sign is the direction of the motor; inertia goes with the square.
        node = ScalarNode(number.node.text.lstrip("+-"), given[0].where)
        found[name] = Number(node, abs(number.value))
    return found
