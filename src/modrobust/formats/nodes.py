"""The tree that both readers give: every scalar is text, every node knows its file and line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from modrobust.errors import DescriptionError


@dataclass(frozen=True)
class Where:
    """A place in a description: the file as the user named it, and the line, from 1."""

    file: str
    line: int | None

    def error(self, field: str, message: str) -> DescriptionError:
        """A `DescriptionError` at this place, to be raised by the caller."""
        return DescriptionError(self.file, self.line, field, message)


@dataclass(frozen=True)
class ScalarNode:
    """One scalar, as it was written (quotes and escapes resolved)."""

    text: str
    where: Where


@dataclass(frozen=True)
class ListNode:
    """A list of nodes."""

    items: tuple[Node, ...]
    where: Where


@dataclass(frozen=True)
class MapNode:
    """A mapping with text keys; `key_where` tells the place of each key."""

    entries: dict[str, Node]
    where: Where
    key_where: dict[str, Where] = field(default_factory=dict)

    def __iter__(self) -> Iterator[str]:
        return iter(self.entries)

    def place(self, key: str) -> Where:
        """The place of a key, or of the mapping when the key is not there."""
        return self.key_where.get(key, self.where)


type_names = {ScalarNode: "a text or number", ListNode: "a list", MapNode: "a mapping"}

Node = ScalarNode | ListNode | MapNode
