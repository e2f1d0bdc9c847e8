"""An assembled robot as tables for people, in 80 columns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from modrobust.cli.output import console, number, table

if TYPE_CHECKING:
    from rich.table import Table
    from rich.tree import Tree

    from modrobust.dh import DHTable
    from modrobust.report import Masses, Report
    from modrobust.robot import Array, ModuleNode


def print_report(report: Report) -> None:
    """Print the report: modules, D-H table, links, joints, remarks."""
    out = console()
    bodies = sum(len(link.bodies) for link in report.links)
    out.print(
        f"{report.robot}: {len(report.joints)} joints, {bodies} bodies, {_mass(report.total_mass)}",
        style="bold",
        markup=False,
    )
    out.print(f"Reach {number(report.reach)} m, the largest of {report.poses} seeded poses.\n")
    out.print(_modules(report))
    out.print()
    if report.dh is not None:
        out.print(_dh(report, report.dh))
        _print_end(out.print, "base", report.dh.base)
        _print_end(out.print, "tool", report.dh.tool)
    out.print(_links(report))
    out.print(_joints(report))
    for title, lines in (
        ("Exact, without bounds", report.exact),
        ("Not modelled", report.not_modelled),
        ("Remarks", report.notes),
    ):
        if lines:
            out.print(f"{title}:", style="bold")
            for line in lines:
                out.print(f"  {line}", markup=False)


def _mass(mass: Masses) -> str:
    if mass.lo == mass.hi:
        return f"{number(mass.nominal)} kg"
    return f"{number(mass.nominal)} kg in [{number(mass.lo)}, {number(mass.hi)}]"


def _modules(report: Report) -> Tree:
    from rich.markup import escape
    from rich.tree import Tree

    def grow(tree: Tree, nodes: Sequence[ModuleNode]) -> None:
        for node in nodes:
            moved = f", moves {', '.join(node.joints)}" if node.joints else ""
            module = "" if node.module == node.instance else f" ({node.module})"
            grow(tree.add(escape(f"{node.instance}{module}: {node.name}{moved}")), node.children)

    tree = Tree(escape(f"Modules of {report.robot}, from the base"))
    grow(tree, report.modules)
    return tree


def _dh(report: Report, dh: DHTable) -> Table:
    rows = table("joint", "a [m]", "alpha [deg]", "d [m]", "theta [deg]", "")
    rows.title = "Standard D-H table, q added to theta (revolute) or d (prismatic)"
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


def _print_end(write: object, name: str, transform: Array) -> None:
    text = "; ".join(" ".join(number(float(x) + 0.0) for x in row) for row in transform[:3])
    if callable(write):
        write(f"{name} [{text}]", markup=False)


def _links(report: Report) -> Table:
    rows = table("moves with", "bodies", "mass [kg]", "lowest", "highest", left=2)
    rows.title = "Links, their masses and bounds"
    rows.columns[0].overflow = rows.columns[1].overflow = "fold"
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
    rows.title = "Joints: limits, largest static gravity torque found (upper end of hull)"
    rows.columns[0].overflow = "fold"
    for joint in report.joints:
        revolute = joint.type == "revolute"
        position = joint.position
        rows.add_row(
            joint.name,
            "rad, N m" if revolute else "m, N",
            "-" if position is None else f"{position[0]:.3g} to {position[1]:.3g}",
            number(joint.velocity),
            number(joint.effort),
            number(joint.static_torque),
            "-" if joint.share is None else f"{joint.share:.0%}",
        )
    return rows
