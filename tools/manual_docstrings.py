"""Docstrings as the manual shows them: equations for KaTeX, and references as links."""

from __future__ import annotations

import re
from textwrap import dedent
from typing import Any

import griffe

# A `.. math::` block: the directive's own line, then lines that are indented or empty.
_MATH = re.compile(r"^\.\. math::(.*)\n((?:(?: +.*)?\n(?= |\n))*(?: +.*\n)?)", re.MULTILINE)
_KEY = re.compile(r"\[([A-Z]{1,3}\d{2})\]")


def _equation(found: re.Match[str]) -> str:
    body = "\n".join(part for part in (found[1].strip(), dedent(found[2]).strip()) if part)
    if r"\\" in body or "&" in body:
        body = rf"\begin{{aligned}}{body}\end{{aligned}}"
    return f"\n$$\n{body}\n$$\n\n"


def as_markdown(docstring: str) -> str:
    """The docstring with equations between ``$$`` and keys such as [GA17] as links."""
    text = _MATH.sub(_equation, f"{docstring}\n")
    return _KEY.sub(
        lambda key: rf"[\[{key[1]}\]](../references.md#{key[1].lower()})", text
    ).rstrip()


class Docstrings(griffe.Extension):
    """Applies `as_markdown` to everything that has a docstring."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Called for each object once its members are there."""
        if obj.docstring is not None:
            obj.docstring.value = as_markdown(obj.docstring.value)
