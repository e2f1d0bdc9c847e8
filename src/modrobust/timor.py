r"""Import of the module database of Timor (``modules.json``) as module files of this project.

A Timor module is a set of bodies with connectors, and joints between bodies. Connector frames point
away from their body and mate face to face, turned by Rx(pi); ours point to the tip throughout, so
that with P the pose of a connector in its body

.. math:: in = P\, R_x(\pi), \qquad out = P .

A body's tensor is about its COM in one reading of the public databases and about its frame in the
other; which one holds is decided by what a rigid body can have (`inertia_reading`).

Source: Külz, Mayer, Althoff 2023, "Timor Python: A Toolbox for Industrial Modular Robotics".
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from modrobust.errors import DescriptionError, FileError, ValueRangeError
from modrobust.formats import ListNode, MapNode, Node, ScalarNode, Where
from modrobust.formats.inertia import positive_definite, steiner
from modrobust.formats.json_reader import parse_json
from modrobust.geometry import inverse, rotation_x

Array = NDArray[np.float64]

MAX_BYTES = 1 << 20
READINGS = ("com", "frame")
_DIGITS = 12  # decimals of a length [m] that a description keeps: 1e-12 m
_RIGHT = 1e-9  # [rad]; nearer to a multiple of 90 degrees is meant as one
_TRIANGLE = 1e-9  # relative, as for module files
_SETS = {"revolute": "torque", "continuous": "torque", "prismatic": "force"}


@dataclass(frozen=True)
class Imported:
    """One module: its id, the text of its file, remarks."""

    id: str
    text: str
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Import:
    """What came of a database: modules, those that were left out with the reason, remarks."""

    modules: tuple[Imported, ...]
    left_out: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Body:
    id: str
    mass: Fraction
    com: tuple[Fraction, ...]
    tensor: tuple[Fraction, ...]  # xx, xy, xz, yy, yz, zz as written
    texts: tuple[tuple[str, ...], tuple[str, ...], str]  # com, tensor, mass
    connectors: tuple[_Connector, ...]
    where: Where


@dataclass(frozen=True, eq=False)
class _Connector:
    id: str
    pose: Array
    gender: str
    type: str
    size: str


@dataclass(frozen=True, eq=False)
class _Joint:
    id: str
    parent: str
    child: str
    type: str
    to_joint: Array  # parent body to joint
    to_child: Array  # joint to child body
    fields: MapNode


def import_timor(path: str | Path, inertia_about: str | None = None) -> Import:
    """The modules of a Timor database.

    Args:
        path: ``modules.json``.
        inertia_about: "com" or "frame", the reference point of every tensor; None = decided body by
            body, by which reading a rigid body can have.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: The file is no such database.
        ValueRangeError: `inertia_about` is something else.
    """
    if inertia_about not in (None, *READINGS):
        raise ValueRangeError(f'inertia_about: "{inertia_about}" is none of {", ".join(READINGS)}')
    root = parse_json(_read(path), os.fspath(path))
    modules = _list(_entry(root, "modules", ""), "modules")
    default = inertia_about or _majority(modules)
    done: dict[str, Imported] = {}
    left_out: list[tuple[str, str]] = []
    for index, node in enumerate(modules):
        name = f"modules[{index}]"
        try:
            module = _module(node, name, inertia_about, default, Path(path).name)
            if module.id in done:
                raise node.where.error(name, f'a second module with the id "{module.id}"')
        except DescriptionError as problem:
            left_out.append((name, str(problem)))
            continue
        done[module.id] = module
    notes = []
    if inertia_about is None:
        notes.append(
            f'tensors that both readings allow are taken as about the "{default}"; '
            "--inertia-about com|frame overrides it for all"
        )
    return Import(tuple(done.values()), tuple(left_out), tuple(notes))


def write_modules(result: Import, directory: str | Path) -> list[Path]:
    """Writes one file a module into a directory, which is made when it is not there.

    Raises:
        FileError: The directory cannot be written, or one of the files exists.
    """
    folder = Path(directory)
    paths = [folder / f"{module.id}.yaml" for module in result.modules]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path in paths:
            if path.exists():
                raise FileError(path, "exists; an import overwrites nothing; give an empty folder")
        for path, module in zip(paths, result.modules, strict=True):
            path.write_text(module.text, encoding="utf-8")
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise FileError(folder, f"cannot be written: {reason}; give a folder that can be") from None
    return paths


def inertia_reading(
    mass: Fraction, com: Sequence[Fraction], tensor: Sequence[Fraction]
) -> tuple[str, ...]:
    """The readings ("com", "frame") of a tensor that a rigid body can have."""
    shift = steiner(mass, com)
    about_frame = [entry - part for entry, part in zip(tensor, shift, strict=True)]
    candidates = {"com": list(tensor), "frame": about_frame}
    return tuple(name for name, entries in candidates.items() if _physical(entries))


def _physical(entries: Sequence[Fraction]) -> bool:
    if not positive_definite(entries):
        return False
    xx, xy, xz, yy, yz, zz = (float(entry) for entry in entries)
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return bool(moments[2] - moments[1] - moments[0] <= _TRIANGLE * moments[2])


def _majority(modules: Sequence[Node]) -> str:
    """The reading that more bodies of the file need, "com" (Timor's own) when as many."""
    votes = dict.fromkeys(READINGS, 0)
    for index, node in enumerate(modules):
        try:
            bodies = _bodies(node, f"modules[{index}]")
        except DescriptionError:
            continue
        for body in bodies.values():
            if body.mass > 0:
                readings = inertia_reading(body.mass, body.com, body.tensor)
                if len(readings) == 1:
                    votes[readings[0]] += 1
    return "frame" if votes["frame"] > votes["com"] else "com"


def _read(path: str | Path) -> str:
    try:
        if Path(path).exists() and not (Path(path).is_file() or Path(path).is_dir()):
            raise FileError(path, "is a pipe or a device; expected a file; save it as one")
        with Path(path).open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as error:
        reason = (error.strerror or "unknown reason").lower()
        raise FileError(path, f"cannot be read: {reason}; check the path") from None
    except UnicodeDecodeError:
        raise FileError(path, "not UTF-8 text; give Timor's modules.json") from None
    if len(data) > MAX_BYTES:
        raise FileError(path, "more than 1 MiB; a module database has at most that; split it")
    # Python writes "no limit" so, which JSON does not know.
    return re.sub(r"(?<=[\s:\[,])-?Infinity\b", "null", text)


def _module(
    node: Node, name: str, inertia_about: str | None, default: str, source: str
) -> Imported:
    header = _entry(node, "header", name)
    identity = _slug(_text(header, "ID", name))
    bodies = _bodies(node, name)
    joints = _joints(node, name, bodies)
    start, end = _ends(bodies, node, name)
    path = _path(start[0], end[0], bodies, joints, node, name)
    notes: list[str] = []
    chain = _chain(path, start, end, inertia_about, default, notes)
    ends = [("in", start[1]), ("out", end[1])]
    author = _optional(header, "author")
    authors = ", ".join(_texts(author)) if author is not None else "unknown author"
    lines = [
        "# Imported from a Timor module database; no bounds are known: every figure is exact.",
        "modrobust: 1",
        f"module: {identity}",
        f"name: {_quoted(_text(header, 'name', name))}",
        f"source: {_quoted(f'Timor {source}, ID ' + _text(header, 'ID', name) + ', ' + authors)}",
    ]
    if notes:
        lines += ["notes:", *(f"  - {_quoted(note)}" for note in notes)]
    lines += ["connectors:", *(line for key, c in ends for line in _connector(key, c))]
    lines += ["chain:", *chain]
    return Imported(identity, "\n".join(lines) + "\n", tuple(notes))


def _bodies(node: Node, name: str) -> dict[str, _Body]:
    found: dict[str, _Body] = {}
    for index, entry in enumerate(_list(_entry(node, "bodies", name), f"{name}.bodies")):
        field = f"{name}.bodies[{index}]"
        body = _body(entry, field)
        if body.id in found:
            raise entry.where.error(field, f'a second body with the ID "{body.id}"')
        found[body.id] = body
    return found


def _body(node: Node, field: str) -> _Body:
    com = _numbers(_entry(node, "r_com", field), 3, f"{field}.r_com")
    rows = [
        _numbers(row, 3, f"{field}.inertia")
        for row in _list(_entry(node, "inertia", field), f"{field}.inertia", 3)
    ]
    if any(Fraction(rows[i][j]) != Fraction(rows[j][i]) for i, j in ((0, 1), (0, 2), (1, 2))):
        raise node.where.error(f"{field}.inertia", "the tensor is not symmetric; correct it")
    six = (rows[0][0], rows[0][1], rows[0][2], rows[1][1], rows[1][2], rows[2][2])
    mass = _number(_entry(node, "mass", field), f"{field}.mass")
    connectors = _optional(node, "connectors")
    nodes = [] if connectors is None else _list(connectors, f"{field}.connectors")
    return _Body(
        _text(node, "ID", field),
        Fraction(mass),
        tuple(Fraction(text) for text in com),
        tuple(Fraction(text) for text in six),
        (tuple(com), six, mass),
        tuple(_read_connector(c, f"{field}.connectors[{i}]") for i, c in enumerate(nodes)),
        node.where,
    )


def _read_connector(node: Node, field: str) -> _Connector:
    size = _optional(node, "size")
    gender = _text(node, "gender", field)
    known = {"f": "f", "female": "f", "m": "m", "male": "m", "h": "n", "hermaphroditic": "n"}
    if gender not in known:
        raise node.where.error(f"{field}.gender", f'"{gender}" is none of {", ".join(known)}')
    return _Connector(
        _text(node, "ID", field),
        _pose(_entry(node, "pose", field), f"{field}.pose"),
        known[gender],
        _text(node, "type", field),
        "x".join(_texts(size)) if size is not None else "",
    )


def _joints(node: Node, name: str, bodies: dict[str, _Body]) -> list[_Joint]:
    found = []
    for index, entry in enumerate(_list(_entry(node, "joints", name), f"{name}.joints")):
        field = f"{name}.joints[{index}]"
        ends = [_text(entry, key, field) for key in ("parent", "child")]
        for end in ends:
            if end not in bodies:
                raise entry.where.error(field, f'no body with the ID "{end}"; correct it')
        kind = _text(entry, "type", field)
        passive = _optional(entry, "passive")
        if kind not in _SETS or (isinstance(passive, ScalarNode) and passive.text == "true"):
            raise entry.where.error(
                field,
                f"a {'passive ' if kind in _SETS else ''}{kind} joint; joints are driven and "
                f"one of {', '.join(_SETS)}",
            )
        assert isinstance(entry, MapNode)
        poses = [_pose(_entry(entry, key, field), field) for key in ("poseParent", "poseChild")]
        found.append(
            _Joint(_text(entry, "ID", field), ends[0], ends[1], kind, poses[0], poses[1], entry)
        )
    return found


Ends = tuple[str, _Connector]


def _ends(bodies: dict[str, _Body], node: Node, name: str) -> tuple[Ends, Ends]:
    """The connector towards the base and the one towards the tip, with their bodies."""
    every = [(body.id, c) for body in bodies.values() for c in body.connectors]
    if len(every) != 2:
        raise node.where.error(
            name, f"{len(every)} connectors; a module here has two, in and out; import it by hand"
        )
    first, second = every
    bases = [end for end in every if end[1].type == "base"]
    tools = [end for end in every if end[1].type == "eef"]
    into = [end for end in every if end[1].gender == "f"]
    if len(bases) == 1:
        start = bases[0]
    elif len(tools) == 1:
        start = second if tools[0] is first else first
    elif len(into) == 1:
        start = into[0]
    else:
        start = first  # both ways round are the same connector
    return start, (second if start is first else first)


def _path(
    start: str,
    end: str,
    bodies: dict[str, _Body],
    joints: list[_Joint],
    node: Node,
    name: str,
) -> list[tuple[_Body, _Joint | None]]:
    """Bodies from in to out, each with the joint that follows it."""
    by_parent = {joint.parent: joint for joint in joints}
    path: list[tuple[_Body, _Joint | None]] = []
    body = start
    while body != end:
        joint = by_parent.get(body)
        if joint is None or len(path) > len(bodies):
            raise node.where.error(
                name, "no chain of joints from the first connector to the second; import by hand"
            )
        path.append((bodies[body], joint))
        body = joint.child
    path.append((bodies[end], None))
    if len(path) != len(bodies):
        raise node.where.error(name, "bodies beside the chain from in to out; import it by hand")
    return path


def _chain(
    path: list[tuple[_Body, _Joint | None]],
    start: Ends,
    end: Ends,
    inertia_about: str | None,
    default: str,
    notes: list[str],
) -> list[str]:
    lines: list[str] = []
    frame = inverse(start[1].pose @ rotation_x(math.pi))
    names: set[str] = {"in", "out"}
    for count, (body, joint) in enumerate(path, 1):
        ahead = end[1].pose if joint is None else joint.to_joint
        if body.mass == 0 and not any(body.tensor):
            span = _span(frame @ ahead)
            if span:
                lines += [f"  - frame: to-{count}", *span]
        else:
            span = _span(frame)
            if span:
                lines += [f"  - frame: to-{count}", *span]
            lines += _body_lines(
                body, _unique(body.id, names), ahead, inertia_about, default, notes
            )
        if joint is None:
            break
        lines += _joint_lines(joint, _unique(joint.id, names))
        frame = joint.to_child
    return lines or ["  - frame: span"]


def _body_lines(
    body: _Body, name: str, ahead: Array, inertia_about: str | None, default: str, notes: list[str]
) -> list[str]:
    readings = inertia_reading(body.mass, body.com, body.tensor)
    about = inertia_about or (readings[0] if len(readings) == 1 else default)
    if not readings:
        raise body.where.error(
            f"body {body.id}",
            "the inertia tensor belongs to no rigid body, neither about the COM nor about the "
            "frame; correct the figures",
        )
    if about not in readings:
        raise body.where.error(
            f"body {body.id}",
            f"about the {about} no rigid body has this tensor, about the {readings[0]} one has; "
            f"import it with --inertia-about {readings[0]}",
        )
    why = (
        "as told"
        if inertia_about
        else ("the only physical reading" if len(readings) == 1 else "both readings are physical")
    )
    notes.append(f"body {name}: inertia taken as about the {about} ({why})")
    com, six, mass = body.texts
    entries = ", ".join(
        f"{key}: {text}"
        for key, text in zip(("xx", "xy", "xz", "yy", "yz", "zz"), six, strict=True)
        if Fraction(text) or key in ("xx", "yy", "zz")
    )
    return [
        f"  - body: {name}",
        *_span(ahead),
        f"    mass: {mass} kg",
        f"    com: [{', '.join(com)}]",
        f"    inertia: {{about: {about}, {entries}}}",
    ]


def _joint_lines(joint: _Joint, name: str) -> list[str]:
    lines = [f"  - joint: {name}", f"    type: {joint.type}"]
    limits = joint.fields.entries.get("limits")
    said = limits.entries if isinstance(limits, MapNode) else {}
    parts = []
    lo, hi = (_finite(said.get(key)) for key in ("positionLower", "positionUpper"))
    if lo is not None and hi is not None and joint.type != "continuous":
        parts.append(f"position: [{lo}, {hi}]")
    keys = (("velocity", "velocity"), (_SETS[joint.type], "peakTorque"))
    for key, theirs in (*keys, ("acceleration", "acceleration")):
        value = _finite(said.get(theirs))
        if value is not None and Fraction(value):
            parts.append(f"{key}: {value}")
    if parts:
        lines.append(f"    limits: {{{', '.join(parts)}}}")
    fields = joint.fields.entries
    motor, gear = (_finite(fields.get(key)) for key in ("motorInertia", "gearRatio"))
    if motor is not None and Fraction(motor):
        lines.append(f"    drive: {{gear_ratio: {gear or 1}, rotor_inertia: {motor}}}")
    friction = [
        f"{key}: {value}"
        for key, theirs in (("viscous", "frictionViscous"), ("coulomb", "frictionCoulomb"))
        if (value := _finite(fields.get(theirs))) is not None and Fraction(value)
    ]
    if friction:
        lines.append(f"    friction: {{{', '.join(friction)}}}")
    return lines


def _connector(key: str, connector: _Connector) -> list[str]:
    size = f", size: {connector.size}" if connector.size else ""
    kind = _quoted(connector.type or "timor")
    return [f"  {key}: {{type: {kind}{size}, gender: {connector.gender}}}"]


def _span(transform: Array) -> list[str]:
    """``span:`` of a transform, nothing for the identity."""
    xyz = [round(float(value), _DIGITS) + 0.0 for value in transform[:3, 3]]
    rpy = [_angle(value) for value in rpy_of(transform[:3, :3])]
    parts = []
    if any(xyz):
        parts.append(f"xyz: [{', '.join(f'{value:.12g}' for value in xyz)}]")
    if any(text != "0" for text in rpy):
        parts.append(f"rpy: [{', '.join(rpy)}]")
    return [f"    span: {{{', '.join(parts)}}}"] if parts else []


def rpy_of(rotation: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a rotation (3, 3) = Rz(yaw) Ry(pitch) Rx(roll)."""
    flat = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = math.atan2(-rotation[2, 0], flat)
    if flat > 1e-9:
        roll = math.atan2(rotation[2, 1], rotation[2, 2])
        return roll, pitch, math.atan2(rotation[1, 0], rotation[0, 0])
    # Pitch of +-90 degrees: only roll -+ yaw is determined; yaw is taken as 0.
    return math.atan2(math.copysign(1.0, pitch) * rotation[0, 1], rotation[1, 1]), pitch, 0.0


def _angle(value: float) -> str:
    quarters = round(value / (math.pi / 2))
    if abs(value - quarters * math.pi / 2) > _RIGHT:
        return repr(value)
    return {-2: "pi", -1: "-pi/2", 0: "0", 1: "pi/2", 2: "pi"}[quarters]


def _slug(text: str) -> str:
    slug = re.sub(r"[^A-Za-z0-9_-]+", "-", text).strip("-")[:100]
    return slug or "module"


def _unique(text: str, taken: set[str]) -> str:
    name = _slug(text)
    count = 1
    while name in taken:
        count += 1
        name = f"{_slug(text)[:90]}-{count}"
    taken.add(name)
    return name


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else " " for c in escaped) + '"'


def _entry(node: Node, key: str, field: str) -> Node:
    if isinstance(node, MapNode) and key in node.entries:
        return node.entries[key]
    raise node.where.error(field, f'no "{key}"; a Timor module database has it')


def _optional(node: Node, key: str) -> Node | None:
    return node.entries.get(key) if isinstance(node, MapNode) else None


def _list(node: Node, field: str, length: int | None = None) -> Sequence[Node]:
    if not isinstance(node, ListNode) or length not in (None, len(node.items)):
        wanted = "a list" if length is None else f"a list of {length}"
        raise node.where.error(field, f"not {wanted}; a Timor module database has one there")
    return node.items


def _text(node: Node, key: str, field: str) -> str:
    entry = _entry(node, key, field)
    if not isinstance(entry, ScalarNode):
        raise entry.where.error(f"{field}.{key}", "not a text; a Timor module database has one")
    return entry.text


def _texts(node: Node) -> list[str]:
    items = node.items if isinstance(node, ListNode) else (node,)
    return [item.text for item in items if isinstance(item, ScalarNode)]


def _number(node: Node, field: str) -> str:
    text = node.text if isinstance(node, ScalarNode) else ""
    if not re.fullmatch(r"[+-]?[0-9]+(\.[0-9]*)?([eE][+-]?[0-9]{1,3})?", text):
        raise node.where.error(field, f'"{text[:60]}" is not a finite number; correct it')
    return text


def _finite(node: Node | None) -> str | None:
    """A number as written; None for none, null and the infinities that stand for no limit."""
    if not isinstance(node, ScalarNode) or node.text.lower().strip('-+"') in (
        "null",
        "inf",
        "infinity",
    ):
        return None
    return _number(node, "limits")


def _numbers(node: Node, length: int, field: str) -> list[str]:
    return [_number(item, field) for item in _list(node, field, length)]


def _pose(node: Node, field: str) -> Array:
    rows = [_numbers(row, 4, field) for row in _list(node, field, 4)]
    matrix = np.array([[float(text) for text in row] for row in rows])
    turned = matrix[:3, :3]
    rigid = np.allclose(turned @ turned.T, np.eye(3), atol=1e-6) and np.linalg.det(turned) > 0.0
    if not rigid or not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        raise node.where.error(field, "not a rigid transform; correct it")
    return matrix
