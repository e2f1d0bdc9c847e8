"""A simulated run as tables for people, in 80 columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from modrobust.cli.output import number, show, table, times

if TYPE_CHECKING:
    from rich.table import Table

    from modrobust.result import SimulationResult
    from modrobust.robot import Robot


def print_run(robot: Robot, result: SimulationResult, motion: str | None) -> None:
    """Print what the issue of a run is: bound, error, torques, widths, times, verdict, remarks.

    `motion` is what the command line said about it.
    """
    figures = result.summary()
    settings = figures["settings"]
    show(_headline(settings), style="bold")
    remark = robot.scenario_notes.get(settings["scenario"])
    show(*([] if remark is None else [f"Scenario {settings['scenario']}: {remark}."]))
    show(_motion(robot, motion), *_notes(settings), _figures(figures, settings))
    show("Largest torque, mean width of [Φ]", _joints(robot, figures))
    show(
        "Time per command",
        times({f"this run ({settings['bound']}), in C": figures["command_time"]}),
    )
    reasons: Sequence[str] = figures["reasons"]
    if reasons:
        show(*(f"Not good: {reason}" for reason in reasons), style="bold red")
    else:
        show(
            "Good: bound kept, error within epsilon for good, torques within limits", style="green"
        )
    opening = "Also" if reasons else "But"
    show(*(f"{opening}: {remark}" for remark in figures["remarks"]), style="yellow")


def _motion(robot: Robot, motion: str | None) -> str:
    if motion is None and robot.trajectory is not None:
        return f"Motion: the file's own, {robot.trajectory.kind}."
    if motion in (None, "quintic"):
        return "Motion: the default, quintic through seeded waypoints, seed 0."
    return f"Motion: {'(13) of the paper' if motion == 'paper' else motion}."


def _headline(settings: Mapping[str, Any]) -> str:
    truth = (
        f"scenario {settings['scenario']}"
        if settings["scenario"] is not None
        else f"{settings['parameters']} parameters"
        + (f", seed {settings['seed']}" if settings["parameters"] in ("corner", "random") else "")
    )
    engine = "" if settings["plant"] == "builtin" else f", plant {settings['plant']}"
    return (
        f"{settings['robot']}, {truth}: {settings['duration']:g} s, law {settings['law']}, "
        f"bound {settings['bound']}{engine}"
    )


def _notes(settings: Mapping[str, Any]) -> list[str]:
    rate = f"{settings['control_rate'] / 1e3:g} kHz"
    lines = [f"The command is evaluated at {rate} and held in between."]
    if settings["pulled_to_physical"]:
        bodies = ", ".join(settings["pulled_to_physical"])
        lines.append(f"Pulled towards nominal until physical: the inertia of {bodies}.")
    if not settings["parameters_inside_bounds"]:
        lines.append("The true parameters lie outside the bounds: nothing is guaranteed.")
    return lines


def _figures(figures: Mapping[str, Any], settings: Mapping[str, Any]) -> Table:
    rows = table("", "", left=2)
    entered = figures["epsilon_entered_at"]
    epsilon = f"{settings['epsilon']:g}"
    rows.add_row("violations of the bound", f"{figures['violations']} of {figures['ticks']} ticks")
    rows.add_row(
        f"tracking error below {epsilon}",
        "not for good" if entered is None else f"for good from {entered:.4g} s",
    )
    rows.add_row("tracking error at the end", number(figures["error_final"]))
    largest = figures["error_max_after_entry"]
    rows.add_row("  largest after entering for good", "-" if largest is None else f"{largest:.6g}")
    rows.add_row(
        "‖ρ‖, worst case of [Φ]",
        f"mean {number(figures['rho_mean'])}, largest {number(figures['rho_max'])}",
    )
    noisy = figures["chattering"]
    if noisy is not None:
        worst = None if None in noisy else max(noisy)
        limit = figures["chattering_limit"]
        verdict = "beyond" if worst is None or worst > limit else "limit"
        rows.add_row(
            "torque variation, last 5 s",
            f"{number(worst)} times that at 10 Hz ({verdict} {limit:g})",
        )
    return rows


def _joints(robot: Robot, figures: Mapping[str, Any]) -> Table:
    rows = table("joint", "", "torque", "limit", "[Φ] hull", "[Φ] ianea", "ratio", left=2)
    for j, name in enumerate(robot.joint_names):
        rows.add_row(
            name,
            "N m" if robot.free_types[j] == "revolute" else "N",
            *(
                number(None if figures[key] is None else figures[key][j])
                for key in ("tau_max", "tau_limit", "width_hull", "width_ianea", "width_ratio")
            ),
        )
    return rows
