"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

from typing import Annotated

import typer

RobotFile = Annotated[
    str,
    typer.Argument(metavar="FILE", help="Assembly file, or the name of a built-in robot."),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]


def seconds(text: str | None) -> float | None:
    """A duration such as ``10 s``, ``500 ms`` or ``10``, in seconds."""
    if text is None:
        return None
    from modrobust.formats import parse_quantity

    return parse_quantity(text, "time", field="duration", bounds=False).nominal
