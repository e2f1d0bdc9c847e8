"""``modrobust modules``: the catalogue and what mates to what."""

from __future__ import annotations

from typing import Annotated

import typer

EXAMPLES = """\b
Examples:
  modrobust modules
  modrobust modules --json
"""


def modules(
    json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """List the modules of the catalogue with what can be mounted on each."""
    raise NotImplementedError


command = modules
