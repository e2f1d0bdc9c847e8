from __future__ import annotations

EXAMPLES = ""


def bench() -> None:
    """TODO."""
    raise NotImplementedError


command = bench
