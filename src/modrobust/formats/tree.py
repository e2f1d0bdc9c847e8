"""Building the node tree from events, with the limits and refusals that YAML and JSON share."""

from __future__ import annotations

import re

from modrobust.errors import DescriptionError
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where, kind_of

_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # all but tab and newline

MAX_DEPTH = 32
MAX_VALUES = 20_000


class _Open:
    """A list or mapping that is still being read."""

    def __init__(self, where: Where, is_map: bool) -> None:
        self.where = where
        self.is_map = is_map
        self.items: list[Node] = []
        self.entries: dict[str, Node] = {}
        self.key_where: dict[str, Where] = {}
        self.key: str | None = None

    @property
    def step(self) -> str:
        if self.is_map:
            return self.key or ""
        return f"[{len(self.items)}]"


class TreeBuilder:
    """Takes events in reading order and gives the root mapping."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._stack: list[_Open] = []
        self._root: Node | None = None
        self._values = 0

    def refuse(self, where: Where, found: str, rule: str, remedy: str) -> DescriptionError:
        """An error at the field that is being read."""
        return where.error(self._field(), f"{found}; {rule}; {remedy}")

    def scalar(self, text: str, where: Where) -> None:
        """A scalar: a key when a mapping waits for one, else a value."""
        self._count(where)
        if not text.isascii() and any("\ud800" <= letter <= "\udfff" for letter in text):
            raise self.refuse(
                where, "half a surrogate pair", "text is Unicode", "write the letter itself"
            )
        control = _CONTROL.search(text)
        if control is not None:
            raise self.refuse(
                where,
                f"control character U+{ord(control[0]):04X}, written as an escape",
                "a text is plain, or it could steer the terminal that shows it",
                "remove it",
            )
        top = self._stack[-1] if self._stack else None
        if top is not None and top.is_map and top.key is None:
            if text in top.entries:
                top.key = text
                first = top.key_where[text].line
                raise self.refuse(
                    where,
                    f'duplicate key "{text}" (first on line {first})',
                    "a key stands once",
                    "remove one of them",
                )
            top.key = text
            top.key_where[text] = where
            return
        if not text and top is not None and top.key is not None:
            where = top.key_where[top.key]  # an empty value "stands" at the next token
        self._add(ScalarNode(text, where))

    def start_list(self, where: Where) -> None:
        """A list opens."""
        self._open(where, is_map=False)

    def start_map(self, where: Where) -> None:
        """A mapping opens."""
        self._open(where, is_map=True)

    def end(self) -> None:
        """The innermost list or mapping closes."""
        top = self._stack.pop()
        if top.is_map:
            self._add(MapNode(top.entries, top.where, top.key_where))
        else:
            self._add(ListNode(tuple(top.items), top.where))

    def root(self) -> MapNode:
        """The whole tree; its top level must be a mapping."""
        if not isinstance(self._root, MapNode):
            where = Where(self._name, 1 if self._root is None else self._root.where.line)
            found = "nothing" if self._root is None else kind_of(self._root)
            raise where.error(
                "",
                f"{found} at the top level; a description is a mapping that starts with "
                '"modrobust: 1"; see docs/reference/formats.md',
            )
        return self._root

    def _open(self, where: Where, is_map: bool) -> None:
        self._count(where)
        top = self._stack[-1] if self._stack else None
        if top is not None and top.is_map and top.key is None:
            raise self.refuse(
                where, "a list or mapping as a key", "a key is a plain text", "write a name"
            )
        if len(self._stack) >= MAX_DEPTH:
            raise where.error(
                "",
                f"nested more than {MAX_DEPTH} levels deep; a description has at most {MAX_DEPTH} "
                "levels; check the brackets",
            )
        self._stack.append(_Open(where, is_map))

    def _add(self, node: Node) -> None:
        if not self._stack:
            self._root = node
            return
        top = self._stack[-1]
        if not top.is_map:
            top.items.append(node)
        elif top.key is not None:
            top.entries[top.key] = node
            top.key = None

    def _count(self, where: Where) -> None:
        self._values += 1
        if self._values > MAX_VALUES:
            raise where.error(
                "",
                f"more than {MAX_VALUES} keys and values; a description has at most "
                f"{MAX_VALUES}; split it",
            )

    def _field(self) -> str:
        field = ""
        for level in self._stack:
            step = level.step[:80]
            field += step if step.startswith("[") or not field or not step else f".{step}"
        return field
