"""``modrobust import-timor``: a module database of Timor as module files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from modrobust.cli.options import Json

EXAMPLES = """\b
Examples:
  modrobust import-timor modules.json -o my-modules
  modrobust import-timor modules.json -o my-modules --inertia-about frame

Modules that cannot be imported are named on stderr with the reason; the exit code is 1 when none
can be. The files are ready to be completed: give bounds, since the database has none.
"""


def import_timor(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Timor's modules.json.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the module files.")
    ],
    inertia_about: Annotated[
        Literal["com", "frame"] | None,
        typer.Option(
            help="Reference point of every tensor. Default: what a rigid body can have, body by "
            "body, and it is said which."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Write the modules of a Timor database as module files."""
    from modrobust.cli.output import note, print_json, show
    from modrobust.cli.wording import as_options
    from modrobust.timor import write_modules
    from modrobust.timor.importer import import_timor as read

    result = read(file, inertia_about)
    paths = write_modules(result, output)
    if json:
        print_json(
            {
                "written": [str(path) for path in paths],
                "left_out": [{"module": name, "why": why} for name, why in result.left_out],
            }
        )
    for path, module in zip(paths, result.modules, strict=True):
        if not json:
            show(str(path))
        for remark in module.notes:
            note(f"{module.id}: {remark}")
    for remark in result.notes:
        note(as_options(remark))
    for name, reason in result.left_out:
        note(f"{name} left out: {as_options(reason)}")
    if not paths:
        raise typer.Exit(1)


command = import_timor
