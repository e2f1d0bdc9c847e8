"""Names and numbers of a URDF: each is what it must be, or refused at its line."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from modrobust.assembly.urdf.xml import Element
from modrobust.checks import did_you_mean
from modrobust.formats import ScalarNode, Where
from modrobust.formats.nodes import shown
from modrobust.model.geometry import MAX_ANGLE, Transform, from_xyz_quaternion, from_xyz_rpy

MAX_NAME = 100
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
_INFINITE = re.compile(r"[+-]?(?:inf|infinity)", re.IGNORECASE)
_UNIT_LENGTH = 1e-2  # a quaternion whose length is further off 1 is a slip

# What other formats and people call the same, where no letter would give it away.
_OTHER_WORDS = {
    "xyz": ("value", "position", "pos", "translation", "vector", "direction", "dir"),
    "rpy": ("rotation", "rot", "orientation", "euler", "angles"),
    "quat_xyzw": ("quat", "quaternion", "xyzw", "quat_wxyz", "wxyz"),
    "lower": ("min", "minimum", "min_position", "low", "lower_limit"),
    "upper": ("max", "maximum", "max_position", "high", "upper_limit"),
    "effort": ("torque", "force", "max_effort", "max_torque", "max_force", "effort_limit"),
    "velocity": ("speed", "max_velocity", "max_speed", "velocity_limit"),
    "acceleration": ("max_acceleration", "acceleration_limit"),
    "joint": ("leader", "joint_name"),
    "multiplier": ("ratio", "gear_ratio", "factor"),
    "value": ("mass", "kg"),
}


@dataclass(frozen=True)
class UrdfNumber:
    """A number of the file: its node and its nearest double."""

    node: ScalarNode
    value: float

    @property
    def exact(self) -> Fraction:
        """The number as written."""
        return Fraction(self.node.text)


def read_name(element: Element, attribute: str = "name") -> str:
    """The name that an attribute gives; refused when missing, unprintable or too long."""
    name = element.attributes.get(attribute)
    if name is None or not name.strip():
        raise element.where.error(
            f"<{element.tag}>", f'no "{attribute}"; it is required; add {attribute}="..."'
        )
    if len(name) > MAX_NAME or not name.isprintable():
        raise element.where.error(
            f"<{element.tag}>",
            f"{shown(name)} is not a name; names are printable and at most {MAX_NAME} "
            "characters; rename it",
        )
    return name


def refuse_slips(
    element: Element, owner: str, children: Sequence[str], attributes: Sequence[str]
) -> None:
    """Refuses what is close to something known: a slip that would be overlooked.

    Elements and attributes of other tools' dialects stand in many files and change nothing here.
    """
    for child in element.children:
        if child.tag not in children and (hint := slip(child.tag, children)):
            raise child.where.error(owner, f"unknown element <{child.tag}>; {hint}rename it")
    for key in element.attributes:
        if key not in attributes and (hint := slip(key, attributes)):
            raise element.where.error(
                owner, f'unknown attribute "{key}" of <{element.tag}>; {hint}rename it'
            )


def slip(name: str, known: Sequence[str]) -> str:
    """``did you mean "x"? `` where a letter or two make the difference, else nothing."""
    alike = [word for word in known if abs(len(word) - len(name)) <= 2]
    close = difflib.get_close_matches(name[:MAX_NAME], alike, 1, 0.7)
    return f'did you mean "{close[0]}"? ' if close else ""


def refuse_foreign(
    element: Element, owner: str, attributes: Sequence[str], passed: Sequence[str] = ()
) -> None:
    """Refuses whatever an element holds that is not read: its numbers are attributes we know.

    Args:
        element: One of those in which everything bears on the motion, such as ``<origin>``.
        owner: What messages call its owner.
        attributes: Those that are read.
        passed: Others, of known meaning, that say nothing about the motion.
    """
    for key in element.attributes:
        if key not in attributes and key not in passed:
            raise element.where.error(
                owner,
                f'unknown attribute "{key[:60]}" of <{element.tag}>; {_meant(key, attributes)}'
                "rename or remove it",
            )
    for child in element.children:
        raise child.where.error(
            owner,
            f"an element <{child.tag[:60]}> inside <{element.tag}>; "
            f"{_meant(child.tag, attributes)}its figures are attributes; write them so",
        )
    if element.text:
        raise element.where.error(
            owner,
            f"the text {shown(element.text)} inside <{element.tag}>; its figures are attributes "
            f"({', '.join(attributes)}); write them so",
        )


def _meant(name: str, known: Sequence[str]) -> str:
    low = name.rpartition(":")[2].lower()
    same = [word for word in known if word == low or low in _OTHER_WORDS.get(word, ())]
    if same:
        return f'did you mean "{same[0]}"? '
    return did_you_mean(low, known) or f"known: {', '.join(known)}; "


def read_number(
    element: Element, key: str, text: str, owner: str, endless: bool = False
) -> UrdfNumber:
    """A decimal number in SI units, as written; anything else is refused.

    Args:
        element: Where it stands.
        key: Its name in messages.
        text: As written.
        owner: What messages call its owner.
        endless: Whether it may be infinite or huge, as limits are that mean none.
    """
    stripped = text.strip()
    if endless and _INFINITE.fullmatch(stripped):
        return UrdfNumber(ScalarNode(stripped, element.where), float(stripped))
    if not _NUMBER.fullmatch(stripped):
        low = stripped.lower().lstrip("+-")
        what = "is not finite" if low in ("nan", "inf", "infinity") else "is not a number"
        raise element.where.error(
            f"{owner}, {key}",
            f"{shown(text)} {what}; numbers in a URDF are decimal, in SI units without the unit; "
            'write it so, such as "0.25"',
        )
    value = float(stripped)
    if not endless and not abs(value) <= 1e100:
        raise element.where.error(
            f"{owner}, {key}", f"{shown(text)} is out of range; correct the exponent"
        )
    return UrdfNumber(ScalarNode(stripped, element.where), value)


def required(element: Element, key: str, owner: str) -> UrdfNumber:
    """The number of an attribute that must be there; nothing is guessed."""
    if key not in element.attributes:
        raise element.where.error(
            owner,
            f'<{element.tag}> has no "{key}"; nothing is guessed; add {key}="..."',
        )
    return read_number(element, key, element.attributes[key], owner)


def optional(
    element: Element | None, key: str, owner: str, endless: bool = False
) -> UrdfNumber | None:
    """The number of an attribute, None where it is not written; see `read_number`."""
    if element is None or key not in element.attributes:
        return None
    return read_number(element, key, element.attributes[key], owner, endless)


def vector(
    element: Element | None, key: str, owner: str, default: str = "0 0 0"
) -> tuple[UrdfNumber, ...]:
    """The numbers of an attribute, separated by blanks, as many as the default has."""
    text = default if element is None else element.attributes.get(key, default)
    parts, wanted = text.split(), {3: "three", 4: "four"}[len(default.split())]
    place = element or Element("", {}, Where("", None))
    if len(parts) != len(default.split()):
        raise place.where.error(
            f"{owner}, {key}",
            f"{shown(text)} has {len(parts)} entries; a vector has {wanted}, with blanks between; "
            f'write {wanted}, such as "{default}"',
        )
    return tuple(read_number(place, key, part, owner) for part in parts)


def three(
    element: Element | None, key: str, owner: str, default: str = "0 0 0"
) -> tuple[UrdfNumber, UrdfNumber, UrdfNumber]:
    """The three numbers of an attribute, separated by blanks."""
    x, y, z = vector(element, key, owner, default)
    return x, y, z


def read_pose(
    element: Element | None, owner: str, version: float = 1.0
) -> tuple[tuple[UrdfNumber, UrdfNumber, UrdfNumber], Transform, bool]:
    """The three lengths, the transform as written and whether it turns.

    Args:
        element: ``<origin>``, None for no motion.
        owner: What messages call its owner.
        version: Of the URDF; from 1.1 on `quat_xyzw` may stand in the place of `rpy`.
    """
    if element is not None:
        refuse_foreign(element, owner, ("xyz", "rpy", "quat_xyzw"))
    xyz = three(element, "xyz", owner)
    if element is not None and "quat_xyzw" in element.attributes:
        return _by_quaternion(element, owner, xyz, version)
    rpy = three(element, "rpy", owner)
    for angle in rpy:
        if abs(angle.value) > MAX_ANGLE:
            raise angle.node.where.error(
                f"{owner}, rpy",
                f"{angle.value:g} rad; an angle lies within {MAX_ANGLE:g} rad; reduce it by "
                "whole turns",
            )
    angles = [number.exact for number in rpy]
    return xyz, from_xyz_rpy([number.exact for number in xyz], angles), any(angles)


def _by_quaternion(
    element: Element, owner: str, xyz: tuple[UrdfNumber, UrdfNumber, UrdfNumber], version: float
) -> tuple[tuple[UrdfNumber, UrdfNumber, UrdfNumber], Transform, bool]:
    field = f"{owner}, quat_xyzw"
    if version < 1.1:
        raise element.where.error(
            field,
            f"in a URDF of version {version:g}, whose readers pass over it; a quaternion belongs "
            'to version 1.1; write <robot ... version="1.1">, or rpy',
        )
    if "rpy" in element.attributes:
        raise element.where.error(
            field, "beside rpy; an origin is rotated once; remove one of the two"
        )
    numbers = vector(element, "quat_xyzw", owner, "0 0 0 1")
    length = sum(number.value**2 for number in numbers) ** 0.5
    if abs(length - 1.0) > _UNIT_LENGTH:
        raise element.where.error(
            field,
            f"length {length:.6g}; the four numbers x y z w of a rotation have length 1; "
            "correct them",
        )
    quaternion = [number.exact for number in numbers]
    pose = from_xyz_quaternion([number.exact for number in xyz], quaternion)
    return xyz, pose, any(quaternion[:3])
