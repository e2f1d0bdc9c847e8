"""Joints of module files: limits, drive and friction in SI units."""

from __future__ import annotations

from modrobust.formats.items import JointItem
from modrobust.formats.models import JointModel
from modrobust.formats.nodes import ListNode, Node, kind_of
from modrobust.formats.part_models import DriveOptionModel, LimitsModel
from modrobust.formats.quantity import Quantity, parse_point, parse_written
from modrobust.formats.span import row_ahead, row_behind
from modrobust.formats.tolerance import Tolerances

_DRIVES = {
    "rotor_inertia": ("inertia",),
    "gear_ratio": ("number", "gear ratio per length"),
    "viscous": ("angular viscous friction", "viscous friction"),
    "coulomb": ("torque", "force"),
}
_COULOMB_SPEED = 1e-3  # [rad/s] or [m/s]
_DIMENSIONS = {
    "revolute": {
        "position": "angle",
        "velocity": "angular speed",
        "acceleration": "angular acceleration",
        "effort": "torque",
        "gear_ratio": "number",
        "viscous": "angular viscous friction",
    },
    "prismatic": {
        "position": "length",
        "velocity": "speed",
        "acceleration": "acceleration",
        "effort": "force",
        "gear_ratio": "gear ratio per length",
        "viscous": "viscous friction",
    },
}


def read_joint(model: JointModel, prefix: str, tolerances: Tolerances) -> JointItem:
    """A joint with its tolerances applied.

    Raises:
        DescriptionError: A unit of the other kind of joint, limits out of order, a negative bound.
    """
    kind = "prismatic" if model.type == "prismatic" else "revolute"
    dimensions = _DIMENSIONS[kind]
    limits, drive, friction = model.limits, model.drive, model.friction
    field = f"{prefix}drive."
    gear_ratio = _positive(
        drive.gear_ratio if drive else None, dimensions["gear_ratio"], f"{field}gear_ratio"
    )
    rotor_inertia = _parameter(
        "rotor_inertia", drive.rotor_inertia if drive else None, "inertia", field, tolerances
    )
    if drive is not None and rotor_inertia is not None and gear_ratio is None:
        raise drive.where.error(
            f"{prefix}drive",
            "rotor_inertia without gear_ratio; the joint feels the rotor through the gear; "
            "add gear_ratio (1 for a direct drive)",
        )
    field = f"{prefix}friction."
    speed = _positive(
        friction.coulomb_speed if friction else None,
        dimensions["velocity"],
        f"{field}coulomb_speed",
    )
    return JointItem(
        name=model.joint,
        type=model.type,
        position=_position(model, limits, dimensions["position"], prefix),
        velocity=_limit(limits, "velocity", dimensions["velocity"], prefix),
        effort=_effort(limits, kind, prefix),
        acceleration=_limit(limits, "acceleration", dimensions["acceleration"], prefix),
        gear_ratio=gear_ratio,
        rotor_inertia=rotor_inertia,
        viscous=_parameter(
            "viscous",
            friction.viscous if friction else None,
            dimensions["viscous"],
            field,
            tolerances,
        ),
        coulomb=_parameter(
            "coulomb",
            friction.coulomb if friction else None,
            dimensions["effort"],
            field,
            tolerances,
        ),
        coulomb_speed=_COULOMB_SPEED if speed is None else speed,
        where=model.where,
        ahead=row_ahead(model.dh, f"{prefix}dh"),
        behind=row_behind(model.dh, f"{prefix}dh"),
    )


def drive_figures(model: DriveOptionModel) -> dict[str, Node]:
    """What is written for all joints, as far as it can be checked without knowing how they move.

    Raises:
        DescriptionError: A figure of no kind of joint, a negative one, a rotor without a gear.
    """
    written = dict(model.node.entries)
    if "rotor_inertia" in written and "gear_ratio" not in written:
        raise model.where.error(
            "",
            "rotor_inertia without gear_ratio; the joint feels the rotor through the gear; "
            "add gear_ratio (1 for a direct drive)",
        )
    for key, node in written.items():
        field = f"drive.{key}"
        quantity = parse_written(node, _DRIVES[key], field, bounds=key != "gear_ratio").quantity()
        if key == "gear_ratio" and quantity.lo <= 0:
            raise node.where.error(
                field,
                f"{quantity.lo:g} is not positive; it must be above 0; write a positive number",
            )
        if quantity.lo < 0:
            what = "lower bound " if quantity.bounded else ""
            raise node.where.error(
                field, f"{what}{quantity.lo:g} is negative; it is at least 0; write 0 or more"
            )
    return written


def _position(
    model: JointModel, limits: LimitsModel | None, dimension: str, prefix: str
) -> tuple[float, float] | None:
    node = limits.position if limits is not None else None
    if node is None:
        return None
    field = f"{prefix}limits.position"
    if model.type == "continuous":
        raise node.where.error(
            field,
            "limits on a continuous joint; a continuous joint has no position limits; "
            "remove them or write type: revolute",
        )
    if not isinstance(node, ListNode) or len(node.items) != 2:
        found = f"a list of {len(node.items)}" if isinstance(node, ListNode) else kind_of(node)
        raise node.where.error(field, f"{found}; position limits are two; write [lo, hi]")
    lo, hi = (parse_point(item, dimension, f"{field}[{i}]") for i, item in enumerate(node.items))
    if lo >= hi:
        raise node.where.error(
            field,
            f"lower limit {lo:.9g} not below upper limit {hi:.9g}; limits are [lo, hi]; "
            "exchange or correct them",
        )
    return lo, hi


def _effort(limits: LimitsModel | None, kind: str, prefix: str) -> float | None:
    if limits is None:
        return None
    right, wrong = ("force", "torque") if kind == "prismatic" else ("torque", "force")
    if getattr(limits, wrong) is not None:
        raise limits.node.place(wrong).error(
            f"{prefix}limits.{wrong}",
            f"{wrong} limit on a {kind} joint; a {kind} joint has a {right}; rename it to {right}",
        )
    return _limit(limits, right, right, prefix)


def _limit(limits: LimitsModel | None, key: str, dimension: str, prefix: str) -> float | None:
    node: Node | None = getattr(limits, key) if limits is not None else None
    return _positive(node, dimension, f"{prefix}limits.{key}")


def _positive(node: Node | None, dimension: str, field: str) -> float | None:
    """A number above 0, None where nothing is written."""
    if node is None:
        return None
    value = parse_point(node, dimension, field)
    if value <= 0:
        raise node.where.error(
            field,
            f"{value:g} is not positive; it must be above 0; write a positive "
            "number or leave it out",
        )
    return value


def _parameter(
    key: str, node: Node | None, dimension: str, prefix: str, tolerances: Tolerances
) -> Quantity | None:
    """A drive or friction parameter whose bounds stay at or above 0."""
    if node is None:
        return None
    field = f"{prefix}{key}"
    written = parse_written(node, (dimension,), field)
    quantity = tolerances.apply(key, written, dimension).quantity()
    if quantity.lo < 0:
        what = "lower bound " if quantity.bounded else ""
        by_tolerance = quantity.bounded and not written.bounded
        remedy = tolerances.remedy(key, written) if by_tolerance else "write 0 or more"
        raise node.where.error(
            field, f"{what}{quantity.lo:g} is negative; it is at least 0; {remedy}"
        )
    return quantity
