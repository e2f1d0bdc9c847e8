"""Bodies of descriptions: mass, COM and tensor about the COM, bounded and held against physics."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from modrobust.formats.exact import Enclosure
from modrobust.formats.inertia import (
    ENTRIES,
    box_is_physical,
    check_physical,
    largest_principal_moment,
    moved_to_com,
)
from modrobust.formats.nodes import Node
from modrobust.formats.part_models import InertiaModel
from modrobust.formats.quantity import Quantity, Written, parse_vector, parse_written
from modrobust.formats.tolerance import Tolerances

_NO_INERTIA = Enclosure(Fraction(0), Fraction(0))

Three = tuple[Quantity, Quantity, Quantity]
Six = tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]


@dataclass(frozen=True)
class Masses:
    """Mass and COM, as written and bounded."""

    mass: Written
    com: tuple[Written, Written, Written]
    bounded_mass: Quantity
    bounded_com: Three


def read_masses(mass: Node, com: Node, prefix: str, tolerances: Tolerances) -> Masses:
    """Mass and COM with their tolerances.

    Raises:
        DescriptionError: A mass that is not positive, or whose lower bound is negative.
    """
    written = parse_written(mass, ("mass",), f"{prefix}mass")
    nominal = written.quantity().nominal
    if nominal <= 0:
        raise mass.where.error(
            f"{prefix}mass", f"{nominal:g} kg is not positive; a body's mass is above 0; correct it"
        )
    bounded = tolerances.apply("mass", written, "mass")
    bounded_mass = bounded.quantity()
    if bounded_mass.lo < 0:
        raise mass.where.error(
            f"{prefix}mass",
            f"lower bound {bounded_mass.lo:g} kg is negative; a mass is at least 0; "
            "narrow the bounds",
        )
    x, y, z = vector = parse_vector(com, ("length",), f"{prefix}com")
    bounded_com = (
        tolerances.apply("com", x, "length").quantity(),
        tolerances.apply("com", y, "length").quantity(),
        tolerances.apply("com", z, "length").quantity(),
    )
    return Masses(written, vector, bounded_mass, bounded_com)


def read_inertia(
    model: InertiaModel, masses: Masses, prefix: str, tolerances: Tolerances
) -> tuple[Six, bool]:
    """The six tensor entries about the COM, and whether all tensors in the bounds are physical.

    Raises:
        DescriptionError: The nominal tensor belongs to no rigid body.
    """
    field = f"{prefix}inertia"
    entries = []
    for name in ENTRIES:
        node: Node | None = getattr(model, name)
        if node is None:
            entries.append(Written(_NO_INERTIA, None, None, None, model.where, f"{field}.{name}"))
        else:
            entries.append(parse_written(node, ("inertia",), f"{field}.{name}"))
    moved = model.about == "frame"
    if moved:
        entries = moved_to_com(entries, masses.mass, masses.com)
    check_physical(entries, model.where, field, moved)
    largest = largest_principal_moment([entry.nominal.middle for entry in entries])
    xx, xy, xz, yy, yz, zz = (
        tolerances.apply("inertia", entry, "inertia", largest).quantity() for entry in entries
    )
    inertia = (xx, xy, xz, yy, yz, zz)
    return inertia, box_is_physical(inertia)
