"""Descriptions given as Python mappings, lists and numbers, as the nodes that files give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from reprlib import repr as short

import numpy as np

from modrobust.errors import ValueRangeError
from modrobust.formats.inline import parse_inline
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where

_MAX_DEPTH = 8


def given_mapping(value: object, name: str, example: str) -> MapNode:
    """The mapping that an argument says: a text as on the command line, or a mapping.

    Args:
        value: Such as ``"mass=5%,com=5mm"``, or ``{"mass": "5%", "com": "5 mm"}`` with texts,
            numbers, lists and mappings as values; numbers are in SI units.
        name: What messages call the argument.
        example: What to write, for messages.

    Raises:
        ValueRangeError: It is neither, or something in it is none of these.
    """
    if isinstance(value, str):
        return parse_inline(value, name)
    if not isinstance(value, Mapping):
        raise ValueRangeError(f"{name}: {short(value)}; must be a text or a mapping; {example}")
    if not value:
        raise ValueRangeError(f"{name}: an empty mapping; {example}")
    node = given_node(value, name)
    assert isinstance(node, MapNode)
    return node


def given_node(value: object, name: str) -> Node:
    """The node that a number, a text, true or false, a list or a mapping says; numbers are in SI.

    Raises:
        ValueRangeError: Something in it is none of these; `name` and the path in it say where.
    """
    return _node(value, name, Where(name, None), 0)


def _node(value: object, name: str, where: Where, depth: int) -> Node:
    if depth > _MAX_DEPTH:
        raise ValueRangeError(f"{name}: more than {_MAX_DEPTH} levels deep; write fewer")
    if isinstance(value, str):
        return ScalarNode(value, where)
    if isinstance(value, Mapping):
        entries = {}
        for key, entry in value.items():
            if not isinstance(key, str):
                raise ValueRangeError(f"{name}: key {short(key)}; keys are texts; quote it")
            entries[key] = _node(entry, f"{name}.{key}", where, depth + 1)
        return MapNode(entries, where)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, bool | np.bool_):
        return ScalarNode("true" if value else "false", where)
    if isinstance(value, Real):
        return ScalarNode(repr(float(value)), where)
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        items = (_node(item, f"{name}[{k}]", where, depth + 1) for k, item in enumerate(value))
        return ListNode(tuple(items), where)
    raise ValueRangeError(
        f'{name}: {short(value)}; must be a number, a text such as "5 mm", a list or a mapping'
    )
