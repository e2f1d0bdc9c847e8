"""The sentence that a run ends in: what was shown, and in which run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from modrobust.cli.output import show

if TYPE_CHECKING:
    from modrobust.model import Robot

PASS, FAIL, NEITHER = "PASS", "FAIL", "exact"
SHOWN = "bound kept, error permanently within epsilon, torques within limits"
SHOWN_SHORT = "bound kept, torques within limits"


def print_verdict(robot: Robot, figures: Mapping[str, Any]) -> None:
    """Print the verdict on `SimulationResult.summary`, then what it does not judge.

    A robot with nothing uncertain earns no praise: there was nothing to be robust against.
    """
    reasons, broken = figures["reasons"], figures["divergence"]
    settings, short = figures["settings"], figures["cut_short"]
    if short and broken is None:
        show(
            f"Cut short: {settings['duration']:g} s of a motion of {settings['motion_time']:g} s; "
            "whether the error stays below epsilon is not judged",
            style="yellow",
        )
    if broken is not None:
        show(f"{FAIL}: the loop diverged at {figures['time']:.6g} s", style="bold red")
        show(f"Cause: {broken['cause']}", f"What helps: {broken['remedy']}")
        return
    if reasons:
        show(*(f"{FAIL}: {reason}" for reason in reasons), style="bold red")
    elif not figures["uncertain"]:
        show(f"{NEITHER}: robust against nothing; {bounds_remedy(robot)}", style="yellow")
    else:
        shown = SHOWN_SHORT if short else SHOWN
        show(f"{PASS}: {shown}, in this one run ({truth(settings)})", style="green")
    opening = "Also" if reasons else "Note"
    show(*(f"{opening}: {remark}" for remark in figures["remarks"]), style="yellow")


def truth(settings: Mapping[str, Any]) -> str:
    """Which robot the plant was."""
    if settings["scenario"] is not None:
        return f"scenario {settings['scenario']}"
    seeded = settings["parameters"] in ("corner", "random")
    return f"parameters {settings['parameters']}" + (f", seed {settings['seed']}" if seeded else "")


def bounds_remedy(robot: Robot) -> str:
    """How a robot gets bounds."""
    if any(node.module == "urdf" for node in robot.modules):
        return 'give --tolerance, such as "mass=5%,com=5mm,inertia=10%", or bounds in a file'
    return "give bounds or a tolerance in the module files, see docs/reference/formats.md"
