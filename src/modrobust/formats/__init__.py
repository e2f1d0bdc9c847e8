"""Module and assembly files: reading, the quantity grammar, validation, resolution to SI."""

from __future__ import annotations

from collections.abc import Sequence

from modrobust.formats.assembly import load_assembly
from modrobust.formats.controller import Controller
from modrobust.formats.items import (
    Assembly,
    BodyItem,
    Connector,
    CsvEntry,
    FrameItem,
    Item,
    JointItem,
    Module,
    NestedItem,
    Payload,
    QuinticEntry,
    SinesEntry,
    TrajectoryEntry,
)
from modrobust.formats.module import ModuleFile, load_module, read_module
from modrobust.formats.naming import instance_names_of
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where
from modrobust.formats.perjoint import PerJoint
from modrobust.formats.quantity import Quantity, parse_quantity
from modrobust.formats.schema import json_schema

__all__ = [
    "Assembly",
    "BodyItem",
    "Connector",
    "Controller",
    "CsvEntry",
    "FrameItem",
    "Item",
    "JointItem",
    "ListNode",
    "MapNode",
    "Module",
    "ModuleFile",
    "NestedItem",
    "Node",
    "Payload",
    "PerJoint",
    "Quantity",
    "QuinticEntry",
    "ScalarNode",
    "SinesEntry",
    "TrajectoryEntry",
    "Where",
    "instance_names",
    "json_schema",
    "load_assembly",
    "load_module",
    "parse_quantity",
    "read_module",
]


def instance_names(items: Sequence[Item]) -> list[str]:
    """Instance names of the nested modules among `items`: `as` or the id, -2, -3 on repeats."""
    return instance_names_of(
        (item.module, item.as_name) for item in items if isinstance(item, NestedItem)
    )
