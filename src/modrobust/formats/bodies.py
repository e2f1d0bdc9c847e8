"""Bodies of descriptions: mass, COM and tensor, bounded as written and held against physics."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from modrobust.formats.exact import Enclosure
from modrobust.formats.inertia import (
    box_is_physical,
    check_physical,
    largest_principal_moment,
    moved_to_com,
)
from modrobust.formats.nodes import Node, Where
from modrobust.formats.part_models import InertiaModel
from modrobust.formats.quantity import Quantity, Written, parse_vector, parse_written
from modrobust.formats.tolerance import Tolerances
from modrobust.model.symmetric import ENTRIES

_NO_INERTIA = Enclosure(Fraction(0), Fraction(0))

Three = tuple[Quantity, Quantity, Quantity]
Six = tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]

_MOST_MASS = 1e12  # [kg]
_FARTHEST = 1e9  # [m]
_MOST_INERTIA = 1e30  # [kg m^2]


@dataclass(frozen=True)
class Masses:
    """Mass and COM, as written and bounded."""

    mass: Written
    com: tuple[Written, Written, Written]
    bounded_mass: Quantity
    bounded_com: Three


def read_masses(
    mass: Node, com: Node, prefix: str, tolerances: Tolerances, no_mass_is_exact: bool = False
) -> Masses:
    """Mass and COM with their tolerances.

    Args:
        mass: Node of the mass.
        com: Node of the COM.
        prefix: Before the names of the fields.
        tolerances: Bounds where none are written.
        no_mass_is_exact: Whether a mass of 0 takes no tolerance.

    Raises:
        DescriptionError: A mass that is negative, or whose lower bound is.
    """
    written = parse_written(mass, ("mass",), f"{prefix}mass")
    nominal = written.quantity().nominal
    if nominal < 0:
        raise mass.where.error(
            f"{prefix}mass",
            f"{nominal:g} kg is negative; a body's mass is at least 0; write 0 or more",
        )
    exact = no_mass_is_exact and nominal == 0
    bounded = written if exact else tolerances.apply("mass", written, "mass")
    bounded_mass = bounded.quantity()
    if bounded_mass.lo < 0:
        raise mass.where.error(
            f"{prefix}mass",
            f"lower bound {bounded_mass.lo:g} kg is negative; a mass is at least 0; "
            + tolerances.remedy("mass", written),
        )
    x, y, z = vector = parse_vector(com, ("length",), f"{prefix}com")
    bounded_com = (
        tolerances.apply("com", x, "length").quantity(),
        tolerances.apply("com", y, "length").quantity(),
        tolerances.apply("com", z, "length").quantity(),
    )
    _refuse_absurd(mass.where, f"{prefix}mass", "kg", _MOST_MASS, bounded_mass)
    for k, component in enumerate(bounded_com):
        _refuse_absurd(com.where, f"{prefix}com[{k}]", "m", _FARTHEST, component)
    return Masses(written, vector, bounded_mass, bounded_com)


def _refuse_absurd(where: Where, field: str, unit: str, most: float, found: Quantity) -> None:
    """Figures that products of them would make infinite: always a slip in an exponent."""
    value = max(-found.lo, found.hi)
    if value > most:
        raise where.error(
            field,
            f"{value:g} {unit} is beyond {most:g} {unit}; no robot has that; check its exponent",
        )


def read_inertia(
    model: InertiaModel,
    masses: Masses,
    prefix: str,
    tolerances: Tolerances,
    as_written: bool = False,
) -> tuple[Six, bool]:
    """The six tensor entries about their point as written; whether their bounds need no remark.

    The box stays about the frame where the tensor is written so: moved to the COM at nominal mass
    and COM alone it would lack bodies that the written bounds allow. A per cent is of the tensor as
    written. A remark is needed where the nominal tensor is physical and others within are not.

    Args:
        model: Structure of the tensor.
        masses: Mass and COM of the body.
        prefix: Before the names of the fields.
        tolerances: Bounds where none are written.
        as_written: Take a nominal tensor that no rigid body has, as `physical: as-written` does.

    Raises:
        DescriptionError: The nominal tensor belongs to no rigid body and is not taken as written,
            or has a negative principal moment.
    """
    field = f"{prefix}inertia"
    entries = []
    for name in ENTRIES:
        node: Node | None = getattr(model, name)
        if node is None:
            entries.append(Written(_NO_INERTIA, None, None, None, model.where, f"{field}.{name}"))
        else:
            entries.append(parse_written(node, ("inertia",), f"{field}.{name}"))
    framed = model.about == "frame"
    at_com = moved_to_com(entries, masses.mass, masses.com) if framed else entries
    as_written = as_written or model.physical is not None
    physical = check_physical(at_com, masses.mass, model.where, field, framed, as_written)
    largest = largest_principal_moment([entry.nominal.middle for entry in entries])
    xx, xy, xz, yy, yz, zz = (
        tolerances.apply("inertia", entry, "inertia", largest).quantity() for entry in entries
    )
    inertia = (xx, xy, xz, yy, yz, zz)
    for name, entry in zip(ENTRIES, inertia, strict=True):
        _refuse_absurd(model.where, f"{field}.{name}", "kg m^2", _MOST_INERTIA, entry)
    whole = (masses.bounded_mass, *masses.bounded_com) if framed else ()
    return inertia, not physical or box_is_physical(inertia, whole)
