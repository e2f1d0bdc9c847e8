"""A simulated run as tables for people, in 80 columns; labels are the keys of the JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from modrobust.cli.output import number, position_unit, show, table, times, words
from modrobust.cli.verdict import print_verdict, truth

if TYPE_CHECKING:
    from rich.table import Table

    from modrobust.model import Robot
    from modrobust.simulation import SimulationResult

_PER_JOINT = ("tau_max", "tau_limit", "width_hull", "width_ianea", "ianea_over_hull")


def print_run(robot: Robot, result: SimulationResult, motion: str | None) -> None:
    """Print what the issue of a run is, under its heading.

    `motion` is what the command line said about it. Of a run that diverged there is nothing to
    say but why: every figure of it follows from that.
    """
    figures = result.summary()
    settings = figures["settings"]
    remark = robot.scenario_notes.get(settings["scenario"])
    show(*([] if remark is None else [f"Scenario {settings['scenario']}: {remark}."]))
    show(_motion(robot, motion), *_notes(robot, settings))
    if figures["diverged"]:
        show("")
        print_verdict(robot, figures)
        return
    show(_figures(figures, settings))
    show("Per joint: tau is the torque, width that of [Φ] in the mean", _joints(robot, figures))
    show(
        "Time per command",
        times({f"this run ({settings['bound']}), in C": figures["command_time"]}, robot.name),
    )
    print_verdict(robot, figures)


def _motion(robot: Robot, motion: str | None) -> str:
    own = robot.trajectory
    drawn = own is not None and own.kind == "quintic" and not own.points
    if motion is None and own is not None and not drawn:
        return f"Motion: the file's own, {own.kind}."
    if motion in (None, "quintic"):
        return "Motion: the default, quintic through seeded waypoints, seed 0."
    return f"Motion: {'(13) of the paper' if motion == 'paper' else motion}."


def print_heading(settings: Mapping[str, Any]) -> None:
    """Print what runs, before it does: `settings` as of the run."""
    show(_headline(settings), style="bold")


def _headline(settings: Mapping[str, Any]) -> str:
    engine = "" if settings["plant"] == "builtin" else f", plant {settings['plant']}"
    return (
        f"{settings['robot']}, {truth(settings)}: {settings['duration']:g} s, law "
        f"{settings['law']}, bound {settings['bound']}{engine}"
    )


def _notes(robot: Robot, settings: Mapping[str, Any]) -> list[str]:
    lines = [*_loop(robot, settings["loop"]), *_law(settings)]
    if settings["scaled_to_physical"]:
        bodies = ", ".join(settings["scaled_to_physical"])
        lines.append(
            f"Scaled towards nominal until physically consistent: the inertia of {bodies}."
        )
    if not settings["parameters_inside_bounds"]:
        lines.append("The true parameters lie outside the bounds: nothing is guaranteed.")
    return lines


def _loop(robot: Robot, loop: Mapping[str, Any]) -> list[str]:
    """How often the command is given, how late it acts, and what is measured."""
    delay = loop["delay"]
    late = f", acts {'one period' if delay == 1.0 else f'{delay:g} periods'} late" if delay else ""
    lines = [
        f"A command every {1e3 / loop['rate']:.4g} ms ({loop['rate'] / 1e3:g} kHz), held{late}."
    ]
    unit = position_unit(robot)
    said = []
    for what in ("noise", "quantisation"):
        sizes = [max(loop[f"{what}_{kind}"], default=0.0) for kind in ("position", "velocity")]
        if any(sizes):
            sign = ", worst sign" if what == "noise" and loop["noise"] == "worst" else ""
            of_q, of_dq = (f"{size:g}" for size in sizes)
            said.append(f"{what} up to {of_q} {unit}, {of_dq} per s{sign}")
    if loop["velocity"] == "differentiated":
        said.append(f"velocity differentiated, filter {loop['filter']:g} Hz")
    if loop["disturbance"] != "constant":
        said.append(f"disturbance {loop['disturbance']}")
    if loop["saturation"]:
        said.append("torques cut at their limits")
    return [*lines, *([f"Loop: {'; '.join(said)}."] if said else [])]


def _law(settings: Mapping[str, Any]) -> list[str]:
    if settings["law"] != "sampled":
        return []
    return [
        f"Gains: G {settings['G']:.4g}/s, Lambda {settings['Lambda']:.4g}/s, L_i "
        f"{settings['L_i']:.4g}/s^2, blend {settings['blend']:g} s. Violations judge the bound at "
        "the desired motion, not the loop."
    ]


def _figures(figures: Mapping[str, Any], settings: Mapping[str, Any]) -> Table:
    rows = table("", "", left=2, folded={1})
    entered = figures["epsilon_entered_at"]
    largest = figures["error_max_after_entry"]
    shown = {
        "violations": f"{figures['violations']} of {figures['ticks']} ticks, of the bound",
        "epsilon_entered_at": (
            f"not judged, cut short; epsilon {settings['epsilon']:g}"
            if figures["cut_short"]
            else f"{'never' if entered is None else f'permanently after {entered:.4g} s'}, "
            f"epsilon {settings['epsilon']:g}"
        ),
        "error_final": f"{number(figures['error_final'])}, norm of the tracking error",
        "error_max_after_entry": "-" if largest is None else f"{largest:.6g}",
        "rho_mean": f"{number(figures['rho_mean'])}, ‖ρ‖, worst case of [Φ]",
        "rho_max": number(figures["rho_max"]),
    }
    noisy = figures["chattering"]
    if noisy is not None:
        worst = None if None in noisy else max(noisy)
        limit = figures["chattering_limit"]
        verdict = (
            "with noise no limit"
            if limit is None
            else f"{'beyond' if worst is None or worst > limit else 'limit'} {limit:g}"
        )
        shown["chattering"] = f"{number(worst)} times that at 10 Hz, last 5 s ({verdict})"
    for key, text in shown.items():
        rows.add_row(words(key), text)
    return rows


def _joints(robot: Robot, figures: Mapping[str, Any]) -> Table:
    rows = table("joint", "", *map(words, _PER_JOINT), left=2)
    for j, name in enumerate(robot.joint_names):
        rows.add_row(
            name,
            "N m" if robot.free_turns[j] else "N",
            *(number(None if figures[key] is None else figures[key][j]) for key in _PER_JOINT),
        )
    return rows
