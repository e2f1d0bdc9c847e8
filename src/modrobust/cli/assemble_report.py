"""An assembled robot as tables for people, in 80 columns."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from modrobust.cli.output import number, show, table
from modrobust.cli.wording import as_options

if TYPE_CHECKING:
    from rich.table import Table
    from rich.tree import Tree

    from modrobust.assembly.summary import MassFigures, Report
    from modrobust.checks.types import Array
    from modrobust.model import ModuleNode, Robot
    from modrobust.model.dh import DHTable


def print_report(robot: Robot, report: Report) -> None:
    """Print the report: modules, D-H table, links, joints, remarks."""
    from rich.padding import Padding
    from rich.text import Text

    bodies = sum(len(link.bodies) for link in report.links)
    show(
        f"{report.robot}: {len(report.joints)} joints, {bodies} bodies, {_mass(report.total_mass)}",
        style="bold",
    )
    show(f"Reach {number(report.reach)} m, the largest of {report.poses} seeded poses.", "")
    show(*_mounting(robot), _modules(report), "")
    if report.dh is not None:
        show("Standard D-H table, q added to theta (revolute) or d (prismatic)")
        show(_dh(report, report.dh))
        show(_end("D-H base", report.dh.base), _end("D-H tool", report.dh.tool), "")
    show("Links, their masses and bounds", _links(report))
    show("Joints: limits, largest static gravity torque found (upper end of hull)")
    show(_joints(report))
    show(_controller(robot))
    for title, lines in (
        ("Exact, without bounds", report.exact),
        ("Not modelled", report.not_modelled),
        ("Remarks", tuple(map(as_options, report.notes))),
    ):
        if lines:
            show(f"{title}:", *(Padding(Text(line), (0, 0, 0, 2)) for line in lines))


def _controller(robot: Robot) -> str:
    """The law, and the rate that it and its gains need."""
    from modrobust.control import AUTO, needed_rate
    from modrobust.control.rate import hertz
    from modrobust.motion import make_trajectory

    own, loop = robot.controller, robot.loop
    said = f"Controller: law {own.law}, epsilon {own.epsilon:g}; loop at {hertz(loop.rate)}."
    if own.law == AUTO:
        return f"{said} Gains are chosen for box, loop and motion: modrobust design."
    motion = None if robot.trajectory is None else make_trajectory(robot, None)
    need = needed_rate(robot, own, loop, motion)
    if need is None:
        return said
    return f"{said} These gains need about {hertz(need.rate)} (an estimate, no bound)."


def _mounting(robot: Robot) -> list[str]:
    """Where the base stands, where that is not the default, and which way it feels gravity."""
    from modrobust.model.orientation import roll_pitch_yaw

    lines = []
    rotated = robot.base[:3, :3].T @ robot.gravity
    if not np.array_equal(robot.base, np.eye(4)):
        degrees = np.degrees(roll_pitch_yaw(robot.base[:3, :3]))
        place = _row(robot.base[:3, 3])
        lines.append(f"Base in the world: xyz [{place}] m, rpy [{_row(degrees)}] deg.")
    return [*lines, f"Gravity in base axes: [{_row(rotated)}] m/s^2{_along(rotated)}.", ""]


def _along(gravity: Array) -> str:
    """``, along -z`` where gravity lies on an axis to within a degree."""
    k = int(np.argmax(np.abs(gravity)))
    length = float(np.linalg.norm(gravity))
    if not length or abs(gravity[k]) < math.cos(math.radians(1.0)) * length:
        return ""
    return f", along {'-' if gravity[k] < 0.0 else '+'}{'xyz'[k]}"


def _row(values: Iterable[float]) -> str:
    return " ".join(number(round(float(x), 12) + 0.0) for x in values)


def _mass(mass: MassFigures) -> str:
    if mass.lo == mass.hi:
        return f"{number(mass.nominal)} kg"
    return f"{number(mass.nominal)} kg in [{number(mass.lo)}, {number(mass.hi)}]"


def _modules(report: Report) -> Tree:
    from rich.text import Text
    from rich.tree import Tree

    def grow(tree: Tree, nodes: Sequence[ModuleNode]) -> None:
        for node in nodes:
            moved = f", moves {', '.join(node.joints)}" if node.joints else ""
            module = "" if node.module == node.instance else f" ({node.module})"
            grow(tree.add(Text(f"{node.instance}{module}: {node.name}{moved}")), node.children)

    tree = Tree(Text(f"Modules of {report.robot}, from the base"))
    grow(tree, report.modules)
    return tree


def _dh(report: Report, dh: DHTable) -> Table:
    rows = table("joint", "a [m]", "alpha [deg]", "d [m]", "theta [deg]", "")
    for joint, row in zip(report.joints, dh.rows, strict=True):
        rows.add_row(
            joint.name,
            number(row.a),
            number(math.degrees(row.alpha)),
            number(row.d),
            number(math.degrees(row.theta)),
            "near parallel" if row.near_parallel else "",
        )
    return rows


def _end(name: str, transform: Array) -> str:
    return f"{name} [{'; '.join(_row(row) for row in transform[:3])}]"


def _links(report: Report) -> Table:
    rows = table("moves with", "bodies", "mass [kg]", "lowest", "highest", left=2, folded={1})
    for link in report.links:
        mass = link.mass
        rows.add_row(
            link.joint,
            ", ".join(link.bodies) or "-",
            *map(number, (mass.nominal, mass.lo, mass.hi)),
        )
    return rows


def _joints(report: Report) -> Table:
    rows = table("joint", "", "position", "speed", "limit", "static", "share", left=2)
    for joint in report.joints:
        revolute = joint.type != "prismatic"
        position = joint.position
        rows.add_row(
            joint.name,
            "rad, N m" if revolute else "m, N",
            "-" if position is None else f"{position[0]:.3g} to {position[1]:.3g}",
            number(joint.velocity),
            number(joint.effort),
            number(round(joint.static_torque, 9)),  # what rounding leaves is not a torque
            "-" if joint.share is None else f"{joint.share:.0%}",
        )
    return rows
