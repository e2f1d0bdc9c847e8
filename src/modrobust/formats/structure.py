"""Words for structural errors that several readers share."""

from __future__ import annotations

from collections.abc import Iterable

from modrobust.checks import unknown_name
from modrobust.formats.nodes import shown


def unknown_key(key: str, known: Iterable[str]) -> str:
    """Message for a key that does not belong here."""
    return unknown_name(f"unknown key {shown(key)}", key, known)
