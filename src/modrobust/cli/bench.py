"""``modrobust bench``: time, growth and tightness, as in Section V of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from modrobust.cli.options import (
    Base,
    Drive,
    Gravity,
    Json,
    Lock,
    Mount,
    Package,
    Payload,
    Tip,
    Tolerance,
    Xacro,
    robot,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.table import Table

    from modrobust.model import Robot

EXAMPLES = """\b
Examples:
  modrobust bench
  modrobust bench lwa4p my-robot.yaml --repeat 10
  modrobust bench lwa4p-paper --json
  modrobust bench --growth
  modrobust bench --peers

Ctrl-C ends early: what was measured is shown, the exit code is 130.
The exit code is 1 when the loop of a robot diverges: there is nothing to measure then.
"""


_WIDTHS = (
    *("width_found", "width_hull", "width_ianea"),
    *("hull_over_found", "ianea_over_hull", "ianea_over_hull_median"),
)


def bench(
    files: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FILE", help="Assembly files, URDFs or built-in names. [lwa4p-paper]"
        ),
    ] = None,
    repeat: Annotated[int, typer.Option(min=1, help="How often each time is taken.")] = 3,
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
    growth: Annotated[
        bool, typer.Option("--growth", help="Also synthetic chains of 2 to 256 joints.")
    ] = False,
    peers: Annotated[
        bool, typer.Option("--peers", help="Only times, beside those of other libraries.")
    ] = False,
    json: Json = False,
) -> None:
    """Measure the time of a command and how tight the bounds are.

    The controller is replayed on the signals of a simulation sampled at 1 ms. Tightness: mean
    width of the bound by either kind, and of the range that a search of the parameters finds.
    With --growth also the time against the number of joints.
    """
    from modrobust.bench.benchmark import SIZES, benchmark
    from modrobust.cli.output import ProgressBar, note, print_json

    options = (base, tip, lock, tolerance, payload, mount, gravity, xacro, package)
    robots = [robot(file, *options, drive=drive) for file in files or ["lwa4p-paper"]]
    if peers:
        compare(robots, json)
        return
    if not json:
        _heading(robots[0].name, robots[0].n)  # at once: the figures take a while
    with ProgressBar("Measuring") as bar:
        result = benchmark(
            robots,
            repeat=repeat,
            sizes=SIZES if growth else (),
            progress=lambda what, done: bar(done, label=what),
        )
    figures = result.to_dict()
    if json:
        print_json(figures)
    else:
        print_benchmark(figures)
    if result.interrupted:
        note("interrupted; what was measured until then is kept")
        raise typer.Exit(130)
    diverged = [item.run for item in result.robots if item.run is not None and item.run.diverged]
    for run in diverged:
        reason = next(reason for reason in run.reasons if "diverged" in reason)
        note(f"{run.robot.name}: {reason}; nothing of it is measured")
    if diverged:
        raise typer.Exit(1)


def compare(robots: list[Robot], json: bool) -> None:
    """Compare with the libraries that are installed; say which are not."""
    from modrobust.bench.peers import compare_with_peers
    from modrobust.cli.bench_peers import print_peers
    from modrobust.cli.output import note, print_json

    reports = []
    for item in robots:
        reports.append(compare_with_peers(item, announce=note))
        if reports[-1].interrupted:
            break
    if json:
        print_json([report.to_dict() for report in reports])
    else:
        for report in reports:
            print_peers(report.to_dict())
    for sentence in dict.fromkeys(s for report in reports for s in report.absent.values()):
        note(sentence)
    if reports[-1].interrupted:
        note("interrupted; what was measured until then is kept")
        raise typer.Exit(130)


def print_benchmark(figures: Mapping[str, Any]) -> None:
    """Print the benchmark as tables, under the heading of its first robot."""
    from modrobust.cli.output import number, show, table, times

    for k, entry in enumerate(figures["robots"]):
        if k > 0:
            _heading(entry["robot"], len(entry["joints"]))
        measured = {}
        for item in entry["times"]:
            measured[f"{item['bound']}, in C"] = item["in_c"]
            measured[f"{item['bound']}, from Python"] = item["in_python"]
        if measured:
            show("Time per command", times(measured, entry["robot"]))
        if entry["laws"]:
            show("Time per command of each law, in C", times(entry["laws"], entry["robot"]))
        for item in entry["tightness"]:
            rows = table("joint", *map(_header, _WIDTHS))
            for j, name in enumerate(entry["joints"]):
                rows.add_row(name, *(number(item[key][j]) for key in _WIDTHS))
            show(f"Mean width of [Φ], {item['where']}", rows)
    if figures["growth"]:
        show("Time per command in C, synthetic chains, every body uncertain")
        show(_growth(figures["growth"]))


def _heading(name: str, joints: int) -> None:
    from modrobust.cli.output import show

    show(f"{name}: {joints} joints", style="bold")


def _header(key: str) -> str:
    """The words of a key, less what the title and the column before say."""
    from modrobust.cli.output import words

    return words(key).removeprefix("width ").removeprefix("ianea/hull ")


def _growth(growth: list[Any]) -> Table:
    from modrobust.cli.output import microseconds, number, table

    rows = table("joints", *(item["bound"] for item in growth))
    for k, joints in enumerate(growth[0]["joints"]):
        rows.add_row(
            str(joints),
            *(
                microseconds(item["seconds"][k]) if k < len(item["seconds"]) else "-"
                for item in growth
            ),
        )
    rows.add_section()
    rows.add_row(
        f"exponent, from {growth[0]['fitted_from']} joints",
        *(number(item["exponent"]) for item in growth),
    )
    return rows


command = bench
