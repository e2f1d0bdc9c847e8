"""``modrobust campaign``: many closed loops of one robot, and the worst case of each figure."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from modrobust.cli.options import (
    Base,
    Delay,
    Disturbance,
    Drive,
    Gravity,
    HoldAware,
    Json,
    Law,
    Lock,
    Mount,
    Noise,
    Package,
    Payload,
    Quantisation,
    Rate,
    RobotFile,
    Saturation,
    Tip,
    Tolerance,
    Xacro,
    error_norm,
    loop_of,
    robot,
    start_error,
)
from modrobust.cli.simulate_pictures import Plant

EXAMPLES = """\b
Examples:
  modrobust campaign lwa4p --runs 100
  modrobust campaign lwa4p --rate 500Hz --delay 1 --noise "position=1e-4"
  modrobust campaign ur5.urdf --tolerance "mass=5%,com=5mm" --runs 1000
  modrobust campaign lwa4p --only 17 --log run.npz

Run k takes true parameters at the lower end, the upper end, a corner and a random point in turn,
with a disturbance (constant, sine, random, worst sign), noise (uniform, worst sign; where the loop
has noise) and a motion: the file's own, or one drawn from rest to rest in 1 s (short) or 10 s
(long), at half of the limits of speed. It depends on the robot, the settings, the seed and k alone:
--only K is the same run, bit for bit, with any --runs and --jobs.

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
    rate: Rate = None,
    delay: Delay = None,
    noise: Noise = None,
    quantisation: Quantisation = None,
    saturation: Saturation = None,
    disturbance: Disturbance = None,
    law: Law = None,
    hold_aware: HoldAware = None,
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
        typer.Option(
            metavar="ERROR",
            help='Error at the start: its norm, or "JOINT=VALUE, ..." of each, the signs drawn. '
            "[default: 0.005]",
        ),
    ] = None,
    plant: Plant = "builtin",
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
    """Run many closed loops and show the worst cases.

    What is tried is not proved: see "modrobust assemble" for what holds in the whole box.
    """
    from modrobust.campaign import campaign as run
    from modrobust.campaign.plan import INITIAL_ERROR, MOTIONS
    from modrobust.cli.campaign_report import print_campaign, print_one, print_start
    from modrobust.cli.campaign_runs import Repeated
    from modrobust.cli.output import ProgressBar, note, print_json
    from modrobust.cli.wording import named_as_options
    from modrobust.errors import ValueRangeError, visible
    from modrobust.model import DISTURBANCES
    from modrobust.simulation.result import check_writable

    if log is not None and only is None:
        raise ValueRangeError(
            "--log: given without --only RUN; a log is of one run; give its number"
        )
    if log is not None:
        check_writable(log)
    places = (base, tip, lock, tolerance, payload, mount, gravity, xacro, package)
    arm = robot(file, *places, drive=drive)
    loop = loop_of(arm, rate, delay, noise, quantisation, saturation)
    start = start_error(arm, initial_error)
    radius = error_norm(epsilon, "--epsilon")
    kinds = MOTIONS if motions is None else [kind.strip() for kind in motions.split(",")]
    count = 1 if only is not None else runs
    with (
        named_as_options("rate", "epsilon", "plant", "motions", "law", "hold_aware"),
        ProgressBar(f"{count} runs of {visible(arm.name)}") as bar,
    ):
        done = run(
            arm,
            runs=runs,
            jobs=jobs,
            seed=seed,
            only=only,
            loop=loop,
            disturbances=DISTURBANCES if disturbance is None else (disturbance,),
            motions=kinds,
            initial_error=INITIAL_ERROR if start is None else start,
            plant=plant,
            progress=lambda part, whole: bar(part / whole) if part else bar.restart(),
            law=law,
            hold_aware=hold_aware,
            epsilon=radius,
        )
        if log is not None and only is not None:
            done.rerun(only).save(log)
    shared = {
        "rate": rate,
        "delay": delay,
        "noise": noise,
        "quantisation": quantisation,
        "saturation": saturation,
        "law": law,
        "hold-aware": hold_aware,
        "plant": None if plant == "builtin" else plant,
        "base": base,
        "tip": tip,
        "lock": lock,
        "tolerance": tolerance,
        "drive": drive,
        "payload": payload,
        "mount": mount,
        "gravity": gravity,
        "xacro": xacro,
        "package": package,
    }
    own = {
        "seed": seed or None,
        "disturbance": disturbance,
        "epsilon": epsilon,
        "motions": motions,
        "initial-error": initial_error,
    }
    command = Repeated(file, done.job, shared, own)
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
