"""Assembly files: from the tree to an `Assembly` in SI units, without its modules."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from modrobust.formats.controller import Controller, read_controller
from modrobust.formats.exact import nearest
from modrobust.formats.faults import Faults
from modrobust.formats.fields import check
from modrobust.formats.items import (
    Assembly,
    CsvEntry,
    Module,
    NestedItem,
    Payload,
    QuinticEntry,
    SinesEntry,
    TrajectoryEntry,
)
from modrobust.formats.loop import Loop, read_loop
from modrobust.formats.models import (
    AssemblyModel,
    NestedModel,
    QuinticModel,
    SinesModel,
    TrajectoryModel,
)
from modrobust.formats.module import ModuleFields, check_kind, check_stem, nested_item
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where, kind_of, shown
from modrobust.formats.overlay import UrdfSource
from modrobust.formats.payloads import read_payload, read_payloads
from modrobust.formats.perjoint import PerJoint
from modrobust.formats.quantity import (
    Quantity,
    parse_not_negative,
    parse_point,
    parse_positive,
)
from modrobust.formats.reader import read_description
from modrobust.formats.span import points, pose_matrix
from modrobust.kernel import own_environment
from modrobust.model.geometry import IDENTITY

GRAVITY = (0.0, 0.0, -9.81)  # [m/s^2]
_URDF_KEYS = (
    "base_link", "tip_link", "lock", "links", "joints", "tolerance", "xacro", "packages"
)  # fmt: skip
_XACRO_NAME = re.compile(r"[A-Za-z]\w*", re.ASCII)
_ZERO = Quantity(0.0, 0.0, 0.0, bounded=False)


@own_environment()
def load_assembly(path: str | Path) -> Assembly:
    """The assembly of a file, checked and in SI units as far as that goes without its modules.

    Args:
        path: The assembly file.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: The file says something that it must not.
    """
    root = read_description(path)
    check_kind(root, "robot", "module", "a module file", "an assembly")
    model = check(AssemblyModel, root, ModuleFields(root).name)
    check_stem(root.entries["robot"], model.robot, path, "robot")
    return resolved(model, Path(path), Path(path).parent)


def resolved(
    model: AssemblyModel,
    file: Path,
    directory: Path,
    parts: Module | None = None,
) -> Assembly:
    """The assembly of a model whose structure is checked.

    Args:
        model: What is written.
        file: Where it is written.
        directory: What the paths in it are relative to.
        parts: The chain, where it is not of modules alone and therefore not in the model.

    Raises:
        DescriptionError: A value is at fault.
    """
    notes = [*(model.notes or ()), *(parts.remarks if parts else ())]
    base = model.base
    scenarios = model.scenarios or {}
    faults = Faults()
    attempt = faults.attempt
    initial = (model.initial.q, model.initial.dq) if model.initial else (None, None)
    none: tuple[Payload | None, Mapping[str, Payload]] = (None, {})
    payload, payloads = attempt(lambda: _payloads(model, notes), none)
    assembly = Assembly(
        name=model.robot,
        file=file,
        modules=attempt(lambda: _directories(model, directory), ()),
        base=attempt(
            lambda: pose_matrix(base.xyz if base else None, base.rpy if base else None, "base"),
            IDENTITY,
        ),
        gravity=attempt(
            lambda: GRAVITY if model.gravity is None else read_gravity(model.gravity), GRAVITY
        ),
        chain=attempt(lambda: _chain(model), ()) if parts is None else parts.items,
        payload=payload,
        payloads=payloads,
        disturbance=attempt(
            lambda: _per_joint(model.disturbance, "disturbance", "effort", bounds=True), None
        ),
        controller=attempt(lambda: read_controller(model.controller), Controller()),
        trajectory=attempt(lambda: _trajectory(model.trajectory, directory), None),
        initial_q=attempt(lambda: _per_joint(initial[0], "initial.q", "position"), None),
        initial_dq=attempt(lambda: _per_joint(initial[1], "initial.dq", "velocity"), None),
        scenarios={name: dict(scenario.set) for name, scenario in scenarios.items()},
        where=model.where,
        loop=attempt(lambda: read_loop(model.loop), Loop()),
        urdf=attempt(lambda: _urdf(model, directory), None) if parts is None else None,
        source=model.source or (),
        notes=tuple(notes),
        scenario_notes={
            name: " ".join(scenario.notes) for name, scenario in scenarios.items() if scenario.notes
        },
    )
    faults.stop()
    return assembly


def read_gravity(node: Node) -> tuple[float, float, float]:
    """A vector in world axes [m/s^2]."""
    x, y, z = (nearest(entry) for entry in points(node, "acceleration", "gravity"))
    return x, y, z


def _directories(model: AssemblyModel, directory: Path) -> tuple[Path, ...]:
    found = tuple(directory / text for text in model.modules or ())
    node = model.node.entries.get("modules")
    for index, folder in enumerate(found):
        if not os.path.isdir(folder):  # Path.is_dir raises where a name is too long
            place = node.items[index] if isinstance(node, ListNode) else node
            where = model.where if place is None else place.where
            raise where.error(
                "modules",
                f'no directory "{folder}"; directories are relative to this file; make it or '
                "name another",
            )
    return found


def _urdf(model: AssemblyModel, directory: Path) -> UrdfSource | None:
    """The URDF and its overlays; exactly one of chain and urdf is written."""
    node = model.node
    if model.urdf is None:
        for key in _URDF_KEYS:
            if key in node.entries:
                raise node.place(key).error(
                    key, "without urdf; it belongs to a robot that a URDF describes; remove it"
                )
        if model.chain is None:
            raise model.where.error(
                "", 'neither "chain" nor "urdf"; a robot is one of them; add chain'
            )
        return None
    for key in ("chain", "modules"):
        if key in node.entries:
            raise node.place(key).error(
                key, "beside urdf; a robot is of modules or of a URDF; remove one"
            )
    ends = (node.entries.get(key) for key in ("base_link", "tip_link"))
    base_link, tip_link = (end if isinstance(end, ScalarNode) else None for end in ends)
    return UrdfSource(
        file=model.urdf,
        where=node.entries["urdf"].where,
        directory=directory,
        base_link=base_link,
        tip_link=tip_link,
        lock=dict(model.lock or {}),
        links=dict(model.links or {}),
        joints=dict(model.joints or {}),
        tolerance=model.tolerance,
        xacro=xacro_arguments(model.xacro or {}),
        packages=package_folders(model.packages or {}, directory, node.place("packages")),
    )


def xacro_arguments(given: Mapping[str, Node]) -> dict[str, str]:
    """Arguments of a xacro file, as they are handed to it.

    Raises:
        DescriptionError: A name or a value that xacro would pass over.
    """
    arguments = {}
    for name, node in given.items():
        field = f"xacro.{name[:80]}"
        if not _XACRO_NAME.fullmatch(name):
            raise node.where.error(
                field,
                "not a name; names of xacro arguments are letters, digits and _, and begin with a "
                "letter; rename it",
            )
        if not isinstance(node, ScalarNode):
            raise node.where.error(field, f"{kind_of(node)}; an argument is a text; write one")
        if ":=" in node.text:
            raise node.where.error(
                field, f'{shown(node.text)} holds ":=", which xacro cannot read; leave it out'
            )
        arguments[name] = node.text
    return arguments


def package_folders(given: Mapping[str, str], directory: Path, where: Where) -> dict[str, Path]:
    """Folders of packages.

    Raises:
        DescriptionError: There is no such folder.
    """
    folders = {name: directory / path for name, path in given.items()}
    for name, folder in folders.items():
        if not os.path.isdir(folder):  # Path.is_dir raises where a name is too long
            raise where.error(
                f"packages.{name[:80]}", f'no directory "{folder}"; give the folder of the package'
            )
    return folders


def _chain(model: AssemblyModel) -> tuple[NestedItem, ...]:
    if model.chain is None:
        return ()
    node = model.node.entries["chain"]
    if not model.chain or not isinstance(node, ListNode):
        raise node.where.error("chain", "an empty list; a robot has at least one module; add one")
    return tuple(
        nested_item(entry, f"chain[{index}]")
        if isinstance(entry, NestedModel)
        else NestedItem(entry, None, Fraction(0), {}, node.items[index].where)
        for index, entry in enumerate(model.chain)
    )


def _payloads(
    model: AssemblyModel, notes: list[str]
) -> tuple[Payload | None, Mapping[str, Payload]]:
    """The payload, and those that it is the box of where several are written."""
    if model.payloads is None:
        return None if model.payload is None else read_payload(model.payload, notes), {}
    node = model.node.entries["payloads"]
    if model.payload is not None:
        raise model.node.place("payloads").error(
            "payloads", "beside payload; a robot has one or several; remove one of the two"
        )
    assert isinstance(node, MapNode)
    return read_payloads(model.payloads, node, notes)


def _per_joint(
    node: Node | None, field: str, kind: str, *, bounds: bool = False
) -> PerJoint | None:
    return None if node is None else PerJoint(node, field, kind, bounds)


def _trajectory(model: TrajectoryModel | None, directory: Path) -> TrajectoryEntry | None:
    if model is None:
        return None
    duration = parse_positive(model.duration, "time", "trajectory.duration")
    if isinstance(model, SinesModel):
        if not model.omega:
            raise model.node.entries["omega"].where.error(
                "trajectory.omega", "an empty list; sines need a frequency; add one"
            )
        omega = tuple(
            parse_point(node, "angular speed", f"trajectory.omega[{i}]")
            for i, node in enumerate(model.omega)
        )
        return SinesEntry(
            PerJoint(model.amplitude, "trajectory.amplitude", "position"), omega, duration
        )
    if isinstance(model, QuinticModel):
        return QuinticEntry(_waypoints(model), duration)
    return CsvEntry(directory / model.file, duration)


def _waypoints(model: QuinticModel) -> tuple[tuple[float, PerJoint], ...]:
    if model.points is None:
        return ()
    if len(model.points) < 2:
        raise model.node.entries["points"].where.error(
            "trajectory.points",
            f"{len(model.points)} point; a motion has at least two; add one",
        )
    waypoints = []
    last = None
    for index, point in enumerate(model.points):
        field = f"trajectory.points[{index}]"
        at = parse_not_negative(point.at, "time", f"{field}.at")
        if at is None or (last is not None and at <= last):
            raise point.at.where.error(
                f"{field}.at", f"{at:g} s after {last:g} s; times increase; order the points"
            )
        last = at
        waypoints.append((at, PerJoint(point.q, f"{field}.q", "position")))
    return tuple(waypoints)
