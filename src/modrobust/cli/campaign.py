"""``modrobust campaign``: many closed loops of one robot, and the worst case of each figure."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from modrobust.cli.options import (
    Base,
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
from modrobust.cli.simulate_pictures import Plant

EXAMPLES = """\b
Examples:
  modrobust campaign lwa4p --runs 100
  modrobust campaign lwa4p --rate 500Hz --delay 1 --noise "position=1e-4, velocity=1e-2"
  modrobust campaign ur5.urdf --tolerance "mass=5%,com=5mm,inertia=10%" --runs 1000 --jobs 8
  modrobust campaign lwa4p --only 17 --log run.npz

\b
Run k takes true parameters at the lower end, the upper end, a corner and a random point in turn,
with a disturbance (constant, sine, random, worst sign), noise (uniform, worst sign; where the loop
has noise) and a motion: the file's own, or one drawn from rest to rest in 1 s (short) or 10 s
(long), at half of the limits of speed. It depends on the robot, the settings, the seed and k alone:
--only K is the same run, bit for bit, with any --runs and --jobs.

\b
Late figures are those from 0.45 s on in short motions, from 1 s on in others. The law auto chooses
its gains once: for the file's motion with --motions own, else for any motion within the limits.

Ctrl-C ends a campaign early: what was done is shown, the exit code is 130.
The exit code is 1 when a run diverged, did not settle, stayed at a torque limit, violated its
bound or did not stay below epsilon. Whatever it is, nothing is proved of runs that were not tried.
"""


def campaign(
    file: RobotFile,
    runs: Annotated[int, typer.Option(min=1, help="How many runs.")] = 100,
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Processes. [default: one for each processor]")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seeds everything that is drawn.")] = 0,
    only: Annotated[
        int | None, typer.Option(min=0, metavar="RUN", help="This run alone, from 0.")
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(metavar="OUT.npz", help="With --only: save the run, sampled at 1 ms."),
    ] = None,
    rate: Annotated[
        str | None, typer.Option(metavar="HZ", help="Commands a second, e.g. 1kHz. [file's]")
    ] = None,
    delay: Annotated[
        float | None,
        typer.Option(metavar="PERIODS", help="How late a command acts, 0 to 1. [file's]"),
    ] = None,
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="ERRORS",
            help='Largest errors of what is measured, e.g. "position=1e-4, velocity=1e-2". '
            "[file's]",
        ),
    ] = None,
    saturation: Annotated[
        bool | None,
        typer.Option(
            "--saturation/--no-saturation", help="Whether the drive cuts torques. [file's]"
        ),
    ] = None,
    law: Annotated[
        Literal["norm", "componentwise", "sampled", "auto"] | None,
        typer.Option(help="Law of the robust part. [file's]"),
    ] = None,
    epsilon: Annotated[
        str | None,
        typer.Option(metavar="ERROR", help="Norm of the error to stay below. [file's]"),
    ] = None,
    motions: Annotated[
        str | None,
        typer.Option(metavar="KINDS", help='Such as "own, short". [default: own, short, long]'),
    ] = None,
    initial_error: Annotated[
        str | None,
        typer.Option(metavar="ERROR", help="Norm of the error at the start. [default: 5e-3]"),
    ] = None,
    plant: Plant = "builtin",
    base: Base = None,
    tip: Tip = None,
    lock: Lock = None,
    tolerance: Tolerance = None,
    payload: Payload = None,
    mount: Mount = None,
    gravity: Gravity = None,
    xacro: Xacro = None,
    package: Package = None,
    json: Json = False,
) -> None:
    """Run many closed loops and show the worst case of each figure.

    What is tried is not proved: see "modrobust assemble" for what holds in the whole box.
    """
    from modrobust.campaign import campaign as run
    from modrobust.campaign.plan import INITIAL_ERROR, MOTIONS
    from modrobust.cli.campaign_loop import laid_over, size
    from modrobust.cli.campaign_report import print_campaign, print_one, print_start, repeated
    from modrobust.cli.output import ProgressBar, note, print_json
    from modrobust.cli.wording import named_as_options
    from modrobust.errors import ValueRangeError, visible
    from modrobust.simulation.result import check_writable

    if log is not None and only is None:
        raise ValueRangeError(
            "--log: given without --only RUN; a log is of one run; give its number"
        )
    if log is not None:
        check_writable(log)
    command = repeated(
        file,
        {
            "seed": seed or None,
            "rate": rate,
            "delay": delay,
            "noise": noise,
            "saturation": saturation,
            "law": law,
            "epsilon": epsilon,
            "motions": motions,
            "initial-error": initial_error,
            "plant": None if plant == "builtin" else plant,
            "base": base,
            "tip": tip,
            "lock": lock,
            "tolerance": tolerance,
            "payload": payload,
            "mount": mount,
            "gravity": gravity,
            "xacro": xacro,
            "package": package,
        },
    )
    arm = robot(file, base, tip, lock, tolerance, payload, mount, gravity, xacro, package)
    loop = laid_over(arm, rate, noise, saturation)
    start = INITIAL_ERROR if initial_error is None else size(initial_error, "--initial-error")
    count = 1 if only is not None else runs
    with (
        named_as_options("rate", "delay", "epsilon", "plant", "motions"),
        ProgressBar(f"{count} runs of {visible(arm.name)}") as bar,
    ):
        done = run(
            arm,
            runs=runs,
            jobs=jobs,
            seed=seed,
            only=only,
            loop=loop,
            delay=delay,
            motions=MOTIONS if motions is None else [kind.strip() for kind in motions.split(",")],
            initial_error=start,
            plant=plant,
            progress=lambda part, whole: bar(part / whole),
            law=law,
            epsilon=None if epsilon is None else size(epsilon, "--epsilon"),
        )
        if log is not None and only is not None:
            done.rerun(only).save(log)
    if json:
        print_json(done.summary(command))
    else:
        print_start(done)
        print_campaign(done, command) if only is None else print_one(done)
    if done.interrupted:
        note(f"interrupted after {len(done.records)} of {len(done.wanted)} runs")
        raise typer.Exit(130)
    if not done.ok:
        raise typer.Exit(1)


command = campaign
