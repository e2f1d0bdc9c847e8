"""``modrobust assemble``: the resolved robot, for people or as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from modrobust.cli.options import Json, RobotFile

EXAMPLES = """\b
Examples:
  modrobust assemble lwa4p
  modrobust assemble my-robot.yaml -o resolved.json
  modrobust assemble lwa4p-paper --json
"""


def assemble(
    file: RobotFile,
    json: Json = False,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="OUT.json", help="Write the resolved robot there."),
    ] = None,
) -> None:
    """Assemble a robot from its modules and show what came out.

    Modules, standard D-H table, masses with their bounds, reach, static torques, what is exact.
    """
    from modrobust.assembly import load_robot
    from modrobust.cli.output import json_text, print_json
    from modrobust.files import replacing

    if output is None:
        robot = load_robot(file)
    else:
        with replacing(output, ".json", "a resolved robot") as part:
            robot = load_robot(file)
            part.write_text(json_text(robot.to_dict()), encoding="utf-8")
    if json:
        print_json(robot.to_dict())
    else:
        from modrobust.cli.assemble_report import print_report
        from modrobust.report import report

        print_report(report(robot))


command = assemble
