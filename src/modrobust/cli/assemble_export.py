"""The assembled robot in the formats of other engines, and what they do not hold."""

from __future__ import annotations

from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

if TYPE_CHECKING:
    from modrobust.model import Robot

Urdf = Annotated[Path | None, typer.Option(metavar="OUT.urdf", help="Write the robot as URDF.")]
Mjcf = Annotated[
    Path | None, typer.Option(metavar="OUT.xml", help="Write the robot as MJCF, for MuJoCo.")
]
Point = Annotated[
    Literal["nominal", "lower", "upper", "corner", "random"] | None,
    typer.Option(help="Parameters to write with --urdf and --mjcf. [default: nominal]"),
]


class Places:
    """The files to write: all are tried at once, before the work, and replaced together."""

    def __init__(self) -> None:
        self._stack = ExitStack()

    def __enter__(self) -> Places:
        self._stack.__enter__()
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.__exit__(*exception)  # type: ignore[arg-type]

    def __call__(self, path: Path | None, suffix: str, what: str) -> Path | None:
        """Where to write what is to be at `path`; None where nothing is wanted."""
        if path is None:
            return None
        from modrobust.checks import replacing

        place: AbstractContextManager[Path] = replacing(path, suffix, what)
        return self._stack.enter_context(place)


def check_point(which: str | None, *wanted: Path | None) -> None:
    """Refuse parameters that would not be written anywhere."""
    if which is not None and not any(wanted):
        from modrobust.errors import ValueRangeError

        raise ValueRangeError("--parameters: nothing is written at them; add --urdf or --mjcf")


def export(
    robot: Robot, urdf: Path | None, mjcf: Path | None, which: str | None, seed: int
) -> None:
    """Write the robot; say on stderr what the formats do not hold."""
    if urdf is None and mjcf is None:
        return
    from modrobust.cli.output import note
    from modrobust.export.mjcf import mjcf_text
    from modrobust.export.urdf import urdf_text
    from modrobust.simulation import true_robot

    truth = true_robot(robot, which or "nominal", seed=seed)
    if truth.pulled:
        bodies = ", ".join(truth.pulled)
        note(f"scaled towards nominal until physically consistent: the inertia of {bodies}")
    for part, kind, text_of in ((urdf, "URDF", urdf_text), (mjcf, "MJCF", mjcf_text)):
        if part is not None:
            exported = text_of(robot, truth.parameters)
            part.write_text(exported.text, encoding="utf-8")
            for line in exported.lost:
                note(f"not held by {kind}: {line}")
