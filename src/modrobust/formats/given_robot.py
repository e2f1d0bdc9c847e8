"""A robot described in Python: the keys of an assembly file, with its parts in the chain."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from modrobust.formats.assembly import resolved
from modrobust.formats.fields import check
from modrobust.formats.given import given_mapping, given_node
from modrobust.formats.items import Assembly
from modrobust.formats.models import AssemblyModel, ModuleModel
from modrobust.formats.module import ModuleFields, resolved_module
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where

_TEXTS = {
    "tolerance": 'such as "mass=5%,com=5mm" or {"mass": "5%", "com": "5 mm"}',
    "payload": 'such as "mass=[0 kg, 2 kg], com=[0, 0, 50 mm]" or the same as a mapping',
}


def given_assembly(given: Mapping[str, object]) -> Assembly:
    """The assembly that arguments say, checked as a file is; messages name the argument.

    Args:
        given: By key of the assembly file, with ``tolerance`` of a module file. Entries of the
            chain are those of a module file, or names of modules. None = left out.

    Raises:
        ValueRangeError: A value is no number, text, list or mapping.
        DescriptionError: One says something that it must not.
    """
    nodes = {key: _node(value, key) for key, value in given.items() if value is not None}
    chain, tolerance = nodes.pop("chain"), nodes.pop("tolerance", None)
    model = check(AssemblyModel, root := _root(nodes), ModuleFields(root).name)
    own = {"module": nodes["robot"], "name": nodes["robot"], "source": nodes["robot"]}
    own["chain"] = _entries(chain)
    if tolerance is not None:
        own["tolerance"] = tolerance
    parts = resolved_module(check(ModuleModel, root := _root(own), ModuleFields(root).name))
    return resolved(model, Path(), Path(), parts)


def _root(nodes: Mapping[str, Node]) -> MapNode:
    chain = Where("chain", None)  # whose faults are of no entry
    entries = {"modrobust": ScalarNode("1", chain), **nodes}
    return MapNode(entries, chain, {key: node.where for key, node in entries.items()})


def _node(value: object, key: str) -> Node:
    if key in _TEXTS:
        return given_mapping(value, key, _TEXTS[key])
    return given_node(value, key)


def _entries(chain: Node) -> Node:
    """The chain with the bare names of modules as entries of a module file have them."""
    if not isinstance(chain, ListNode):
        return chain
    items = (
        MapNode({"module": item}, item.where) if isinstance(item, ScalarNode) else item
        for item in chain.items
    )
    return ListNode(tuple(items), chain.where)
