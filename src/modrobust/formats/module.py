"""Module files: from the tree to a `Module` in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from modrobust.formats.bodies import read_inertia, read_masses
from modrobust.formats.faults import Faults
from modrobust.formats.fields import check
from modrobust.formats.items import (
    BodyItem,
    Connector,
    FrameItem,
    Item,
    Module,
    NestedItem,
)
from modrobust.formats.joint_rows import BehindJoint
from modrobust.formats.joints import read_joint
from modrobust.formats.models import (
    BodyModel,
    ChainEntry,
    ConnectorModel,
    FrameModel,
    JointModel,
    ModuleModel,
    NestedModel,
    SpanModel,
)
from modrobust.formats.naming import instance_names_of
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where, shown
from modrobust.formats.overrides import overridden
from modrobust.formats.quantity import parse_angle, parse_point
from modrobust.formats.reader import parse_description, read_description
from modrobust.formats.span import is_modified, span_matrix
from modrobust.formats.tolerance import Tolerances
from modrobust.kernel import own_environment


@own_environment()
def load_module(path: str | Path, overrides: Mapping[str, Node] | None = None) -> Module:
    """The module of a file, checked and in SI units.

    Args:
        path: The module file.
        overrides: The ``set:`` of the chain entry that mounts it: path inside the module to node.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: The file, or an override, says something that it must not.
    """
    return ModuleFile(path).module(overrides)


def read_module(text: str, name: str) -> Module:
    """The module of a text that is to stand in a file of that name, see `load_module`."""
    return ModuleFile(name, text).module()


class ModuleFile:
    """A module file, read once, for a module that is mounted with and without ``set:``.

    Args:
        path: The module file.
        text: What stands in it; None = it is read.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: The structure of the file is at fault.
    """

    def __init__(self, path: str | Path, text: str | None = None) -> None:
        self._root = read_description(path) if text is None else parse_description(text, str(path))
        check_kind(self._root, "module", "robot", "an assembly file", "a module")
        self._model = check(ModuleModel, self._root, ModuleFields(self._root).name)
        check_stem(self._root.entries["module"], self._model.module, path, "module")

    def module(self, overrides: Mapping[str, Node] | None = None) -> Module:
        """The module in SI units, see `load_module`."""
        if not overrides:
            return resolved_module(self._model)
        root = overridden(self._root, self._model, overrides)
        return resolved_module(check(ModuleModel, root, ModuleFields(root).name))


def check_kind(root: MapNode, own: str, other: str, found: str, wanted: str) -> None:
    """Refuse a file of the other kind before its keys are called unknown."""
    if own not in root.entries and other in root.entries:
        raise root.place(other).error(
            other, f'{found}; {wanted} file has "{own}:"; give the other kind of file'
        )


def check_stem(node: Node, name: str, path: str | Path, key: str) -> None:
    """Refuse a name that is not the file's name without its suffix."""
    stem = Path(path).stem
    if name != stem:
        raise node.where.error(
            key,
            f"{shown(name)} in a file named {shown(Path(path).name)}; the name is the file's name "
            f"without its suffix; write {stem} or rename the file",
        )


class ModuleFields:
    """Names fields of messages: ("chain", 2, "<body>", "mass") is "body elbow, mass"."""

    def __init__(self, root: MapNode) -> None:
        self._root = root

    def name(self, location: tuple[int | str, ...]) -> str:
        """The field of a location in the model."""
        node: Node | None = self._root
        field = ""
        for step in location:
            if isinstance(step, str) and step.startswith("<"):
                field = entry_field(node, step[1:-1], field)
                continue
            if isinstance(step, int):
                field += f"[{step}]"
                node = node.items[step] if isinstance(node, ListNode) else None
            else:
                field += step if not field or field.endswith(", ") else f".{step}"
                node = node.entries.get(step) if isinstance(node, MapNode) else None
        return field.removesuffix(", ")


def entry_field(node: Node | None, kind: str, field: str) -> str:
    """``body elbow, `` for a chain entry whose name can be read, else the field as it is."""
    name = node.entries.get(kind) if isinstance(node, MapNode) else None
    if isinstance(name, ScalarNode) and kind != "module" and name.text:
        return f"{kind} {name.text[:80]}, "
    return field


def resolved_module(model: ModuleModel) -> Module:
    """The module of a model whose structure is checked, see `load_module`."""
    tolerances = Tolerances(model.tolerance)
    notes = list(model.notes or ())
    items: list[Item] = []
    behind = BehindJoint()
    names: dict[str, Where] = {}
    faults = Faults()
    for index, entry in enumerate(model.chain):
        with faults.caught():
            item = _item(entry, f"chain[{index}]", tolerances, notes)
            if not isinstance(item, NestedItem):
                _check_name(item.name, item.where, names)
            behind.check(item)
            items.append(item)
    faults.stop()
    nested = [item for item in items if isinstance(item, NestedItem)]
    mounted = [(item.module, item.as_name) for item in nested]
    for name, item in zip(instance_names_of(mounted), nested, strict=True):
        _check_name(name, item.where, names)
    if not items:
        raise model.node.entries["chain"].where.error(
            "chain", "an empty list; a module has at least one entry; add a body or a joint"
        )
    ends = model.connectors
    return Module(
        id=model.module,
        name=model.name,
        source=model.source,
        licence=model.licence,
        product=model.product is not False,
        connector_in=_connector(ends.in_ if ends else None, "connectors.in"),
        connector_out=_connector(ends.out if ends else None, "connectors.out"),
        items=tuple(items),
        unused_tolerances=tolerances.unused,
        notes=(*notes, *tolerances.remarks),
        where=model.where,
    )


def _check_name(name: str, where: Where, names: dict[str, Where]) -> None:
    if name in names:
        raise where.error(
            name,
            f"a second entry of this name (first on line {names[name].line}); names within "
            "a module differ; rename one",
        )
    names[name] = where


def _item(entry: ChainEntry, field: str, tolerances: Tolerances, notes: list[str]) -> Item:
    if isinstance(entry, JointModel):
        return read_joint(entry, f"joint {entry.joint}, ", tolerances)
    if isinstance(entry, FrameModel):
        span = span_matrix(entry.span, f"frame {entry.frame}, span")
        return FrameItem(entry.frame, span, entry.where, _modified(entry.span))
    if isinstance(entry, NestedModel):
        return nested_item(entry, field)
    return _body(entry, tolerances, notes)


def _body(entry: BodyModel, tolerances: Tolerances, notes: list[str]) -> BodyItem:
    prefix = f"body {entry.body}, "
    masses = read_masses(
        entry.mass, entry.com, prefix, tolerances, entry.inertia.physical is not None
    )
    inertia, physical = read_inertia(entry.inertia, masses, prefix, tolerances)
    if not physical:
        notes.append(
            f"body {entry.body}: the bounds of its inertia also hold tensors that no rigid body has"
        )
    return BodyItem(
        name=entry.body,
        span=span_matrix(entry.span, f"{prefix}span"),
        at_end=entry.expressed_in == "end",
        mass=masses.bounded_mass,
        com=masses.bounded_com,
        inertia=inertia,
        inertia_about=entry.inertia.about or "com",
        where=entry.where,
        modified=_modified(entry.span),
    )


def _modified(span: SpanModel | None) -> Where | None:
    return span.where if span is not None and is_modified(span) else None


def nested_item(entry: NestedModel, field: str) -> NestedItem:
    """A mounted module; its `set:` stays nodes until the module is read."""
    return NestedItem(
        module=entry.module,
        as_name=entry.as_,
        mount=Fraction(0) if entry.mount is None else parse_angle(entry.mount, f"{field}.mount"),
        overrides=dict(entry.set or {}),
        where=entry.where,
    )


def _connector(model: ConnectorModel | None, field: str) -> Connector | None:
    if model is None:
        return None
    clocking = None
    if model.clocking is not None:
        clocking = parse_point(model.clocking, "angle", f"{field}.clocking")
        if clocking <= 0:
            raise model.clocking.where.error(
                f"{field}.clocking",
                f"{clocking:g} rad is not positive; clocking is the step of the allowed mounts; "
                "write e.g. 90 deg",
            )
    return Connector(model.type, model.size, model.gender or "n", clocking, model.where)
