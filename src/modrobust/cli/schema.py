"""``modrobust schema``: the JSON Schema of the description files."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

EXAMPLES = """\b
Examples:
  modrobust schema module > module.schema.json
  modrobust schema assembly
"""


def schema(
    kind: Annotated[Literal["module", "assembly"], typer.Argument(help="Which kind of file.")],
    json: Annotated[
        bool, typer.Option("--json", help="As on every command; it prints JSON anyway.")
    ] = False,
) -> None:
    """Print the JSON Schema of description files, for editors."""
    from modrobust.cli.output import print_json
    from modrobust.formats import json_schema

    print_json(json_schema(kind))


command = schema
