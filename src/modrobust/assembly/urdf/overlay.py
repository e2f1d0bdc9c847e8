"""An overlay to paste into an assembly file: the figures that faults of a URDF leave open."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable

from modrobust.errors import DescriptionError

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_WORDS = {"true", "false", "null", "yes", "no", "on", "off", "y", "n", "none"}
_FIGURES = {
    "mass": "mass: ... kg",
    "com": "com: [... m, ... m, ... m]",
    "inertia": (
        "inertia: {xx: ... kg m^2, yy: ... kg m^2, zz: ... kg m^2, "
        "xy: ... kg m^2, xz: ... kg m^2, yz: ... kg m^2}"
    ),
}


def figures_of(faults: Iterable[DescriptionError], name: str, rotated: bool) -> set[str]:
    """Which of mass, com and inertia of link `name` the faults name.

    Args:
        faults: Of this link, with fields such as ``link arm, inertia.xx``.
        name: The link.
        rotated: Whether its inertial is rotated against it, so that com and inertia go together.
    """
    found = set()
    for fault in faults:
        figure = re.match(r"[a-z]*", fault.field.removeprefix(f"link {name}, "))
        if figure and figure[0] in _FIGURES:
            found.add(figure[0])
    return found | ({"com", "inertia"} if rotated and found & {"com", "inertia"} else set())


def overlay_text(links: dict[str, set[str]], joints: Iterable[str]) -> str:
    """The lines to paste, with ``...`` for each figure to fill in; empty where there is none.

    Args:
        links: Figures that are open, by link.
        joints: Those whose position limits are open.
    """
    lines = []
    open_links = {name: figures for name, figures in links.items() if figures}
    if open_links:
        lines.append("links:")
        for name, figures in open_links.items():
            given = ", ".join(text for key, text in _FIGURES.items() if key in figures)
            lines.append(f"  {_key(name)}: {{{given}}}")
    names = list(dict.fromkeys(joints))
    if names:
        lines.append("joints:")
        lines += [f"  {_key(name)}: {{limits: {{position: [..., ...]}}}}" for name in names]
    if not lines:
        return ""
    return "\n".join(["An assembly file over this URDF can give what is open:", *lines])


def _key(name: str) -> str:
    """A name as a key of YAML."""
    plain = _PLAIN.fullmatch(name) and name.lower() not in _WORDS
    return name if plain else json.dumps(name, ensure_ascii=False)
