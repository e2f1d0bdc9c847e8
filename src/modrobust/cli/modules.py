"""``modrobust modules``: the catalogue and which module mounts on which."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from modrobust.cli.options import Json

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from modrobust.formats import Connector, Module

EXAMPLES = """\b
Examples:
  modrobust modules
  modrobust modules my-modules/
  modrobust modules --json
"""


def modules(
    directories: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="DIRECTORY",
            help="Directories with module files. Default: the built-in catalogue.",
        ),
    ] = None,
    json: Json = False,
) -> None:
    """List the modules and what can be mounted on each."""
    from modrobust.assembly.modules.catalogue import catalogue, mounts
    from modrobust.cli.output import print_json

    found = catalogue(directories or None)
    mounted = mounts(found)
    if json:
        print_json([_plain(module, mounted[module.id]) for module in found])
    else:
        print_modules(found, mounted)


def print_modules(found: Sequence[Module], mounted: Mapping[str, Sequence[str]]) -> None:
    """Print the modules, then who goes onto whom, modules with the same answer together."""
    from modrobust.cli.output import show, table

    rows = table("module", "joints", "name", left=3, folded={2})
    for module in found:
        rows.add_row(module.id, str(len(_joints(module))), module.name)
    real = sum(module.product for module in found)
    show(f"{len(found)} modules, {real} of them products", style="bold")
    show(rows)
    groups: dict[tuple[str, ...], list[str]] = {}
    for module in found:
        if mounted[module.id]:
            groups.setdefault(tuple(mounted[module.id]), []).append(module.id)
    onto = table("module", "mounts", left=2, folded={0, 1})
    onto.show_lines = True
    for above, below in groups.items():
        onto.add_row(", ".join(below), ", ".join(above))
    show("Connector compatibility: base side (out), and what mounts on it (in)", style="bold")
    show(onto)


def _plain(module: Module, mounted: Sequence[str]) -> dict[str, Any]:
    return {
        "module": module.id,
        "name": module.name,
        "product": module.product,
        "source": list(module.source),
        "licence": module.licence,
        "joints": _joints(module),
        "in": _connector(module.connector_in),
        "out": _connector(module.connector_out),
        "mounts": list(mounted),
    }


def _joints(module: Module) -> list[dict[str, str]]:
    from modrobust.formats import JointItem

    return [
        {"name": item.name, "type": item.type}
        for item in module.items
        if isinstance(item, JointItem)
    ]


def _connector(connector: Connector | None) -> dict[str, Any] | None:
    if connector is None:
        return None
    return {
        "type": connector.type,
        "size": connector.size,
        "gender": connector.gender,
        "clocking": connector.clocking,
    }


command = modules
