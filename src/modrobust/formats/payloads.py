"""The ``payload:`` of an assembly file, or the several of ``payloads:`` with the box of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from modrobust.formats.bodies import read_inertia, read_masses
from modrobust.formats.faults import Faults
from modrobust.formats.fields import Part, Taken, Text, Value, Vector, refuse
from modrobust.formats.inertia import box_body, box_is_physical
from modrobust.formats.items import Payload
from modrobust.formats.nodes import MapNode, Node, ScalarNode, Where, kind_of
from modrobust.formats.part_models import InertiaModel
from modrobust.formats.quantity import Quantity, parse_vector
from modrobust.formats.tolerance import Tolerances

_ZERO = Quantity(0.0, 0.0, 0.0, bounded=False)
_NOTHING = "none"


class PayloadModel(Part):
    """The body in the end frame of an instance."""

    at: Text | None = Field(None, description="Instance, default the last")
    mass: Value = Field(description="Mass [kg]")
    com: Vector = Field(description="Centre of mass [m] in the end frame")
    inertia: InertiaModel | None = Field(None, description="Inertia tensor [kg m^2]")
    size: Vector | None = Field(None, description="Edges of a homogeneous box [m]")


def _nothing(node: Node) -> str:
    if isinstance(node, ScalarNode) and node.text == _NOTHING:
        return _NOTHING
    raise refuse(
        node.where,
        f"{kind_of(node)}; a payload is none or a mapping with mass and com; write one of them",
    )


def _kind(node: Any) -> str:
    return "<payload>" if isinstance(node, MapNode) else "<nothing>"


PayloadEntry = Annotated[
    Annotated[Annotated[str, Taken({"enum": [_NOTHING]}, _nothing)], Tag("<nothing>")]
    | Annotated[PayloadModel, Tag("<payload>")],
    Discriminator(_kind),
]


def read_payload(model: PayloadModel, notes: list[str], field: str = "payload") -> Payload:
    """The payload; what it says of its bounds is added to `notes`.

    Raises:
        DescriptionError: Figures that no body has.
    """
    tolerances = Tolerances(None)
    masses = read_masses(model.mass, model.com, f"{field}.", tolerances)
    if model.inertia is not None and model.size is not None:
        raise model.where.error(
            field, "inertia and size; a payload has one of them; remove the other"
        )
    inertia = (_ZERO,) * 6
    physical = True
    if model.inertia is not None:
        inertia, physical = read_inertia(model.inertia, masses, f"{field}.", tolerances)
    elif model.size is not None:
        size = parse_vector(model.size, ("length",), f"{field}.size")
        for edge in size:
            if edge.ends()[0].middle <= 0:
                raise edge.where.error(
                    edge.field,
                    f"{float(edge.ends()[0].middle):g} m is not positive; the edge of a box is "
                    "above 0, its lower bound too; write a positive length",
                )
        entries = box_body(masses.mass, size, model.size.where, f"{field}.size")
        xx, xy, xz, yy, yz, zz = (entry.quantity() for entry in entries)
        inertia = (xx, xy, xz, yy, yz, zz)
        physical = box_is_physical(inertia)
    if not physical:
        notes.append(f"{field}: the bounds of its inertia also hold tensors that no rigid body has")
    return Payload(
        at=model.at,
        mass=masses.bounded_mass,
        com=masses.bounded_com,
        inertia=inertia,
        inertia_about=(model.inertia.about if model.inertia is not None else None) or "com",
        assumed_point=model.inertia is None and model.size is None and masses.bounded_mass.hi > 0,
        where=model.where,
    )


def read_payloads(
    entries: Mapping[str, str | PayloadModel], node: MapNode, notes: list[str]
) -> tuple[Payload, dict[str, Payload]]:
    """The box that holds all the payloads, and each of them, carried at one place.

    Args:
        entries: What is written, by name; "none" is no body.
        node: The mapping that they stand in.
        notes: Takes what the payloads say of their bounds.

    Raises:
        DescriptionError: Figures that no body has, or payloads that are no figures of one body.
    """
    if not entries:
        raise node.where.error("payloads", "nothing; payloads have names; write name: {mass, com}")
    faults = Faults()
    bodies: dict[str, Payload] = {}
    for name, entry in entries.items():
        with faults.caught():
            bodies[name] = (
                _empty(node.entries[name].where)
                if isinstance(entry, str)
                else read_payload(entry, notes, _field(name))
            )
    faults.stop()
    at = _agreed(bodies, "at", {name: body.at for name, body in bodies.items()}, node)
    some = {name: body for name, body in bodies.items() if not _weightless(body)}
    about = _agreed(
        bodies, "inertia.about", {name: body.inertia_about for name, body in some.items()}, node
    )
    box = replace(
        _box(list(some.values()), list(bodies.values()), node.where),
        at=at,
        inertia_about=about or "com",
    )
    # The centre of mass of a body without mass is nowhere: it widens no box.
    x, y, z = (Quantity(c.nominal, c.nominal, c.nominal, bounded=False) for c in box.com)
    named = {
        name: replace(
            body,
            at=at,
            inertia_about=box.inertia_about,
            com=body.com if name in some else (x, y, z),
        )
        for name, body in bodies.items()
    }
    return box, named


def _field(name: str) -> str:
    return f"payloads.{name[:80]}"


def _empty(where: Where) -> Payload:
    return Payload(None, _ZERO, (_ZERO,) * 3, (_ZERO,) * 6, "com", False, where)


def _weightless(body: Payload) -> bool:
    return body.mass.hi == 0.0 and all(entry.lo == entry.hi == 0.0 for entry in body.inertia)


def _agreed(
    bodies: Mapping[str, Payload], key: str, found: Mapping[str, str | None], node: MapNode
) -> str | None:
    """What all those that say it say alike."""
    first: tuple[str, str] | None = None
    for name, value in found.items():
        if value is None:
            continue
        if first is not None and value != first[1]:
            raise bodies[name].where.error(
                f"{_field(name)}.{key}",
                f'"{value}" where payload {first[0][:80]} has "{first[1]}"; payloads are figures '
                "of one body at one place; write the same in all",
            )
        first = first or (name, value)
    return None if first is None else first[1]


def _box(some: Sequence[Payload], bodies: Sequence[Payload], where: Where) -> Payload:
    """The hull of the boxes; nominal is the lightest and the heaviest one, half and half.

    A mixture of bodies is a body, so that the nominal one is physical as they are.
    """
    light = min(bodies, key=lambda body: body.mass.nominal)
    heavy = max(bodies, key=lambda body: body.mass.nominal)
    total = light.mass.nominal + heavy.mass.nominal
    share = 0.5 if total == 0.0 else heavy.mass.nominal / total

    def hull(parts: Sequence[Quantity], nominal: float) -> Quantity:
        lo, hi = min(q.lo for q in parts), max(q.hi for q in parts)
        bounded = lo < hi or any(q.bounded for q in parts)
        return Quantity(min(max(nominal, lo), hi), lo, hi, bounded)

    def com(k: int) -> Quantity:
        nominal = (1.0 - share) * light.com[k].nominal + share * heavy.com[k].nominal
        return hull([body.com[k] for body in some or bodies], nominal)

    def inertia(k: int) -> Quantity:
        nominal = 0.5 * light.inertia[k].nominal + 0.5 * heavy.inertia[k].nominal
        return hull([body.inertia[k] for body in bodies], nominal)

    return Payload(
        at=None,
        mass=hull([body.mass for body in bodies], 0.5 * total),
        com=(com(0), com(1), com(2)),
        inertia=(inertia(0), inertia(1), inertia(2), inertia(3), inertia(4), inertia(5)),
        inertia_about="com",
        assumed_point=False,
        where=where,
    )
