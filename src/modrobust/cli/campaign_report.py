"""A campaign as a table for people: one row a figure, and the command that shows it again."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from modrobust.cli.output import number, show, table, words

if TYPE_CHECKING:
    from modrobust.campaign import Campaign

_UNITS = {"late_error": ", norm"}


def print_start(done: Campaign) -> None:
    """Print what was run: the robot, its loop and its gains."""
    job = done.job
    loop, settings = job.loop, job.settings
    rate = f"{loop.rate / 1e3:g} kHz" if loop.rate >= 1e3 else f"{loop.rate:g} Hz"
    gains = f", G = {settings.G:g}/s" if settings.G is not None else ""
    engine = "" if job.plant == "builtin" else f", plant {job.plant}"
    noisy = "no noise" if job.plan.noises == ("none",) else "noise"
    count = len(done.records)
    runs = f"{count} run{'s' * (count != 1)}"
    show(
        f"{job.robot.name}: {runs} at {rate}, delay {loop.delay:g}, {noisy}; law {settings.law}"
        f"{gains}{engine}",
        style="bold",
    )


def print_campaign(done: Campaign, command: Callable[[int], str]) -> None:
    """Print the worst case of each figure, how many runs were good, and the verdict."""
    figures = done.summary(command)
    rows = table("figure", "worst", "in run", "command", left=1)
    rows.columns[3].justify = "left"
    for name, row in figures["worst"].items():
        where = "-" if row["run"] is None else str(row["run"])
        rows.add_row(
            words(name) + _UNITS.get(name, ""), number(row["worst"]), where, row["command"] or ""
        )
    show(rows)
    show(f"good: {figures['good']} of {figures['runs']}, below epsilon: {figures['meets']}")
    if figures["infeasible"]:
        show(
            f"Note: in {figures['infeasible']} no motion was found that leaves a fifth of the "
            "torque limits; these were run without limits",
            style="yellow",
        )
    _print_verdict(done)


def print_one(done: Campaign) -> None:
    """Print the figures of a single run."""
    for record in done.records:
        run = record.run
        show(
            f"Run {run.index}: parameters {run.parameters}, disturbance {run.disturbance}, noise "
            f"{run.noise}, motion {run.motion}, seed {run.seed}"
        )
        rows = table("", "", left=1)
        values = record.to_dict()
        for name in done.summary()["worst"]:
            value = values[name]
            said = ("yes" if value else "no") if isinstance(value, bool) else number(value)
            rows.add_row(words(name) + _UNITS.get(name, ""), said)
        show(rows)
    _print_verdict(done)


def _print_verdict(done: Campaign) -> None:
    show(done.verdict, style="green" if done.ok else "bold red")
