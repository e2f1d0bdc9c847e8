"""Words for a name that is not known."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def unknown_name(found: str, name: object, known: Iterable[str]) -> str:
    """A message about a name that is not known: what was found, the name meant, those known.

    Args:
        found: What stands there, such as ``no joint named "elbwo"``.
        name: The name itself.
        known: The names that could stand there.
    """
    names = list(known)
    return f"{found}; {did_you_mean(name, names)}known: {', '.join(names) or 'none'}"


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """``did you mean "x"? `` when a known name is close, else nothing."""
    spelt = {each.casefold(): each for each in known}
    close = difflib.get_close_matches(str(name)[:80].casefold(), list(spelt), 1, 0.6)
    return f'did you mean "{spelt[close[0]]}"? ' if close else ""
