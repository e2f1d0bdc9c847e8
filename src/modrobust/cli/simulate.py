"""``modrobust simulate``: the closed loop, with its figures and a verdict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

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
    loop_of,
    robot,
    seconds,
    start_error,
)
from modrobust.cli.simulate_pictures import (
    Plant,
    Video,
    View,
    check_pictures,
    check_shown,
    show_pictures,
)

EXAMPLES = """\b
Examples:
  modrobust simulate lwa4p-paper --scenario 1
  modrobust simulate lwa4p-paper --scenario 2 --bound ianea
  modrobust simulate lwa4p --parameters corner --seed 3 --duration 20s
  modrobust simulate ur5.urdf --tolerance "mass=5%,com=5mm,inertia=10%"
  modrobust simulate my-robot.yaml --trajectory motion.csv --log run.npz
  modrobust simulate lwa4p-payload --plant mujoco --rate 3kHz --delay 1

\b
--duration does not change the motion: a shorter run is its first part, and
epsilon is not judged then; in a longer one the last pose is held.

Ctrl-C ends a run early: what was computed is shown and saved, the exit code is 130.
The exit code is 1 when a bound is violated, the loop diverges, the tracking error does not
stay below epsilon, or a torque exceeds its limit. Remarks at the end (a torque that chatters, a
position or velocity beyond its limit) do not change it.

Without --trajectory the motion is the file's own, else a default within the limits: rest to rest
(quintic) through seeded waypoints, one about every 2.5 s, seed 0 whatever --seed says. The file's
"initial:" state counts only with the file's own motion; other motions start on themselves.
"""


def simulate(
    file: RobotFile,
    scenario: Annotated[
        str | None, typer.Option(metavar="NAME", help="True parameters: a scenario of the file.")
    ] = None,
    parameters: Annotated[
        Literal["nominal", "lower", "upper", "corner", "random"] | None,
        typer.Option(help="True parameters without a scenario. [default: random]"),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of corner and random. [default: 0]")
    ] = None,
    bound: Annotated[
        Literal["hull", "ianea"] | None, typer.Option(help="Bound of the perturbation.")
    ] = None,
    law: Law = None,
    hold_aware: HoldAware = None,
    duration: Annotated[
        str | None, typer.Option(metavar="TIME", help="Simulated time, e.g. 10s or 500ms.")
    ] = None,
    trajectory: Annotated[
        str | None,
        typer.Option(
            metavar="WHAT",
            help="paper (13), quintic (seeded waypoints), FILE.csv (t and q, splined), or "
            "quintic:FILE.csv (rest to rest through the rows). Default: the file's own, else "
            "quintic.",
        ),
    ] = None,
    rate: Rate = None,
    delay: Delay = None,
    noise: Noise = None,
    quantisation: Quantisation = None,
    saturation: Saturation = None,
    disturbance: Disturbance = None,
    initial_error: Annotated[
        str | None,
        typer.Option(
            metavar="ERROR",
            help='Error at the start: its norm, e.g. "0.02 rad", or "JOINT=VALUE, ..." of each.',
        ),
    ] = None,
    plant: Plant = "builtin",
    video: Video = None,
    view: View = False,
    log: Annotated[
        Path | None, typer.Option(metavar="OUT.npz", help="Save the run, sampled at 1 ms.")
    ] = None,
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
    """Run the closed loop; the controller knows only the bounds.

    The true parameters of the robot lie in their bounds; the controller does not know where.
    """
    wanted = seconds(duration)
    from modrobust.cli.output import ProgressBar, note, print_json
    from modrobust.cli.simulate_start import Start
    from modrobust.cli.wording import named_as_options
    from modrobust.errors import ValueRangeError, visible
    from modrobust.simulation.result import check_writable
    from modrobust.simulation.run import simulate as run

    if scenario is not None and seed is not None:
        raise ValueRangeError(
            f'--seed: given beside scenario "{scenario}", which draws nothing; give one of both'
        )
    if log is not None:
        check_writable(log)
    check_pictures(video, view)
    places = (base, tip, lock, tolerance, payload, mount, gravity, xacro, package)
    arm = robot(file, *places, say_exact=json, drive=drive)  # else the verdict says
    loop = loop_of(arm, rate, delay, noise, quantisation, saturation, disturbance)
    error = start_error(arm, initial_error)
    check_shown(arm, video, view)
    options = ["scenario", "parameters", "law", "bound", "hold_aware", "initial_error"]
    options += ["rate"] if rate is not None else []  # else it is the file's
    options += ["duration"] if duration is not None else []
    options += ["trajectory"] if trajectory is not None else []
    heading = (
        None
        if json
        else {
            "robot": arm.name,
            "scenario": scenario,
            "parameters": parameters or "random",
            "seed": seed or 0,
            "law": law or arm.controller.law,
            "bound": bound or arm.controller.bound,
            "plant": plant,
        }
    )
    with named_as_options(*options), ProgressBar(f"Simulating {visible(arm.name)}") as bar:
        start = Start(heading, loop.rate, bar)
        result = run(
            arm,
            scenario=scenario,
            parameters=parameters,
            seed=seed or 0,
            bound=bound,
            law=law,
            duration=wanted,
            trajectory=trajectory,
            hold_aware=hold_aware,
            loop=loop,
            initial_error=error,
            plant=plant,
            progress=start,
        )
    if log is not None:
        result.save(log)
    if json:
        print_json(result.summary())
    else:
        from modrobust.cli.simulate_report import print_run

        print_run(arm, result, trajectory)
    if result.interrupted:
        note(f"{result.reasons[0]}; what was computed is kept{'' if log is None else f' in {log}'}")
        raise typer.Exit(130)
    show_pictures(result, video, view)
    if not result.ok:
        raise typer.Exit(1)


command = simulate
