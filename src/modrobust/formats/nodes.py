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


Node = ScalarNode | ListNode | MapNode


def kind_of(node: Node) -> str:
    """What a node is, in words for a message."""
    if isinstance(node, MapNode):
        return "a mapping"
    if isinstance(node, ListNode):
        return "a list"
    return shown(node.text) if node.text else "nothing"


def shown(text: str, limit: int = 60) -> str:
    """A text in quotes, on one line and not longer than a message can bear."""
    flat = " ".join(text.split())
    printable = "".join(c if c.isprintable() else "?" for c in flat)
    return f'"{printable}"' if len(printable) <= limit else f'"{printable[:limit]}..."'
