"""JSON descriptions: strict validity from the standard library, then a tree with lines.

The standard reader knows no lines for what it has read, so the text is read once for validity and
once more, now known to be valid, token by token for the tree.
"""

from __future__ import annotations

import json
import re

from modrobust.formats.nodes import MapNode, Where
from modrobust.formats.tree import MAX_DEPTH, TreeBuilder

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\]]|[^\s{}\[\],:"]+|\n', re.DOTALL)


def parse_json(text: str, name: str) -> MapNode:
    """The tree of a JSON text; numbers, true, false and null stay text.

    Raises:
        DescriptionError: Not valid JSON, nested too deep, or a duplicate key.
    """
    # Depth first: the standard reader recurses.
    depth = 0
    line = 1
    for match in _TOKEN.finditer(text):
        token = match[0]
        depth += (token in "{[") - (token in "}]")
        line += token.count("\n")
        if depth > MAX_DEPTH:
            raise Where(name, line).error(
                "",
                f"nested more than {MAX_DEPTH} levels deep; a description has at most {MAX_DEPTH} "
                "levels; check the brackets",
            )
    try:
        json.loads(text, parse_int=str, parse_float=str, parse_constant=_refuse_constant)
    except json.JSONDecodeError as error:
        raise Where(name, error.lineno).error(
            "", f"not JSON: {error.msg} (column {error.colno}); correct the text there"
        ) from None
    except _ConstantError as error:
        token = str(error)
        found = re.search(rf'(?<!["\w]){re.escape(token)}(?!["\w])', text)
        position = found.start() if found else 0
        raise Where(name, text.count("\n", 0, position) + 1).error(
            "", f"not JSON: {token} is not a number; write a finite number"
        ) from None
    return _build(text, name)


class _ConstantError(ValueError):
    pass


def _refuse_constant(token: str) -> None:
    raise _ConstantError(token)


def _build(text: str, name: str) -> MapNode:
    builder = TreeBuilder(name)
    line = 1
    for match in _TOKEN.finditer(text):
        token = match[0]
        where = Where(name, line)
        if token == "\n":
            line += 1
        elif token == "{":
            builder.start_map(where)
        elif token == "[":
            builder.start_list(where)
        elif token in "}]":
            builder.end()
        elif token.startswith('"'):
            builder.scalar(json.loads(token), where)
        else:
            builder.scalar(token, where)
    return builder.root()
