"""Spans of chain entries as transforms."""

from __future__ import annotations

from fractions import Fraction

from modrobust.formats.models import DhModel, Giusti2015Model, JointDhModel, SpanModel
from modrobust.formats.nodes import ListNode, Node, kind_of
from modrobust.formats.quantity import parse_angle, parse_exact
from modrobust.model.geometry import (
    IDENTITY,
    Transform,
    dh_modified,
    dh_standard,
    from_xyz_rpy,
    giusti2015,
    giusti2015_iit,
    translation,
)


def span_matrix(span: SpanModel | None, field: str) -> Transform:
    """The transform from the start to the end of a span, as written; identity for none.

    Raises:
        DescriptionError: Two ways of writing a span in one, or a number that is not one.
    """
    if span is None:
        return IDENTITY
    pose = span.xyz is not None or span.rpy is not None
    ways = [
        name
        for name, given in (
            ("dh", span.dh is not None),
            ("giusti2015", span.giusti2015 is not None),
            ("xyz/rpy", pose),
        )
        if given
    ]
    if len(ways) > 1:
        raise span.where.error(
            field,
            f"{' and '.join(ways)} in one span; a span is one of dh, giusti2015, xyz/rpy; "
            "keep one of them",
        )
    if span.dh is not None:
        return _dh(span.dh, f"{field}.dh")
    if span.giusti2015 is not None:
        return _giusti(span.giusti2015, f"{field}.giusti2015")
    return pose_matrix(span.xyz, span.rpy, field)


def pose_matrix(xyz: Node | None, rpy: Node | None, field: str) -> Transform:
    """Translation xyz, then Rz(yaw) Ry(pitch) Rx(roll); zeros where not given."""
    return from_xyz_rpy(
        (0, 0, 0) if xyz is None else points(xyz, "length", f"{field}.xyz"),
        (0, 0, 0) if rpy is None else points(rpy, "angle", f"{field}.rpy"),
    )


def points(node: Node, dimension: str, field: str) -> tuple[Fraction, Fraction, Fraction]:
    """Three numbers without bounds, in SI units, exact."""
    if not isinstance(node, ListNode) or len(node.items) != 3:
        found = f"a list of {len(node.items)}" if isinstance(node, ListNode) else kind_of(node)
        raise node.where.error(field, f"{found}; a vector is a list of three; write [x, y, z]")
    x, y, z = (_number(item, dimension, f"{field}[{i}]") for i, item in enumerate(node.items))
    return x, y, z


def _number(node: Node | None, dimension: str, field: str) -> Fraction:
    if node is None:
        return Fraction(0)
    return parse_angle(node, field) if dimension == "angle" else parse_exact(node, dimension, field)


def _dh(row: DhModel, field: str) -> Transform:
    make = dh_standard if row.convention == "standard" else dh_modified
    return make(
        a=_number(row.a, "length", f"{field}.a"),
        alpha=_number(row.alpha, "angle", f"{field}.alpha"),
        d=_number(row.d, "length", f"{field}.d"),
        theta=_number(row.theta, "angle", f"{field}.theta"),
    )


def row_ahead(row: JointDhModel | None, field: str) -> Transform:
    """Rx(alpha) Tx(a) of a joint's row of modified D-H: what stands before the joint."""
    if row is None or (row.a is None and row.alpha is None):
        return IDENTITY
    a, alpha = _number(row.a, "length", f"{field}.a"), _number(row.alpha, "angle", f"{field}.alpha")
    return dh_modified(a=a, alpha=alpha, d=0, theta=0)


def row_behind(row: JointDhModel | None, field: str) -> Transform:
    """Tz(d) of a joint's row of modified D-H: what stands behind the joint."""
    if row is None or row.d is None:
        return IDENTITY
    return translation((0, 0, _number(row.d, "length", f"{field}.d")))


def is_modified(span: SpanModel | None) -> bool:
    """Whether a span is a row of modified D-H."""
    return span is not None and span.dh is not None and span.dh.convention == "modified"


def _giusti(row: Giusti2015Model, field: str) -> Transform:
    make = giusti2015 if row.convention == "giusti" else giusti2015_iit
    return make(
        p=_number(row.p, "length", f"{field}.p"),
        delta_in=_number(row.delta_in, "angle", f"{field}.delta_in"),
        a=_number(row.a, "length", f"{field}.a"),
        alpha=_number(row.alpha, "angle", f"{field}.alpha"),
        n=_number(row.n, "length", f"{field}.n"),
        delta_out=_number(row.delta_out, "angle", f"{field}.delta_out"),
    )
