"""A design as tables for people, in 80 columns."""

from __future__ import annotations

from typing import TYPE_CHECKING

from modrobust.cli.output import number, position_unit, show, table

if TYPE_CHECKING:
    from rich.table import Table

    from modrobust.design import Design, Help
    from modrobust.model import LoopSettings
    from modrobust.simulation.margin import Margin

_BOUNDS = {
    "stability": "rate and delay allow",
    "noise": "noise and torque limits allow",
    "epsilon": "epsilon asks for",
}
_CAUSES = {
    "parameters": "masses, COMs, tensors, rotors",
    "friction": "friction, viscous and Coulomb",
    "disturbance": "the disturbance [d]",
    "noise": "noise through the gains",
    "hold": "the command is held",
    "delay": "the command is late",
}


def print_design(found: Design) -> None:
    """Print gains, what bounds them, the error to expect, and what would help."""
    s = found.settings
    show(f"{found.robot.name}: gains for {_loop(found.loop)}", style="bold")
    show(f"Motion: {found.motion}.")
    show(*(f"Note: {remark}." for remark in found.remarks[:1] if "norms over" in remark))
    show("")
    show("Gains of the law sampled", _gains(found))
    show("What bounds G", _bounds(found))
    show(
        f"Error to expect, a norm over the joints [{_unit(found)}]: an estimate, no bound",
        _expected(found),
    )
    show(
        f"The robot against the model (estimates): M^-1 M_s from {number(found.spectra.light[0])} "
        f"to {number(found.spectra.light[1])}, M^-1 M_c from {number(found.spectra.centre[0])} to "
        f"{number(found.spectra.centre[1])}.",
        f"What is unknown pushes with up to b = {number(found.need.total)} {_acceleration(found)}, "
        "a reserve of 2 included.",
    )
    others = [remark for remark in found.remarks if "norms over" not in remark]
    show(*(f"Note: {remark}" for remark in others), style="yellow")
    if found.reachable:
        show(f"Epsilon {s.epsilon:g} {_unit(found)} can be met in this loop, by these estimates")
    else:
        show("", "What would help, each alone: the least epsilon that could then be met")
        show(_helps(found.helps, found))


def print_margin(margin: Margin) -> None:
    """Print how far the gains can be raised."""
    if margin.beyond is None:
        said = f"no run failed up to {margin.factor:g} times the gains"
    elif margin.factor == 0.0:
        said = f"a run fails at these gains ({margin.case}): {margin.reason}"
    else:
        said = (
            f"{margin.factor:.2g} times the gains; at {margin.beyond:.2g} times a run fails "
            f"({margin.case}): {margin.reason}"
        )
    show("", f"Margin: {said}. {margin.runs} runs, tried, not proved.")


def _loop(loop: LoopSettings) -> str:
    late = f", {loop.delay:g} period{'s' * (loop.delay != 1.0)} late" if loop.delay else ""
    said = [f"a command every {1e3 / loop.rate:.4g} ms ({loop.rate / 1e3:g} kHz){late}"]
    position, velocity = (
        max(loop.noise_position, default=0.0),
        max(loop.noise_velocity, default=0.0),
    )
    if position or velocity:
        said.append(f"noise up to {position:g} and {velocity:g} per s")
    if loop.quantisation_position or loop.quantisation_velocity:
        said.append("quantised sensors")
    if loop.velocity == "differentiated":
        said.append(f"velocity differentiated, filter {loop.filter:g} Hz")
    return "; ".join(said)


def _gains(found: Design) -> Table:
    s = found.settings
    rows = table("", "", "", left=3, folded={2})
    for name, value, meaning in (
        ("G", f"{s.G:g} /s", "feedback: K_d = 3/2 G, K_p = G^2/2, times M_s"),
        ("Lambda", f"{s.Lambda:g} /s", "G/2: how fast a small error dies out"),
        ("L_i", f"{s.L_i:g} /s^2", "integral, clipped to [Φ]"),
        ("blend", f"{s.blend:g} s", "from the measured start to the motion"),
        ("epsilon", f"{s.epsilon:g} {_unit(found)}", "what the gains are to meet"),
    ):
        rows.add_row(name, value, meaning)
    return rows


def _bounds(found: Design) -> Table:
    rows = table("", "G", "", left=1, folded={2})
    rows.columns[2].justify = "left"
    values = {"stability": found.G_stab, "noise": found.G_noise, "epsilon": found.G_eps}
    for name, text in _BOUNDS.items():
        value = values[name]
        shown = f"{value:.3g} /s" if value < float("inf") else "no limit"
        rows.add_row(text, shown, "<- binds" if found.binding == name else "")
    if found.binding == "floor":
        rows.add_row("the least that is used", "20 /s", "<- binds")
    return rows


def _expected(found: Design) -> Table:
    rows = table("", "error", "share")
    total = found.error
    for cause, value in sorted(found.expected.items(), key=lambda item: -item[1]):
        if value > 0.0:
            rows.add_row(_CAUSES[cause], number(value), f"{value / total:.0%}")
    rows.add_row("sum", number(total), "")
    return rows


def _helps(helps: tuple[Help, ...], found: Design) -> Table:
    rows = table("change", "epsilon", "G", folded={0})
    for item in helps:
        rows.add_row(item.change, number(item.epsilon), f"{item.G:.3g} /s")
    rows.add_row("as it is", number(found.epsilon_reached), f"{found.choice.limit:.3g} /s")
    return rows


def _unit(found: Design) -> str:
    return position_unit(found.robot)


def _acceleration(found: Design) -> str:
    unit = _unit(found)
    return f"({unit})/s^2" if " " in unit else f"{unit}/s^2"
