"""Command-line and keyword overrides of a description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from reprlib import repr as short

from modrobust.errors import ValueRangeError
from modrobust.formats import Assembly, Controller, ListNode, MapNode, ScalarNode, Where
from modrobust.formats.assembly import (
    GRAVITY,
    package_folders,
    read_gravity,
    xacro_arguments,
)
from modrobust.formats.fields import check
from modrobust.formats.given import given_mapping
from modrobust.formats.joints import drive_figures
from modrobust.formats.module import ModuleFields
from modrobust.formats.overlay import UrdfSource
from modrobust.formats.part_models import DriveOptionModel, ToleranceModel
from modrobust.formats.payloads import PayloadModel, read_payload
from modrobust.formats.span import pose_matrix
from modrobust.model.geometry import IDENTITY, Transform, translation

_INSTEAD = {
    "base": "leave it out",
    "tip": "shorten the chain in the file",
    "lock": "replace the module of the joint in the file",
    "tolerance": "write the tolerance in the module files",
    "drive": "write drive and friction in the module files",
    "xacro": "leave it out",
    "packages": "leave it out",
}
_EXAMPLES = {
    "tolerance": 'such as "mass=5%,com=5mm,inertia=10%" or {"mass": "5%", "com": "5 mm"}',
    "drive": 'such as "rotor_inertia=1e-5 kg m^2 ± 20%, gear_ratio=100" or the same as a mapping',
    "payload": 'such as "mass=[0 kg, 2 kg], com=[0, 0, 50 mm]" or the same as a mapping',
    "lock": 'such as {"finger": 0.02}, or "30 deg" as its value',
}

Vector = str | Sequence[float | str]


def urdf_assembly(path: Path | str) -> Assembly:
    """The description that a URDF alone is: no bounds, no payload, everything else default."""
    where = Where(str(path), 1)
    return Assembly(
        name="",  # the URDF's own
        file=Path(path),
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
    mount: Vector | None = None,
    gravity: Vector | None = None,
    xacro: Mapping[str, object] | None = None,
    packages: Mapping[str, str | Path] | None = None,
    drive: str | Mapping[str, object] | None = None,
) -> Assembly:
    """The description with options laid over it; an option counts more than the file.

    Raises:
        ValueRangeError: An option is not of its form, or fits no robot of modules.
        DescriptionError: An option says something that it must not.
    """
    if payload is not None:
        description = _with_payload(description, payload)
    if mount is not None:
        description = replace(description, base=_mounted(description.base, mount))
    if gravity is not None:
        description = replace(description, gravity=read_gravity(_vector(gravity, "gravity")))
    given = {
        "base": base,
        "tip": tip,
        "lock": lock or None,
        "tolerance": tolerance,
        "drive": drive,
        "xacro": xacro or None,
        "packages": packages or None,
    }
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
    if drive is not None:
        node = given_mapping(drive, "drive", _EXAMPLES["drive"])
        source = replace(source, drive=drive_figures(check(DriveOptionModel, node, _name_drive)))
    if xacro:
        place = Where("xacro", None)
        texts = {name: ScalarNode(str(value), place) for name, value in xacro.items()}
        source = replace(source, xacro={**source.xacro, **xacro_arguments(texts)})
    if packages:
        paths = {name: str(path) for name, path in packages.items()}
        folders = package_folders(paths, Path(), Where("packages", None))
        source = replace(source, packages={**source.packages, **folders})
    return replace(description, urdf=source)


def _mounted(base: Transform, mount: Vector) -> Transform:
    """The base where it is, rotated in the world by roll, pitch and yaw [rad]."""
    rpy = pose_matrix(None, _vector(mount, "mount"), "mount")
    return translation([row[3] for row in base.rows]) @ rpy


def _vector(given: Vector, name: str) -> ListNode:
    """Three numbers: a sequence, or a text with commas or blanks between them."""
    if isinstance(given, str):
        inside = given.strip().removeprefix("[").removesuffix("]")
        parts: Sequence[object] = inside.split(",") if "," in inside else inside.split()
    else:
        parts = list(given)
    where = Where(name, None)
    if len(parts) != 3:
        raise ValueRangeError(
            f"{name}: {len(parts)} entries in {short(given)}; it is a vector of three; write e.g. "
            '"0, 90 deg, 0" (with commas where there are units)'
        )
    return ListNode(tuple(ScalarNode(str(part).strip(), where) for part in parts), where)


def _name_tolerance(location: tuple[int | str, ...]) -> str:
    return ".".join(["tolerance", *(str(step) for step in location)])


def _name_drive(location: tuple[int | str, ...]) -> str:
    return ".".join(["drive", *(str(step) for step in location)])


def _with_payload(description: Assembly, given: str | Mapping[str, object]) -> Assembly:
    node = given_mapping(given, "payload", _EXAMPLES["payload"])
    fields = ModuleFields(MapNode({"payload": node}, node.where))
    model = check(PayloadModel, node, lambda location: fields.name(("payload", *location)))
    notes: list[str] = []
    payload = read_payload(model, notes)
    return replace(description, payload=payload, payloads={}, notes=(*description.notes, *notes))
