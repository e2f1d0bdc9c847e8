from __future__ import annotations

EXAMPLES = ""


def assemble() -> None:
    """TODO."""
    raise NotImplementedError


command = assemble
