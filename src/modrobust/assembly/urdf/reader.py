"""From the XML tree to links and joints as written: structure and numbers are checked here.

Numbers stay nodes with file and line, so that the grammar, the tolerances and the physics checks of
module files apply to them unchanged. Parsers in use take a missing ixx as 1, a cut file as a
smaller robot and a wrong parent as none; everything here is either right or refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from modrobust.assembly.urdf.joints import Joint, JointReader
from modrobust.assembly.urdf.transmissions import Transmission, read_transmissions
from modrobust.assembly.urdf.unmodelled import Unmodelled, around
from modrobust.assembly.urdf.values import (
    UrdfNumber,
    read_name,
    read_pose,
    refuse_foreign,
    refuse_slips,
    required,
    slip,
)
from modrobust.assembly.urdf.xml import HRDF, Element
from modrobust.checks import did_you_mean
from modrobust.errors import DescriptionError
from modrobust.formats import ScalarNode, Where
from modrobust.formats.faults import Faults
from modrobust.formats.nodes import shown
from modrobust.model.geometry import IDENTITY, Transform
from modrobust.model.symmetric import ENTRIES

T = TypeVar("T", "Link", "Joint")

VERSIONS = {"1": 1.0, "1.0": 1.0, "1.1": 1.1, "1.2": 1.2}
_ENTRIES = tuple(f"i{entry}" for entry in ENTRIES)
_HRDF = ("actuator", "bracket", "rigid-body", "end-effector")

# What an element may hold; what is missing here says nothing about the motion.
_LINK = ("inertial", "visual", "collision", "contact", "self_filter", "collision_checking",
         "kinematic", "gravity", "surface", "origin", "sensor", "inertia_scaling", "material",
         "audio_source", "stiffness", "damping", "friction_anchor")  # fmt: skip
_ROBOT = ("link", "joint", "transmission", "material", "gazebo", "sensor", "ros2_control",
          "mujoco", "drake", "plugin", "group", "group_state", "disable_collisions", "author",
          "deformable", "loop_joint", "model", "robotInterface", "root", "static")  # fmt: skip


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass, centre and tensor as written; `origin` is the inertial frame in the link."""

    mass: UrdfNumber
    xyz: tuple[UrdfNumber, UrdfNumber, UrdfNumber]
    origin: Transform
    rotated: bool  # whether rpy is not zero
    tensor: tuple[UrdfNumber, ...]  # xx, xy, xz, yy, yz, zz
    where: Where


@dataclass(frozen=True)
class Link:
    """A link; without `inertial` it is a frame without mass.

    faults: What is wrong with its `mass`, `com` or `inertia`, where the figure is 0 here; an
    overlay can give it.
    """

    name: str
    inertial: Inertial | None
    where: Where
    faults: Mapping[str, DescriptionError] = field(default_factory=dict)


@dataclass(frozen=True)
class UrdfDescription:
    """A URDF as written: a tree of links with one root."""

    name: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    root: str
    notes: tuple[str, ...]
    where: Where
    parent_joint: dict[str, Joint] = field(default_factory=dict)  # by child link
    child_joints: dict[str, list[Joint]] = field(default_factory=dict)  # by parent link
    unmodelled: Unmodelled = field(default_factory=Unmodelled)


@dataclass(frozen=True)
class Items:
    """Links and joints that could be read, before it is known whether they make a tree."""

    links: dict[str, Link]
    joints: dict[str, Joint]
    notes: list[str]
    unmodelled: Unmodelled


def read_description(root: Element) -> UrdfDescription:
    """The robot of an XML tree.

    Raises:
        DescriptionError: Anything that is missing, doubled, unknown or not a number; a structure
            of links and joints that is no tree.
    """
    faults = Faults()
    items = read_items(root, faults)
    faults.stop()
    for link in items.links.values():
        faults.add(*link.faults.values())
    faults.stop()
    return read_structure(root, items)


def read_items(root: Element, faults: Faults) -> Items:
    """Links and joints of an XML tree; what is wrong with one is added to `faults`.

    Raises:
        DescriptionError: The tree is no URDF, or one of a version that is not read.
    """
    version = _version(root)
    _refuse_xacro(root)
    notes: list[str] = []
    unmodelled = Unmodelled()
    around(root, unmodelled)
    for child in root.children:
        if child.tag not in _ROBOT and ":" not in child.tag:
            with faults.caught():
                hint = slip(child.tag, ("link", "joint", "transmission"))
                if hint:
                    raise child.where.error(
                        "robot", f"unknown element <{child.tag}>; {hint}correct or remove it"
                    )
                notes.append(
                    f"<{child.tag}> (line {child.where.line}) says nothing that is used here"
                )
    links: list[Link] = []
    for element in root.all("link"):
        with faults.caught():
            links.append(_link(element, version))
    by_name = _unique(links, "link", faults)
    drives: dict[str, Transmission] = {}
    with faults.caught():
        drives = read_transmissions(root, notes, unmodelled)
    names = [_name_of(element) for element in root.all("link")]
    reader = JointReader(names, drives, version, notes, unmodelled, faults)
    read = [reader.read(element) for element in root.all("joint")]
    joints = _unique([joint for joint in read if joint is not None], "joint", faults)
    unknown = set(drives) - {_name_of(element) for element in root.all("joint")}
    if unknown:
        notes.append(f"transmissions of joints that do not exist: {', '.join(sorted(unknown))}")
    if reader.unkept:
        notes.append(
            f"limits of deceleration and jerk are not looked at ({', '.join(reader.unkept)})"
        )
    if not names:
        faults.add(root.where.error("robot", "no <link>; a robot has links; give a complete URDF"))
    return Items(by_name, joints, notes, unmodelled)


def read_structure(root: Element, items: Items) -> UrdfDescription:
    """The description of links and joints that were all read.

    Raises:
        DescriptionError: Joints that mimic none or each other; links that are no tree.
    """
    for joint in items.joints.values():
        _check_mimic(joint, items.joints)
    return _structured(root, items)


def _name_of(element: Element) -> str:
    return element.attributes.get("name", "")


def _version(root: Element) -> float:
    """The version of the format, 1.0 where none is written."""
    if root.tag != "robot":
        raise root.where.error(
            "", f"the first element is <{root.tag[:60]}>; a URDF holds one <robot>; give a URDF"
        )
    if any(child.tag in _HRDF and not _name_of(child) for child in root.children):
        raise root.where.error("", HRDF)
    written = root.attributes.get("version", "1.0").strip()
    if written not in VERSIONS:
        raise root.where.error(
            "robot",
            f"version {shown(written)}; URDF 1.0, 1.1 and 1.2 are read, and another version may "
            'mean other things by the same words; save the file as one of these (version="1.0" '
            "where the number is the robot's own)",
        )
    return VERSIONS[written]


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


def _structured(root: Element, items: Items) -> UrdfDescription:
    """The description with its tree, after every way not to be one has been excluded."""
    links, joints = items.links, items.joints
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
    notes = tuple(items.notes)
    return UrdfDescription(
        name, links, joints, roots[0], notes, root.where, above, below, items.unmodelled
    )


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


def _unique(items: Sequence[T], kind: str, faults: Faults) -> dict[str, T]:
    found: dict[str, T] = {}
    for item in items:
        if item.name in found:
            faults.add(
                item.where.error(
                    f"{kind} {item.name}",
                    f"a second {kind} of this name (first on line {found[item.name].where.line}); "
                    "names differ; rename one",
                )
            )
        found.setdefault(item.name, item)
    return found


def _link(element: Element, version: float) -> Link:
    name = read_name(element)
    owner = f"link {name}"
    refuse_slips(element, owner, _LINK, ("name", "type"))
    inertial = element.one("inertial", owner)
    if inertial is None:
        return Link(name, None, element.where)
    return _inertial(inertial, name, owner, version, element.where)


def _inertial(element: Element, name: str, owner: str, version: float, where: Where) -> Link:
    refuse_slips(element, owner, ("origin", "mass", "inertia"), ())
    zero = UrdfNumber(ScalarNode("0", element.where), 0.0)
    faults: dict[str, DescriptionError] = {}
    mass, tensor = zero, (zero,) * len(_ENTRIES)
    xyz, pose, rotated = (zero, zero, zero), IDENTITY, False
    try:
        origin = element.one("origin", owner)
        written, pose, rotated = read_pose(origin, owner, version)
        xyz = xyz if origin is None else written
    except DescriptionError as fault:
        faults["com"] = fault
    try:
        part = _part(element, "mass", owner, ("value",))
        mass = required(part, "value", owner)
    except DescriptionError as fault:
        faults["mass"] = fault
    try:
        part = _part(element, "inertia", owner, _ENTRIES)
        tensor = tuple(required(part, entry, owner) for entry in _ENTRIES)
    except DescriptionError as fault:
        faults["inertia"] = fault
    return Link(name, Inertial(mass, xyz, pose, rotated, tensor, element.where), where, faults)


def _part(element: Element, tag: str, owner: str, attributes: Sequence[str]) -> Element:
    part = element.one(tag, owner)
    if part is None:
        raise element.where.error(
            owner,
            f"<inertial> has no <{tag}>; nothing is guessed; add it, or remove <inertial> from a "
            "frame without mass",
        )
    refuse_foreign(part, owner, attributes)
    return part


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
                "one of them is the leader; remove its <mimic>",
            )
        chain.append(mimic.leader)
