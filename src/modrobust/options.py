"""What is said on the command line, or as keywords, about a robot: laid over its description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from modrobust.errors import ValueRangeError
from modrobust.formats import Assembly, Controller, MapNode, ScalarNode, Where
from modrobust.formats.assembly import GRAVITY, read_payload
from modrobust.formats.fields import check
from modrobust.formats.given import given_mapping
from modrobust.formats.models import PayloadModel
from modrobust.formats.module import ModuleFields
from modrobust.formats.overlay import UrdfSource
from modrobust.formats.part_models import ToleranceModel
from modrobust.geometry import IDENTITY

_INSTEAD = {
    "base": "leave it out",
    "tip": "shorten the chain in the file",
    "lock": "replace the module of the joint in the file",
    "tolerance": "write the tolerance in the module files",
}
_EXAMPLES = {
    "tolerance": 'such as "mass=5%,com=5mm,inertia=10%" or {"mass": "5%", "com": "5 mm"}',
    "payload": 'such as "mass=[0 kg, 2 kg], com=[0, 0, 50 mm]" or the same as a mapping',
    "lock": 'such as {"finger": 0.02}, or "30 deg" as its value',
}


def urdf_assembly(path: Path) -> Assembly:
    """The description that a URDF alone is: no bounds, no payload, everything else default."""
    where = Where(str(path), 1)
    return Assembly(
        name="",  # the URDF's own
        file=path,
        modules=(),
        base=IDENTITY,
        gravity=GRAVITY,
        chain=(),
        payload=None,
        disturbance=None,
        controller=Controller(),
        trajectory=None,
        initial_q=None,
        initial_dq=None,
        scenarios={},
        where=where,
        urdf=UrdfSource(str(path), where),
    )


def with_options(
    description: Assembly,
    base: str | None,
    tip: str | None,
    lock: Mapping[str, float | str],
    tolerance: str | Mapping[str, object] | None,
    payload: str | Mapping[str, object] | None,
) -> Assembly:
    """The description with options laid over it; an option counts more than the file.

    Raises:
        ValueRangeError: An option is not of its form, or fits no robot of modules.
        DescriptionError: An option says something that it must not.
    """
    if payload is not None:
        description = _with_payload(description, payload)
    given = {"base": base, "tip": tip, "lock": lock or None, "tolerance": tolerance}
    used = [name for name, value in given.items() if value is not None]
    if not used:
        return description
    source = description.urdf
    if source is None:
        raise ValueRangeError(
            f"{used[0]}: a robot of modules; this option is for robots that a URDF describes; "
            + _INSTEAD[used[0]]
        )
    if base is not None:
        source = replace(source, base_link=ScalarNode(base, Where("base", None)))
    if tip is not None:
        source = replace(source, tip_link=ScalarNode(tip, Where("tip", None)))
    if lock:
        nodes = given_mapping(lock, "lock", _EXAMPLES["lock"]).entries
        source = replace(source, lock={**source.lock, **nodes})
    if tolerance is not None:
        node = given_mapping(tolerance, "tolerance", _EXAMPLES["tolerance"])
        model = check(ToleranceModel, node, _name_tolerance)
        source = replace(source, tolerance=model)
    return replace(description, urdf=source)


def _name_tolerance(location: tuple[int | str, ...]) -> str:
    return ".".join(["tolerance", *(str(step) for step in location)])


def _with_payload(description: Assembly, given: str | Mapping[str, object]) -> Assembly:
    node = given_mapping(given, "payload", _EXAMPLES["payload"])
    fields = ModuleFields(MapNode({"payload": node}, node.where))
    model = check(PayloadModel, node, lambda location: fields.name(("payload", *location)))
    notes: list[str] = []
    payload = read_payload(model, notes)
    return replace(description, payload=payload, notes=(*description.notes, *notes))
