"""Words for structural errors that several readers share."""

from __future__ import annotations

from collections.abc import Iterable

from modrobust.checks import did_you_mean
from modrobust.formats.nodes import shown


def unknown_key(key: str, known: Iterable[str]) -> str:
    """Message for a key that does not belong here."""
    names = list(known)
    return f"unknown key {shown(key)}; {did_you_mean(key, names)}known: {', '.join(names)}"
