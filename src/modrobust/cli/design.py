"""``modrobust design``: gains for a robot's box and loop, what bounds them, what would help."""

from __future__ import annotations

from typing import Annotated

import typer

from modrobust.cli.options import (
    Base,
    Delay,
    Drive,
    Gravity,
    Json,
    Lock,
    Mount,
    Noise,
    Package,
    Payload,
    Quantisation,
    Rate,
    RobotFile,
    Tip,
    Tolerance,
    Xacro,
    error_norm,
    loop_of,
    robot,
)

EXAMPLES = """\b
Examples:
  modrobust design lwa4p --rate 1kHz --delay 1
  modrobust design panda --noise "position=1e-4" --epsilon 0.005
  modrobust design ur5.urdf --tolerance "mass=5%,com=5mm" --trajectory any
  modrobust design my-robot.yaml --margin

\b
The numbers are those that the law auto takes. They are estimates, found by
searching the box and the motion, not proved. --margin runs the loop with
gains raised up to 4 times. The exit code is 1 where epsilon cannot be met,
or where a run fails at the gains themselves.
"""


def design(
    file: RobotFile,
    rate: Rate = None,
    delay: Delay = None,
    noise: Noise = None,
    quantisation: Quantisation = None,
    epsilon: Annotated[
        str | None,
        typer.Option(
            metavar="ERROR",
            help="Norm of the tracking error to stay within, e.g. 0.01rad. [file's, else 0.01]",
        ),
    ] = None,
    trajectory: Annotated[
        str | None,
        typer.Option(
            metavar="WHAT",
            help="What the gains are for: any (motion within the joint and velocity limits), "
            "paper, quintic, FILE.csv or quintic:FILE.csv. [file's, else any]",
        ),
    ] = None,
    margin: Annotated[
        bool, typer.Option("--margin", help="Raise the gains until a run of the loop fails.")
    ] = False,
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
) -> None:
    """Choose gains for a robot and its loop, and say why.

    What bounds each gain, the error to expect by cause, and where epsilon cannot be met what would
    help most.
    """
    from modrobust.cli.output import ProgressBar, print_json
    from modrobust.cli.wording import named_as_options
    from modrobust.design import design as choose
    from modrobust.errors import visible
    from modrobust.motion import make_trajectory

    wanted = error_norm(epsilon, "--epsilon")
    places = (base, tip, lock, tolerance, payload, mount, gravity, xacro, package)
    arm = robot(file, *places, drive=drive)
    loop = loop_of(arm, rate, delay, noise, quantisation)
    with named_as_options("rate", "delay", "epsilon", "trajectory"):
        own = arm.trajectory is not None if trajectory is None else trajectory != "any"
        motion = make_trajectory(arm, trajectory) if own else None
        found = choose(arm, loop, epsilon=wanted, motion=motion)
    figures = found.to_dict(helps=True) if json else {}
    if not json:
        from modrobust.cli.design_report import print_design

        print_design(found)
    failed = not found.reachable
    if margin:
        from modrobust.simulation.margin import gain_margin

        with ProgressBar(f"Raising the gains of {visible(arm.name)}") as bar:
            raised = gain_margin(arm, found.settings, loop, motion, bar)
        failed = failed or raised.factor == 0.0
        if json:
            figures["margin"] = raised.to_dict()
        else:
            from modrobust.cli.design_report import print_margin

            print_margin(raised)
    if json:
        print_json(figures)
    if failed:
        raise typer.Exit(1)


command = design
