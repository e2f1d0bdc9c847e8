from __future__ import annotations

EXAMPLES = ""


def simulate() -> None:
    """TODO."""
    raise NotImplementedError


command = simulate
