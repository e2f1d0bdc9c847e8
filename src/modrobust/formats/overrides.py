"""``set:`` of a chain entry: values that replace those of a module before it is validated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from modrobust.checks import unknown_name
from modrobust.formats.models import (
    BodyModel,
    ChainEntry,
    FrameModel,
    JointModel,
    ModuleModel,
    NestedModel,
)
from modrobust.formats.naming import instance_names_of
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, kind_of, shown

_SETTABLE: dict[type, tuple[str, ...]] = {
    JointModel: ("limits", "drive", "friction", "dh"),
    BodyModel: ("mass", "com", "inertia", "span", "expressed_in"),
    FrameModel: ("span",),
}


def overridden(root: MapNode, module: ModuleModel, overrides: Mapping[str, Node]) -> MapNode:
    """The module's tree with `overrides` put in; each keeps the place where it was written.

    Args:
        root: Tree of the module file.
        module: The same, structurally checked.
        overrides: Path inside the module ("body.mass", "joint.friction.viscous",
            "instance.body.mass") to value; "body" to `none` takes the body off.

    Raises:
        DescriptionError: A path that leads nowhere.
    """
    names = _entry_names(module.chain)
    chain = root.entries["chain"]
    entries = list(chain.items) if isinstance(chain, ListNode) else []
    for path, node in overrides.items():
        name, _, rest = path.partition(".")
        if name not in names:
            raise node.where.error(
                f"set.{path}",
                unknown_name(f'no part {shown(name)} in module "{module.module}"', name, names),
            )
        index = names[name]
        model = module.chain[index]
        entry = entries[index]
        if isinstance(model, BodyModel) and isinstance(node, ScalarNode) and path == name:
            entries[index] = _without_mass(entry, name, node)
            continue
        if not rest:
            field = _SETTABLE.get(type(model), ("body.mass",))[0]
            raise node.where.error(
                f"set.{path}",
                f'{shown(name)} is a part of module "{module.module}"; a path names a field of a '
                f"part; write one such as {name}.{field}",
            )
        if isinstance(model, NestedModel):
            steps = ["set", rest]
        else:
            steps = rest.split(".")
            _check_head(steps[0], model, path, node)
        entries[index] = _put(entry, steps, node, path)
    tree = ListNode(tuple(entries), chain.where)
    return replace(root, entries={**root.entries, "chain": tree})


def _without_mass(entry: Node, name: str, node: ScalarNode) -> MapNode:
    """The body taken off, its span kept: what ``body: none`` asks for."""
    if node.text != "none":
        raise node.where.error(
            f"set.{name}",
            f"{shown(node.text)} for a whole body; a body is set by its fields or taken off; "
            f"write {name}.mass, or {name}: none",
        )
    kept: dict[str, Node] = {"frame": ScalarNode(name, node.where)}
    places = {"frame": node.where}
    if isinstance(entry, MapNode) and "span" in entry.entries:
        kept["span"], places["span"] = entry.entries["span"], entry.key_where["span"]
    return MapNode(kept, node.where, places)


def _entry_names(chain: Sequence[ChainEntry]) -> dict[str, int]:
    """Index of each chain entry by the name that a path starts with."""
    instances = iter(
        instance_names_of([(e.module, e.as_) for e in chain if isinstance(e, NestedModel)])
    )
    names = {}
    for index, entry in enumerate(chain):
        if isinstance(entry, JointModel):
            names[entry.joint] = index
        elif isinstance(entry, BodyModel):
            names[entry.body] = index
        elif isinstance(entry, FrameModel):
            names[entry.frame] = index
        else:
            names[next(instances)] = index
    return names


def _check_head(head: str, model: ChainEntry, path: str, node: Node) -> None:
    settable = _SETTABLE[type(model)]
    if head not in settable:
        raise node.where.error(
            f"set.{path}",
            unknown_name(f"{shown(head)} cannot be set", head, settable),
        )


def _put(node: Node, steps: Sequence[str], value: Node, path: str) -> Node:
    """`node` with `value` at the end of `steps`; mappings on the way are made where absent."""
    if not steps:
        return value
    if not isinstance(node, MapNode):
        raise value.where.error(
            f"set.{path}",
            f'{kind_of(node)} has no "{steps[0]}"; a path names keys of mappings; shorten it',
        )
    below = node.entries.get(steps[0], MapNode({}, value.where))
    entries = {**node.entries, steps[0]: _put(below, steps[1:], value, path)}
    places = {**node.key_where, steps[0]: node.key_where.get(steps[0], value.where)}
    return replace(node, entries=entries, key_where=places)
