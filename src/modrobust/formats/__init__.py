"""Module and assembly files: reading, the quantity grammar, validation, resolution to SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from modrobust.formats.items import (
    Assembly,
    BodyItem,
    Connector,
    Controller,
    Csv,
    FrameItem,
    Item,
    JointItem,
    Module,
    NestedItem,
    Payload,
    Quintic,
    Sines,
    Trajectory,
)
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where
from modrobust.formats.perjoint import PerJoint
from modrobust.formats.quantity import Quantity, parse_quantity


def load_module(path: str | Path, overrides: Mapping[str, Node] | None = None) -> Module:
    """The module of a file; `overrides` are the `set:` of the chain entry that mounts it."""
    raise NotImplementedError


def load_assembly(path: str | Path) -> Assembly:
    """The assembly of a file, without loading its modules."""
    raise NotImplementedError


def instance_names(items: Sequence[Item]) -> list[str]:
    """Instance names of the nested modules among `items`: `as` or the id, -2, -3 on repeats."""
    raise NotImplementedError


def json_schema(kind: str) -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of "module" or "assembly" files, for editors."""
    raise NotImplementedError
