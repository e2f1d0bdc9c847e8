"""Words for structural errors that several readers share."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from modrobust.formats.nodes import shown


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """``did you mean "x"? `` when a known name is close, else nothing."""
    close = difflib.get_close_matches(name[:80], list(known), 1, 0.6)
    return f'did you mean "{close[0]}"? ' if close else ""


def unknown_key(key: str, known: Iterable[str]) -> str:
    """Message for a key that does not belong here."""
    names = list(known)
    return f"unknown key {shown(key)}; {did_you_mean(key, names)}known: {', '.join(names)}"
