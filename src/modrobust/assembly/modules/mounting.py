"""From a chain of modules to one flat list of steps: names, connectors, nesting.

Each step starts where the last one ended. A compound module brings the steps of the modules inside
it; a mounting angle is a step of its own, Rz(mount) at the connector.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from modrobust.assembly.modules.catalogue import Library
from modrobust.assembly.modules.connectors import RULE, clocking_problem, describe, incompatibility
from modrobust.formats import (
    Assembly,
    BodyItem,
    FrameItem,
    Item,
    JointItem,
    Module,
    ModuleFile,
    NestedItem,
    instance_names,
)
from modrobust.formats.faults import Faults
from modrobust.formats.joint_rows import BehindJoint
from modrobust.model import ModuleNode
from modrobust.model.geometry import IDENTITY, Transform, rotation_z

_MOST_INSTANCES = 10_000  # compound modules multiply; this ends such a bomb early


@dataclass(frozen=True)
class JointStep:
    """A joint; `name` is "instance.joint"."""

    name: str
    item: JointItem


@dataclass(frozen=True)
class BodyStep:
    """A body and its span; `name` is "instance.body"."""

    name: str
    item: BodyItem


@dataclass(frozen=True)
class SpanStep:
    """A rigid transform without mass."""

    span: Transform


@dataclass(frozen=True)
class EndStep:
    """The end frame of an instance, where a payload can be."""

    instance: str


Step = JointStep | BodyStep | SpanStep | EndStep


@dataclass(frozen=True)
class Mounted:
    """A mounted chain: its steps, its modules as a tree, and remarks of the modules."""

    steps: tuple[Step, ...]
    nodes: tuple[ModuleNode, ...]
    notes: tuple[str, ...]


def mount_chain(assembly: Assembly) -> Mounted:
    """The steps of an assembly's chain, from the base frame to the tip.

    Raises:
        DescriptionError: A module is unknown, contains itself, or does not mount where it is put;
            two instances have one name.
    """
    mounter = _Mounter(Library(assembly.modules))
    faults = Faults()
    none: tuple[ModuleNode, ...] = ()
    nodes = faults.attempt(lambda: mounter.chain(assembly.chain, prefix="", inside=()), none)
    if faults.found:  # then those of the other modules too
        for index, item in enumerate(assembly.chain):
            with faults.caught():
                if isinstance(item, NestedItem):
                    mounter.load(item, f"chain[{index}]", ())
    faults.stop()
    return Mounted(tuple(mounter.steps), nodes, tuple(mounter.remarks()))


class _Mounter:
    def __init__(self, library: Library) -> None:
        self.steps: list[Step] = []
        self._library = library
        self._instances: dict[str, list[str]] = {}  # by module id
        self._remarks: dict[tuple[str, str], list[str]] = {}  # (module id, text): instances
        self._files: dict[Path, ModuleFile] = {}
        self._loaded: dict[Path, Module] = {}  # as their files say them
        self._behind = BehindJoint()  # from one module to the next, too
        self._count = 0

    def remarks(self) -> list[str]:
        """What the modules remark, once each: under the module's id when all instances say it."""
        return [
            f"{module if said_by == self._instances[module] else ', '.join(said_by)}: {text}"
            for (module, text), said_by in self._remarks.items()
        ]

    def chain(
        self, items: Sequence[Item], prefix: str, inside: tuple[str, ...]
    ) -> tuple[ModuleNode, ...]:
        """Appends the steps of a chain; returns the nodes of the modules mounted in it."""
        names = iter(_unique_names(items))
        nodes: list[ModuleNode] = []
        below: Module | None = None  # the module that the next one is mounted on directly
        for index, item in enumerate(items):
            if not isinstance(item, NestedItem):
                self._own(item, prefix)
                below = None
                continue
            field = f"chain[{index}]"
            module = self.load(item, field, inside)
            if below is not None:
                _check_connectors(below, module, item, field)
            nodes.append(self._mount(module, item, f"{prefix}{next(names)}", inside))
            below = module
        return tuple(nodes)

    def _own(self, item: JointItem | BodyItem | FrameItem, prefix: str) -> None:
        self._behind.check(item)
        if isinstance(item, JointItem):
            if item.ahead != IDENTITY:
                self.steps.append(SpanStep(item.ahead))
            self.steps.append(JointStep(f"{prefix}{item.name}", item))
            if item.behind != IDENTITY:
                self.steps.append(SpanStep(item.behind))
        elif isinstance(item, BodyItem):
            self.steps.append(BodyStep(f"{prefix}{item.name}", item))
        else:
            self.steps.append(SpanStep(item.span))

    def load(self, item: NestedItem, field: str, inside: tuple[str, ...]) -> Module:
        """The module that an entry of a chain mounts."""
        if item.module in inside:
            cycle = [*inside[inside.index(item.module) :], item.module]
            raise item.where.error(
                field,
                f"module cycle {' -> '.join(cycle)}; a module cannot contain itself; "
                "remove this entry",
            )
        self._count += 1
        if self._count > _MOST_INSTANCES:
            raise item.where.error(
                field,
                f"more than {_MOST_INSTANCES} modules in all; a robot has fewer; "
                "nest fewer compound modules",
            )
        path = self._library.path(item.module, item.where, field)
        if path not in self._files:  # reading is most of the time of assembling
            self._files[path] = ModuleFile(path)
        if item.overrides:
            return self._files[path].module(item.overrides)
        if path not in self._loaded:
            self._loaded[path] = self._files[path].module()
        return self._loaded[path]

    def _mount(
        self, module: Module, item: NestedItem, instance: str, inside: tuple[str, ...]
    ) -> ModuleNode:
        if item.mount:
            self.steps.append(SpanStep(rotation_z(item.mount)))
            self._behind.passed()
        self._remark(module, instance)
        children = self.chain(module.items, f"{instance}.", (*inside, module.id))
        self.steps.append(EndStep(instance))
        return ModuleNode(
            instance=instance,
            module=module.id,
            name=module.name,
            joints=_names(module, JointItem, instance),
            bodies=_names(module, BodyItem, instance),
            children=children,
        )

    def _remark(self, module: Module, instance: str) -> None:
        self._instances.setdefault(module.id, []).append(instance)
        for text in module.remarks:
            self._remarks.setdefault((module.id, text), []).append(instance)


def _names(
    module: Module, kind: type[JointItem] | type[BodyItem], instance: str
) -> tuple[str, ...]:
    return tuple(f"{instance}.{item.name}" for item in module.items if isinstance(item, kind))


def _unique_names(items: Sequence[Item]) -> list[str]:
    """Instance names of the nested modules, in order; a name given by ``as`` twice is refused."""
    names = instance_names(items)
    nested = [(index, item) for index, item in enumerate(items) if isinstance(item, NestedItem)]
    for name, (index, item) in zip(names, nested, strict=True):
        # Numbering repeats is for modules that were not named; a name that was given is meant.
        if item.as_name is not None and name != item.as_name:
            _, first = nested[names.index(item.as_name)]
            raise item.where.error(
                f"chain[{index}]",
                f'the instance name "{item.as_name}" is taken (line {first.where.line}); '
                'names in a chain differ; give this one another with "as:"',
            )
    return names


def _check_connectors(below: Module, above: Module, item: NestedItem, field: str) -> None:
    """Refuses a module on one that it does not fit, with both connectors in words."""
    out, into = below.connector_out, above.connector_in
    if out is None or into is None:
        lacking, side = (below, "out") if out is None else (above, "in")
        raise item.where.error(
            field,
            f'"{above.id}" cannot be mounted on "{below.id}": "{lacking.id}" has no {side} '
            f'connector; {RULE}; see "modrobust modules" for what fits',
        )
    problem = incompatibility(out, into)
    if problem:
        raise item.where.error(
            field,
            f'"{above.id}" (in: {describe(into)}) does not mount on '
            f'"{below.id}" (out: {describe(out)}): {problem}; {RULE}; '
            'see "modrobust modules" for what fits',
        )
    problem = clocking_problem(out, into, float(item.mount))
    if problem:
        raise item.where.error(
            f"{field}.mount",
            f'"{above.id}" (in: {describe(into)}) on "{below.id}" (out: {describe(out)}): '
            f"{problem}; give one of its multiples",
        )
