"""Reading a description: a file of YAML or JSON becomes a tree of text with file and line.

Every scalar stays text, because YAML loaders read ``5e-5`` as a string, ``160:1`` as 9601 and
``no`` as False; the quantity grammar reads the numbers. Anchors, aliases and tags are refused, so
nothing expands; depth, size, length of a line and number of values are bounded before they cost.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from modrobust.checks.files import kind_of_path
from modrobust.errors import DescriptionError, FileError
from modrobust.formats.json_reader import parse_json
from modrobust.formats.nodes import MapNode, Where
from modrobust.formats.tree import TreeBuilder

MAX_BYTES = 1 << 20
MAX_LINE = 4096  # of YAML: the scanner takes quadratic time for one endless word
_CONTROL = re.compile("[\x01-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ufffe\uffff]")
SUFFIXES = (".yaml", ".yml", ".json")


def read_description(path: str | Path) -> MapNode:
    """The tree of a description file.

    Args:
        path: A ``.yaml``, ``.yml`` or ``.json`` file of at most 1 MiB, UTF-8.

    Raises:
        FileError: The file is missing, a directory, unreadable, of another type or not text.
        DescriptionError: The text is not one plain document whose top level is a mapping.
    """
    name = os.fspath(path)
    text = _read_text(name)
    return parse_json(text, name) if name.lower().endswith(".json") else _parse_yaml(text, name)


def parse_description(text: str, name: str) -> MapNode:
    """The tree of a YAML text that is to stand in a file of that name, see `read_description`."""
    return _parse_yaml(text, name)


def _read_text(name: str) -> str:
    path = Path(name)
    there = kind_of_path(path)
    if there == "missing":
        raise FileError(name.replace("\0", "\\0"), _missing(path))
    if there == "directory":
        raise FileError(name, "is a directory; a description is one file; name the file in it")
    if path.suffix.lower() not in SUFFIXES:
        found = f'suffix "{path.suffix}"' if path.suffix else "no suffix"
        raise FileError(
            name, f"{found}; a description ends in .yaml, .yml or .json; rename or convert it"
        )
    if there != "file":
        raise FileError(
            name, "is a pipe or a device; a description is a regular file; save it as one"
        )
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise FileError(name, f"cannot be read: {error.strerror}; check its permissions") from None
    if len(data) > MAX_BYTES:
        raise FileError(name, "more than 1 MiB; a description has at most 1 MiB; split it")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(
            name, f"not UTF-8 text (byte {error.start}); save the description as UTF-8 text"
        ) from None
    if "\0" in text:
        raise FileError(name, "a binary file (it holds NUL bytes); a description is UTF-8 text")
    if not text.strip():
        raise FileError(
            name, 'empty; a description starts with "modrobust: 1"; see docs/reference/formats.md'
        )
    return text


def _missing(path: Path) -> str:
    if "\0" in str(path):
        return "not a file name; check the path"
    folder = path.parent
    if kind_of_path(folder) != "directory":
        return f'no such file; there is no directory "{folder}"; check the path'
    return "no such file; check the path"


def _parse_yaml(text: str, name: str) -> MapNode:
    control = _CONTROL.search(text)
    if control:
        raise DescriptionError(
            name,
            text.count("\n", 0, control.start()) + 1,
            "",
            f"control character U+{ord(control[0]):04X}; a description is plain text; remove it",
        )
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > MAX_LINE:
            raise DescriptionError(
                name,
                number,
                "",
                f"a line of {len(line)} characters; a line has at most {MAX_LINE}; break it",
            )
    try:
        return _build(text, name)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line_number = mark.line + 1 if mark is not None else None
        problem = " ".join((error.problem or error.context or "cannot be read").split())
        raise DescriptionError(
            name,
            line_number,
            "",
            f"not YAML: {problem}; check indentation, quotes and brackets near this line",
        ) from None
    except YAMLError as error:
        problem = " ".join(str(error).split())[:200]
        raise DescriptionError(
            name, None, "", f"not YAML: {problem}; save the description as plain UTF-8 text"
        ) from None


def _build(text: str, name: str) -> MapNode:
    builder = TreeBuilder(name)
    documents = 0
    for event in _events(text, name):
        where = Where(name, event.start_mark.line + 1)
        if isinstance(event, AliasEvent):
            raise builder.refuse(
                where,
                f'alias "*{event.anchor}"',
                "aliases and anchors are not allowed, because they can expand without end",
                "write the value out",
            )
        if isinstance(event, ScalarEvent | SequenceStartEvent | MappingStartEvent):
            if event.anchor is not None:
                raise builder.refuse(
                    where,
                    f'anchor "&{event.anchor}"',
                    "aliases and anchors are not allowed, because they can expand without end",
                    "write the value out where it is needed",
                )
            if event.ctag is not None and str(event.ctag) not in ("", "None"):
                raise builder.refuse(
                    where, f'tag "{event.ctag}"', "tags are not allowed", "remove it"
                )
        if isinstance(event, ScalarEvent):
            builder.scalar(event.value, where)
        elif isinstance(event, SequenceStartEvent):
            builder.start_list(where)
        elif isinstance(event, MappingStartEvent):
            builder.start_map(where)
        elif isinstance(event, SequenceEndEvent | MappingEndEvent):
            builder.end()
        elif isinstance(event, DocumentStartEvent):
            documents += 1
            if documents > 1:
                raise builder.refuse(
                    where,
                    'a second document ("---")',
                    "a file holds one description",
                    "put it into a file of its own",
                )
    return builder.root()


def _events(text: str, name: str) -> Iterator[Event]:
    line = 1
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            line = event.start_mark.line + 1
            yield event
    except (ValueError, OverflowError):  # chr() inside the scanner
        raise DescriptionError(
            name,
            line,
            "",
            "not YAML: an escape after this line is no Unicode character; write the letter itself",
        ) from None
