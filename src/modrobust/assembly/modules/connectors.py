"""Which connectors go together, and at which mounting angles.

An ``in`` mounts on an ``out`` of the same type and the same size when the genders are m and f, in
either order, or both n. A connector with a clocking takes mounts that are multiples of it only.
"""

from __future__ import annotations

import math

from modrobust.formats import Connector

RULE = "compatible connectors have the same type, the same size, and genders m and f or n and n"

_STEP_TOLERANCE = 1e-9  # [rad]


def describe(connector: Connector) -> str:
    """The connector in words, e.g. "schunk-pb, size 1, gender m"."""
    size = "" if connector.size is None else f", size {connector.size}"
    return f"{connector.type}{size}, gender {connector.gender}"


def incompatibility(out: Connector, into: Connector) -> str | None:
    """Why an ``in`` does not mount on an ``out``; None when it does."""
    if out.type != into.type:
        return "the types differ"
    if out.size != into.size:
        return "the sizes differ"
    if sorted((out.gender, into.gender)) not in (["f", "m"], ["n", "n"]):
        return "the genders do not fit"
    return None


def clocking_problem(out: Connector, into: Connector, mount: float) -> str | None:
    """Why a mounting angle [rad] is not allowed between two connectors; None when it is."""
    for side, connector in (("out", out), ("in", into)):
        step = connector.clocking
        if step is not None and abs(math.remainder(mount, step)) > _STEP_TOLERANCE:
            return (
                f"{_degrees(mount)} is not a multiple of {_degrees(step)}, "
                f"the clocking of the {side} connector"
            )
    return None


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.6g} deg"
