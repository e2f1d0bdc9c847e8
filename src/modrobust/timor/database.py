"""Reading of Timor's ``modules.json``: bodies and connectors as the database has them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from modrobust.checks import did_you_mean, unknown_name
from modrobust.checks.files import kind_of_path, reason
from modrobust.errors import FileError
from modrobust.formats import ListNode, MapNode, Node, ScalarNode, Where
from modrobust.formats.nodes import shown
from modrobust.model.checks import is_rotation
from modrobust.model.geometry import Transform, from_rows

MAX_BYTES = 1 << 20
_BODY = ("ID", "mass", "r_com", "inertia", "connectors", "collision", "visual")
LARGEST = 1e100  # of a mass, a length or an inertia: products of three stay finite
_RIGID = 1e-6  # how far a rotation may be from orthonormal; databases have few digits


@dataclass(frozen=True, eq=False)
class TimorBody:
    """A rigid body of a module: mass [kg], COM (3,) [m], tensor [kg m^2], and its connectors."""

    id: str
    mass: Fraction
    com: tuple[Fraction, ...]
    tensor: tuple[Fraction, ...]  # xx, xy, xz, yy, yz, zz as written
    texts: tuple[tuple[str, ...], tuple[str, ...], str]  # com, tensor, mass
    connectors: tuple[TimorConnector, ...]
    where: Where


@dataclass(frozen=True, eq=False)
class TimorConnector:
    """Where another module can mount: its pose in the body's frame, and what it mounts on."""

    id: str
    pose: Transform
    gender: str
    type: str
    size: str


def read_database(path: str | Path) -> str:
    """The text of a module database, in which infinities have become null.

    Raises:
        FileError: It cannot be read, is no UTF-8 text, or is larger than `MAX_BYTES`.
    """
    try:
        if kind_of_path(path) == "other":
            raise FileError(path, "is a pipe or a device; expected a file; save it as one")
        with Path(path).open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as error:
        raise FileError(path, f"cannot be read: {reason(error)}; check the path") from None
    except UnicodeDecodeError:
        raise FileError(path, "not UTF-8 text; give Timor's modules.json") from None
    if len(data) > MAX_BYTES:
        raise FileError(path, "more than 1 MiB; a module database has at most that; split it")
    # Python writes "no limit" so, which JSON does not know.
    return re.sub(r"(?<=[\s:\[,])-?Infinity\b", "null", text)


def read_bodies(node: Node, name: str) -> dict[str, TimorBody]:
    """The bodies of a module by their ID.

    Args:
        node: The module.
        name: What messages call it.

    Raises:
        DescriptionError: A body is wrong, or two have one ID.
    """
    found: dict[str, TimorBody] = {}
    for index, entry in enumerate(members(member(node, "bodies", name), f"{name}.bodies")):
        field = f"{name}.bodies[{index}]"
        body = _body(entry, field)
        if body.id in found:
            raise entry.where.error(field, f'a second body with the ID "{body.id}"')
        found[body.id] = body
    return found


def _body(node: Node, field: str) -> TimorBody:
    for key in node.entries if isinstance(node, MapNode) else ():
        if key not in _BODY:
            raise node.where.error(
                field,
                f"unknown key {shown(key)}; {did_you_mean(key, _BODY)}Timor refuses it too; "
                "correct or remove it",
            )
    com = _numbers(member(node, "r_com", field), 3, f"{field}.r_com")
    rows = [
        _numbers(row, 3, f"{field}.inertia")
        for row in members(member(node, "inertia", field), f"{field}.inertia", 3)
    ]
    if any(Fraction(rows[i][j]) != Fraction(rows[j][i]) for i, j in ((0, 1), (0, 2), (1, 2))):
        raise node.where.error(
            f"{field}.inertia",
            "the tensor is not symmetric; an inertia is; write the same on both sides of its "
            "diagonal",
        )
    six = (rows[0][0], rows[0][1], rows[0][2], rows[1][1], rows[1][2], rows[2][2])
    mass = number(member(node, "mass", field), f"{field}.mass")
    connectors = optional_member(node, "connectors")
    nodes = [] if connectors is None else members(connectors, f"{field}.connectors")
    return TimorBody(
        text_of(node, "ID", field),
        Fraction(mass),
        tuple(Fraction(text) for text in com),
        tuple(Fraction(text) for text in six),
        (tuple(com), six, mass),
        tuple(_read_connector(c, f"{field}.connectors[{i}]") for i, c in enumerate(nodes)),
        node.where,
    )


def _read_connector(node: Node, field: str) -> TimorConnector:
    size = optional_member(node, "size")
    gender = text_of(node, "gender", field)
    known = {"f": "f", "female": "f", "m": "m", "male": "m", "h": "n", "hermaphroditic": "n"}
    if gender not in known:
        raise node.where.error(
            f"{field}.gender", unknown_name(f"no gender {shown(gender)}", gender, known)
        )
    return TimorConnector(
        text_of(node, "ID", field),
        read_pose(member(node, "pose", field), f"{field}.pose"),
        known[gender],
        text_of(node, "type", field),
        "x".join(texts_of(size)) if size is not None else "",
    )


def member(node: Node, key: str, field: str) -> Node:
    """What stands under a key.

    Raises:
        DescriptionError: The key is missing, or the node is no mapping.
    """
    if isinstance(node, MapNode) and key in node.entries:
        return node.entries[key]
    raise node.where.error(field, f'no "{key}"; a Timor module database has it')


def optional_member(node: Node, key: str) -> Node | None:
    """What stands under a key, None where there is none."""
    return node.entries.get(key) if isinstance(node, MapNode) else None


def members(node: Node, field: str, length: int | None = None) -> Sequence[Node]:
    """The items of a list, which must have this length where one is given.

    Raises:
        DescriptionError: The node is no list, or of another length.
    """
    if not isinstance(node, ListNode) or length not in (None, len(node.items)):
        wanted = "a list" if length is None else f"a list of {length}"
        raise node.where.error(field, f"not {wanted}; a Timor module database has one there")
    return node.items


def text_of(node: Node, key: str, field: str) -> str:
    """The text under a key.

    Raises:
        DescriptionError: The key is missing, or a list or mapping stands there.
    """
    entry = member(node, key, field)
    if not isinstance(entry, ScalarNode):
        raise entry.where.error(f"{field}.{key}", "not a text; a Timor module database has one")
    return entry.text


def texts_of(node: Node) -> list[str]:
    """The texts of a list, or the one text; lists and mappings in it are passed over."""
    items = node.items if isinstance(node, ListNode) else (node,)
    return [item.text for item in items if isinstance(item, ScalarNode)]


def number(node: Node, field: str) -> str:
    """A number as the database has it, digit by digit.

    Raises:
        DescriptionError: It is no finite number, or beyond `LARGEST`.
    """
    text = _decimal(node, field)
    if abs(Fraction(text)) > LARGEST:
        raise node.where.error(field, f'"{text[:60]}" is beyond {LARGEST:g}; check its exponent')
    return text


def _decimal(node: Node, field: str) -> str:
    text = node.text if isinstance(node, ScalarNode) else ""
    if not re.fullmatch(r"[+-]?[0-9]+(\.[0-9]*)?([eE][+-]?[0-9]{1,3})?", text):
        raise node.where.error(
            field, f'"{text[:60]}" is not a finite number; write one in decimal digits'
        )
    return text


def finite(node: Node | None) -> str | None:
    """A number as written; None for none, null and the infinities that stand for no limit."""
    if not isinstance(node, ScalarNode) or node.text.lower().strip('-+"') in (
        "null",
        "inf",
        "infinity",
    ):
        return None
    return _decimal(node, "limits")


def _numbers(node: Node, length: int, field: str) -> list[str]:
    return [number(item, field) for item in members(node, field, length)]


def read_pose(node: Node, field: str) -> Transform:
    """A homogeneous transform, (4, 4) with lengths in [m], in exact numbers.

    Raises:
        DescriptionError: It is no matrix of numbers, or its rotation is off by more than 1e-6.
    """
    rows = [_numbers(row, 4, field) for row in members(node, field, 4)]
    matrix = np.array(rows, dtype=np.float64)
    if not is_rotation(matrix[:3, :3], _RIGID) or not np.array_equal(
        matrix[3], [0.0, 0.0, 0.0, 1.0]
    ):
        raise node.where.error(
            field,
            "not a rigid transform; it is [R p; 0 0 0 1] with a right-handed, orthonormal R; "
            "write R with seven digits or more",
        )
    return from_rows([[Fraction(text) for text in row] for row in rows[:3]])
