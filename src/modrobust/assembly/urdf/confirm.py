"""A second opinion: yourdfpy reads the checked bytes, and both readings must agree."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np

from modrobust.assembly.urdf.joints import Joint
from modrobust.assembly.urdf.reader import Link, UrdfDescription
from modrobust.assembly.urdf.values import read_pose
from modrobust.assembly.urdf.xml import Element, serialise
from modrobust.model.geometry import Transform
from modrobust.model.orientation import roll_pitch_yaw

# Shapes, looks and other tools' dialects: nothing here uses them, and meshes stay unread.
_DROPPED = ("visual", "collision", "material", "gazebo", "transmission", "sensor", "ros2_control",
            "calibration", "safety_controller", "contact", "plugin")  # fmt: skip
_TOLERANCE = 1e-9  # [m] or of the rotation: two ways to compute a rotation from rpy


def confirm(description: UrdfDescription, root: Element) -> None:
    """Holds our reading against that of yourdfpy.

    Raises:
        DescriptionError: The two differ in a link, a joint or a number.
    """
    from yourdfpy import URDF  # 1 s and 30 packages, hence here

    other = URDF.load(
        io.BytesIO(serialise(_plain(root, description), _DROPPED)),
        build_scene_graph=False,
        build_collision_scene_graph=False,
        load_meshes=False,
        load_collision_meshes=False,
    ).robot
    links = {link.name: link for link in other.links}
    joints = {joint.name: joint for joint in other.joints}
    for name, link in description.links.items():
        if link.faults and name in links:
            continue
        if name not in links or not _same_link(link, links[name]):
            raise link.where.error(f"link {name}", _differs())
    for name, joint in description.joints.items():
        if name not in joints or not _same_joint(joint, joints[name]):
            raise joint.where.error(f"joint {name}", _differs())


def _plain(root: Element, description: UrdfDescription) -> Element:
    """The tree without what yourdfpy cannot read: quaternions, inertials that an overlay mends."""

    def plain(element: Element) -> Element:
        attributes = dict(element.attributes)
        if element.tag == "origin" and "quat_xyzw" in attributes:
            rotated = read_pose(element, "", 1.1)[1].rounded()
            attributes.pop("quat_xyzw")
            attributes["rpy"] = " ".join(map(repr, roll_pitch_yaw(rotated[:3, :3])))
        link = description.links.get(attributes.get("name", "")) if element.tag == "link" else None
        children = [
            plain(child)
            for child in element.children
            if child.tag not in _DROPPED and not (link and link.faults and child.tag == "inertial")
        ]
        return replace(element, attributes=attributes, children=children)

    return plain(root)


def _differs() -> str:
    return (
        "yourdfpy, a second reader, understands this differently; a description has one meaning; "
        "write it without what the two could differ about"
    )


def _same_link(link: Link, other: Any) -> bool:
    if link.inertial is None or other.inertial is None:
        return link.inertial is None and other.inertial is None
    xx, xy, xz, yy, yz, zz = (entry.value for entry in link.inertial.tensor)
    return (
        bool(np.array_equal(other.inertial.inertia, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        and other.inertial.mass == link.inertial.mass.value
        and _same_pose(link.inertial.origin, other.inertial.origin)
    )


def _same_joint(joint: Joint, other: Any) -> bool:
    given = np.asarray(other.axis, dtype=np.float64)
    axis = joint.axis.rounded()[:3, 2]
    along = joint.type in ("fixed", "floating") or bool(
        np.allclose(np.cross(axis, given), 0.0, atol=1e-9 * np.abs(given).max())
        and np.sum(axis * given) > 0.0
    )
    return (
        (other.type, other.parent, other.child) == (joint.type, joint.parent, joint.child)
        and (None if other.mimic is None else other.mimic.joint)
        == (None if joint.mimic is None else joint.mimic.leader)
        and along
        and all(
            _same_limit(joint, other, name) for name in ("lower", "upper", "effort", "velocity")
        )
        and _same_pose(joint.origin, other.origin)
    )


def _same_limit(joint: Joint, other: Any, name: str) -> bool:
    ours = getattr(joint, name)
    theirs = None if other.limit is None else getattr(other.limit, name)
    return theirs == (None if ours is None else ours.value)


def _same_pose(ours: Transform, other: Any) -> bool:
    pose = np.eye(4) if other is None else other
    return bool(np.allclose(ours.rounded(), pose, atol=_TOLERANCE, rtol=0.0))
