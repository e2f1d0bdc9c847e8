"""Mappings on one line, for the command line: ``mass=[0 kg, 2 kg], com=[0, 0, 20 mm], at=tool``."""

from __future__ import annotations

from modrobust.errors import ValueRangeError
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where, shown

_MAX_DEPTH = 8
_MAX_LENGTH = 4096
_STOPS = ",[]{}"


def parse_inline(text: str, option: str) -> MapNode:
    """The mapping that ``key=value, key=value`` says; values may be lists and mappings.

    Args:
        text: Such as ``mass=5%,com=5mm``; ``[a, b]`` is a list, ``{k: v}`` or ``{k=v}`` a mapping.
        option: What messages call the text, such as ``payload``.

    Raises:
        ValueRangeError: The text is not of that form.
    """
    return _Parser(text, option).whole()


class _Parser:
    def __init__(self, text: str, option: str) -> None:
        self._text = text
        self._option = option
        self._at = 0
        self._where = Where(option, None)

    def whole(self) -> MapNode:
        if len(self._text) > _MAX_LENGTH:
            raise self._error(f"{len(self._text)} characters; it has at most {_MAX_LENGTH}")
        entries = self._pairs("", 0)
        if self._at < len(self._text):
            raise self._error(f'"{self._text[self._at]}" without its other half')
        return entries

    def _pairs(self, end: str, depth: int) -> MapNode:
        entries: dict[str, Node] = {}
        while True:
            key, sign = self._key()
            if not key and self._peek() == end and not entries:
                raise self._error("nothing is written")
            if not key or not sign:
                raise self._error(f"{shown(key)} is no key=value")
            if key in entries:
                raise self._error(f'"{key}" is given twice')
            entries[key] = self._value(depth)
            if self._peek() != ",":
                return MapNode(entries, self._where)
            self._at += 1

    def _key(self) -> tuple[str, str]:
        start = self._at
        while self._at < len(self._text) and self._text[self._at] not in "=:" + _STOPS:
            self._at += 1
        key = self._text[start : self._at].strip()
        sign = self._peek() if self._peek() in ("=", ":") else ""
        self._at += len(sign)
        return key, sign

    def _value(self, depth: int) -> Node:
        if depth > _MAX_DEPTH:
            raise self._error(f"more than {_MAX_DEPTH} brackets deep")
        self._blanks()
        if self._peek() == "[":
            return self._list(depth)
        if self._peek() == "{":
            self._at += 1
            inner = self._pairs("}", depth + 1)
            self._close("}")
            return inner
        start = self._at
        while self._at < len(self._text) and self._text[self._at] not in _STOPS:
            self._at += 1
        return ScalarNode(self._text[start : self._at].strip(), self._where)

    def _list(self, depth: int) -> ListNode:
        self._at += 1
        items = [self._value(depth + 1)]
        while self._peek() == ",":
            self._at += 1
            items.append(self._value(depth + 1))
        self._close("]")
        return ListNode(tuple(items), self._where)

    def _close(self, bracket: str) -> None:
        self._blanks()
        if self._peek() != bracket:
            raise self._error(f'no "{bracket}" where it is expected')
        self._at += 1
        self._blanks()

    def _blanks(self) -> None:
        while self._peek() == " ":
            self._at += 1

    def _peek(self) -> str:
        return self._text[self._at : self._at + 1]

    def _error(self, found: str) -> ValueRangeError:
        return ValueRangeError(
            f'{self._option}: {shown(self._text)}: {found}; write "key=value, key=value" with '
            "lists in [ ]"
        )
