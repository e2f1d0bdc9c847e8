"""Names and numbers of a URDF: each is what it must be, or refused at its line."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from modrobust.formats import ScalarNode, Where
from modrobust.formats.nodes import shown
from modrobust.geometry import MAX_ANGLE, Transform, from_xyz_rpy
from modrobust.urdf_xml import Element

MAX_NAME = 100
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")


@dataclass(frozen=True)
class Number:
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
            raise child.where.error(owner, f"unknown element <{child.tag}>; {hint}correct it")
    for key in element.attributes:
        if key not in attributes and (hint := slip(key, attributes)):
            raise element.where.error(
                owner, f'unknown attribute "{key}" of <{element.tag}>; {hint}correct it'
            )


def slip(name: str, known: Sequence[str]) -> str:
    """``did you mean "x"? `` where a letter or two make the difference, else nothing."""
    alike = [word for word in known if abs(len(word) - len(name)) <= 2]
    close = difflib.get_close_matches(name[:MAX_NAME], alike, 1, 0.7)
    return f'did you mean "{close[0]}"? ' if close else ""


def read_number(element: Element, key: str, text: str, owner: str) -> Number:
    """A finite decimal number in SI units, as written; anything else is refused."""
    stripped = text.strip()
    if not _NUMBER.fullmatch(stripped):
        low = stripped.lower().lstrip("+-")
        what = "is not finite" if low in ("nan", "inf", "infinity") else "is not a number"
        raise element.where.error(
            f"{owner}, {key}",
            f"{shown(text)} {what}; numbers in a URDF are decimal, in SI units without the unit; "
            "correct it",
        )
    value = float(stripped)
    if not np.isfinite(value) or abs(value) > 1e100:
        raise element.where.error(
            f"{owner}, {key}", f"{shown(text)} is out of range; correct the exponent"
        )
    return Number(ScalarNode(stripped, element.where), value)


def required(element: Element, key: str, owner: str) -> Number:
    """The number of an attribute that must be there; nothing is guessed."""
    if key not in element.attributes:
        raise element.where.error(
            owner,
            f'<{element.tag}> has no "{key}"; nothing is guessed; add {key}="..."',
        )
    return read_number(element, key, element.attributes[key], owner)


def optional(element: Element | None, key: str, owner: str) -> Number | None:
    """The number of an attribute, None where it is not written."""
    if element is None or key not in element.attributes:
        return None
    return read_number(element, key, element.attributes[key], owner)


def three(
    element: Element | None, key: str, owner: str, default: str = "0 0 0"
) -> tuple[Number, Number, Number]:
    """The three numbers of an attribute, separated by blanks."""
    text = default if element is None else element.attributes.get(key, default)
    parts = text.split()
    place = element or Element("", {}, Where("", None))
    if len(parts) != 3:
        raise place.where.error(
            f"{owner}, {key}",
            f"{shown(text)} has {len(parts)} entries; a vector has three, with blanks between; "
            "correct it",
        )
    x, y, z = (read_number(place, key, part, owner) for part in parts)
    return x, y, z


def read_pose(
    element: Element | None, owner: str
) -> tuple[tuple[Number, Number, Number], Transform, bool]:
    """The three lengths, the transform as written and whether it turns."""
    if element is not None:
        refuse_slips(element, owner, (), ("xyz", "rpy"))
    xyz, rpy = three(element, "xyz", owner), three(element, "rpy", owner)
    for angle in rpy:
        if abs(angle.value) > MAX_ANGLE:
            raise angle.node.where.error(
                f"{owner}, rpy",
                f"{angle.value:g} rad; an angle lies within {MAX_ANGLE:g} rad; correct it",
            )
    angles = [number.exact for number in rpy]
    return xyz, from_xyz_rpy([number.exact for number in xyz], angles), any(angles)
