r"""Import of the module database of Timor (``modules.json``) as module files of this project.

A Timor module is a set of bodies with connectors, and joints between bodies. Connector frames point
away from their body and meet face to face, rotated by Rx(pi); ours point to the tip throughout, so
that with P the pose of a connector in its body

.. math:: in = P\, R_x(\pi), \qquad out = P .

A body's tensor is about its COM in one reading of the public databases and about its frame in the
other; which one holds is decided by what a rigid body can have (`inertia_reading`).

Source: [KM23].
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

from modrobust.checks import replacing
from modrobust.checks.files import kind_of_path, reason
from modrobust.checks.types import Array
from modrobust.errors import DescriptionError, FileError, ValueRangeError
from modrobust.formats import Node, read_module
from modrobust.formats.inertia import positive_definite, steiner
from modrobust.formats.json_reader import parse_json
from modrobust.kernel import own_environment
from modrobust.model.geometry import Transform, arctan2, rotation_x
from modrobust.model.symmetric import ENTRIES, eigenvalues
from modrobust.timor.database import (
    TimorBody,
    TimorConnector,
    member,
    members,
    optional_member,
    read_bodies,
    read_database,
    text_of,
    texts_of,
)
from modrobust.timor.joint import TimorJoint, joint_lines, read_joints

READINGS = ("com", "frame")
_DIGITS = 12  # decimals of a length [m] that a description keeps: 1e-12 m
_RIGHT = 1e-9  # [rad]; nearer to a multiple of 90 degrees is meant as one
_TRIANGLE = 1e-9  # relative, as for module files


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


@own_environment()
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
    root = parse_json(read_database(path), os.fspath(path))
    modules = members(member(root, "modules", ""), "modules")
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
            'inertia_about "com" or "frame" overrides it for all'
        )
    return Import(tuple(done.values()), tuple(left_out), tuple(notes))


@own_environment()
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
            if kind_of_path(path) != "missing":
                raise FileError(path, "exists; an import overwrites nothing; give an empty folder")
        for path, module in zip(paths, result.modules, strict=True):
            with replacing(path, ".yaml", "a module") as part:
                part.write_text(module.text, encoding="utf-8")
    except OSError as error:
        raise FileError(
            folder, f"cannot be written: {reason(error)}; give a folder that can be"
        ) from None
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
    moments = eigenvalues(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    return bool(moments[2] - moments[1] - moments[0] <= _TRIANGLE * moments[2])


def _majority(modules: Sequence[Node]) -> str:
    """The reading that more bodies of the file need, "com" (Timor's own) when as many."""
    votes = dict.fromkeys(READINGS, 0)
    for index, node in enumerate(modules):
        try:
            bodies = read_bodies(node, f"modules[{index}]")
        except DescriptionError:
            continue
        for body in bodies.values():
            if body.mass > 0:
                readings = inertia_reading(body.mass, body.com, body.tensor)
                if len(readings) == 1:
                    votes[readings[0]] += 1
    return "frame" if votes["frame"] > votes["com"] else "com"


def _module(
    node: Node, name: str, inertia_about: str | None, default: str, source: str
) -> Imported:
    header = member(node, "header", name)
    identity = _slug(text_of(header, "ID", name))
    bodies = read_bodies(node, name)
    joints = read_joints(node, name, bodies)
    start, end = _ends(bodies, node, name)
    path = _path(start[0], end[0], bodies, joints, node, name)
    notes: list[str] = []
    chain = _chain(path, start, end, inertia_about, default, notes)
    ends = [("in", start[1]), ("out", end[1])]
    author = optional_member(header, "author")
    authors = ", ".join(texts_of(author)) if author is not None else "unknown author"
    lines = [
        "# Imported from a Timor module database; no bounds are known: every figure is exact.",
        "modrobust: 1",
        f"module: {identity}",
        f"name: {_quoted(text_of(header, 'name', name))}",
        f"source: {_quoted(f'Timor {source}, ID ' + text_of(header, 'ID', name) + ', ' + authors)}",
    ]
    if notes:
        lines += ["notes:", *(f"  - {_quoted(note)}" for note in notes)]
    lines += ["connectors:", *(line for key, c in ends for line in _connector(key, c))]
    lines += ["chain:", *chain]
    text = "\n".join(lines) + "\n"
    try:
        read_module(text, f"{identity}.yaml")
    except DescriptionError as problem:
        raise node.where.error(
            name, f"no module of ours: {problem.field}: {problem.message}"
        ) from None
    return Imported(identity, text, tuple(notes))


Ends = tuple[str, TimorConnector]


def _ends(bodies: dict[str, TimorBody], node: Node, name: str) -> tuple[Ends, Ends]:
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
    bodies: dict[str, TimorBody],
    joints: list[TimorJoint],
    node: Node,
    name: str,
) -> list[tuple[TimorBody, TimorJoint | None]]:
    """Bodies from in to out, each with the joint that follows it."""
    by_parent = {joint.parent: joint for joint in joints}
    path: list[tuple[TimorBody, TimorJoint | None]] = []
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
    path: list[tuple[TimorBody, TimorJoint | None]],
    start: Ends,
    end: Ends,
    inertia_about: str | None,
    default: str,
    notes: list[str],
) -> list[str]:
    lines: list[str] = []
    frame = (start[1].pose @ rotation_x(math.pi)).inverse()
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
        lines += joint_lines(joint, _unique(joint.id, names), notes)
        frame = joint.to_child
    return lines or ["  - frame: span"]


def _body_lines(
    body: TimorBody,
    name: str,
    ahead: Transform,
    inertia_about: str | None,
    default: str,
    notes: list[str],
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
            f'import it with inertia_about "{readings[0]}"',
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
        for key, text in zip(ENTRIES, six, strict=True)
        if Fraction(text) or key in ("xx", "yy", "zz")
    )
    return [
        f"  - body: {name}",
        *_span(ahead),
        f"    mass: {mass} kg",
        f"    com: [{', '.join(com)}]",
        f"    inertia: {{about: {about}, {entries}}}",
    ]


def _connector(key: str, connector: TimorConnector) -> list[str]:
    size = f", size: {connector.size}" if connector.size else ""
    kind = _quoted(connector.type or "timor")
    return [f"  {key}: {{type: {kind}{size}, gender: {connector.gender}}}"]


def _span(transform: Transform) -> list[str]:
    """``span:`` of a transform, nothing for the identity."""
    pose = transform.rounded()
    xyz = [round(float(value), _DIGITS) + 0.0 for value in pose[:3, 3]]
    rpy = [_angle(value) for value in rpy_of(pose[:3, :3])]
    parts = []
    if any(xyz):
        parts.append(f"xyz: [{', '.join(f'{value:.12g}' for value in xyz)}]")
    if any(text != "0" for text in rpy):
        parts.append(f"rpy: [{', '.join(rpy)}]")
    return [f"    span: {{{', '.join(parts)}}}"] if parts else []


def rpy_of(rotation: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a rotation (3, 3) = Rz(yaw) Ry(pitch) Rx(roll)."""
    flat = math.hypot(rotation[0, 0], rotation[1, 0])
    pitch = arctan2(-rotation[2, 0], flat)
    if flat > 1e-9:
        roll = arctan2(rotation[2, 1], rotation[2, 2])
        return roll, pitch, arctan2(rotation[1, 0], rotation[0, 0])
    # Pitch of +-90 degrees: only roll -+ yaw is determined; yaw is taken as 0.
    return arctan2(math.copysign(1.0, pitch) * rotation[0, 1], rotation[1, 1]), pitch, 0.0


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
