"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from modrobust.errors import FileError

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

    return parse_quantity(text, "time", field="--duration", bounds=False).nominal


def hertz(text: str | None) -> float | None:
    """A rate such as ``50 kHz`` or ``50000``, in hertz."""
    if text is None:
        return None
    from modrobust.formats import parse_quantity

    return parse_quantity(text, "frequency", field="--control-rate", bounds=False).nominal


def with_suffix(path: Path, suffix: str) -> Path:
    """`path`, which must end in `suffix`.

    Raises:
        FileError: It ends otherwise.
    """
    if path.suffix.lower() != suffix:
        raise FileError(
            path, f"has the suffix {path.suffix!r}; a file of this kind ends in {suffix}"
        )
    return path
