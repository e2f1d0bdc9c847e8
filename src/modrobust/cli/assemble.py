"""``modrobust assemble``: the resolved robot, for people or as JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from modrobust.cli.assemble_export import Mjcf, Places, Point, Urdf, check_point, export
from modrobust.cli.options import (
    Base,
    Drive,
    Gravity,
    Json,
    Lock,
    Mount,
    Package,
    Payload,
    RobotFile,
    Tip,
    Tolerance,
    Xacro,
    robot,
)

EXAMPLES = """\b
Examples:
  modrobust assemble lwa4p
  modrobust assemble my-robot.yaml -o resolved.json
  modrobust assemble lwa4p-paper --json
  modrobust assemble lwa4p --urdf lwa4p.urdf --mjcf lwa4p.xml
  modrobust assemble panda.urdf --lock grip=0.02 --tolerance "mass=5%,com=5mm"
"""


def assemble(
    file: RobotFile,
    base: Base = None,
    tip: Tip = None,
    lock: Lock = None,
    tolerance: Tolerance = None,
    drive: Drive = None,
    payload: Payload = None,
    mount: Mount = None,
    gravity: Gravity = None,
    xacro: Xacro = None,
    package: Package = None,
    json: Json = False,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="OUT.json", help="Write the resolved robot there."),
    ] = None,
    urdf: Urdf = None,
    mjcf: Mjcf = None,
    parameters: Point = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of corner and random.")] = 0,
) -> None:
    """Show a robot put together from modules or read from a URDF.

    Modules, standard D-H table, masses with their bounds, reach, static torques, what is exact.
    """
    from modrobust.cli.output import json_text, print_json

    check_point(parameters, urdf, mjcf)
    with Places() as place:
        resolved = place(output, ".json", "a resolved robot")
        parts = place(urdf, ".urdf", "a URDF"), place(mjcf, ".xml", "an MJCF")
        options = (base, tip, lock, tolerance, payload, mount, gravity, xacro, package)
        loaded = robot(file, *options, say_exact=False, drive=drive)
        if resolved is not None:
            resolved.write_text(json_text(loaded.to_dict()), encoding="utf-8")
        export(loaded, *parts, parameters, seed)
    if json:
        print_json(loaded.to_dict())
    else:
        from modrobust.assembly.summary import report
        from modrobust.cli.assemble_report import print_report

        print_report(loaded, report(loaded))


command = assemble
