"""Quantities: ``NUMBER [UNIT] [± NUMBER (UNIT|%)]``, ``[lo, hi]``, ``{nominal, lo, hi}``.

Everything is exact (rationals) until the very end, where a nominal value becomes its nearest
double and a written bound is rounded outward, so that it contains the decimals as written.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

from modrobust.errors import DescriptionError, ValueRangeError
from modrobust.formats.exact import Enclosure, above, below, nearest
from modrobust.formats.nodes import ListNode, MapNode, Node, ScalarNode, Where, kind_of, shown
from modrobust.formats.number import NumberError, parse_number
from modrobust.formats.structure import unknown_key
from modrobust.formats.units import DIMENSIONS, Dimension
from modrobust.model.geometry import MAX_ANGLE

_PLUS_MINUS = re.compile(r"±|\+/-|\+-")
_BOUND_KEYS = ("nominal", "lo", "hi")


@dataclass(frozen=True)
class Quantity:
    """A number in SI units with hard closed bounds.

    A value without a written bound has ``lo == nominal == hi`` and ``bounded`` False. Written
    bounds are rounded outward: ``lo`` and ``hi`` contain the decimals that were written.
    """

    nominal: float
    lo: float
    hi: float
    bounded: bool


@dataclass(frozen=True)
class Written:
    """A quantity as written, exact: nominal plus an interval of offsets, or a per cent of it.

    `minus` <= 0 <= `plus` are lo - nominal and hi - nominal; None, None for no written bound.
    `percent` holds ± x % until the value that it is a per cent of is known.
    """

    nominal: Enclosure
    minus: Enclosure | None
    plus: Enclosure | None
    percent: Fraction | None
    where: Where
    field: str

    @property
    def bounded(self) -> bool:
        """Whether the description wrote a bound."""
        return self.minus is not None or self.percent is not None

    def moved(self, nominal: Fraction) -> Written:
        """Another nominal value in the same place of the file, for messages; no bound fits it."""
        return replace(self, nominal=Enclosure(nominal, nominal))

    def widened(self, deviation: Enclosure) -> Written:
        """The value with ± `deviation` as its bound."""
        return replace(
            self, minus=Enclosure(-deviation.hi, -deviation.lo), plus=deviation, percent=None
        )

    def between(self, lo: Fraction, hi: Fraction) -> Written:
        """The value with rational bounds."""
        minus, plus = (Enclosure(end, end) - self.nominal for end in (lo, hi))
        return replace(self, minus=minus, plus=plus, percent=None)

    def ends(self) -> tuple[Enclosure, Enclosure]:
        """Exact lower and upper bound; the nominal value twice where there is none.

        Raises:
            DescriptionError: A per cent of 0.
        """
        if self.percent is not None:
            if self.nominal.middle == 0:
                raise self.where.error(
                    self.field,
                    "a per cent of 0; that leaves no width; "
                    "write an absolute bound such as ± 0.001 with its unit",
                )
            offset = abs(self.nominal).scaled(self.percent / 100)
            return self.nominal - offset, self.nominal + offset
        if self.minus is None or self.plus is None:
            return self.nominal, self.nominal
        return self.nominal + self.minus, self.nominal + self.plus

    def quantity(self) -> Quantity:
        """In doubles: nominal to nearest, bounds outward."""
        nominal = self.double(self.nominal.middle, nearest)
        if not self.bounded:
            return Quantity(nominal, nominal, nominal, bounded=False)
        lo, hi = self.ends()
        return Quantity(nominal, self.double(lo.lo, below), self.double(hi.hi, above), bounded=True)

    def double(self, value: Fraction, rounding: Callable[[Fraction], float]) -> float:
        """`value` as a finite double."""
        try:
            double = rounding(value)
        except OverflowError:
            double = float("inf")
        if double in (float("inf"), float("-inf")):
            raise self.where.error(
                self.field, "too large; numbers stay below 1.79e308 in SI units; check its exponent"
            )
        return double


def parse_quantity(
    text: str | Node,
    dimension: str,
    *,
    field: str = "",
    bounds: bool = True,
    alternatives: tuple[str, ...] = (),
) -> Quantity:
    """The quantity that a text or a node of a description says, in SI units.

    Args:
        text: The text, or the node (which then brings file and line for messages).
        dimension: A name such as "length", "angle", "mass", "time"; see `units.DIMENSIONS`.
        field: Name of the field or option for messages.
        bounds: Whether the value may carry bounds.
        alternatives: Further dimensions that fit.

    Raises:
        DescriptionError: A node is not such a quantity.
        ValueRangeError: A text is not such a quantity.
    """
    names = (dimension, *alternatives)
    if not isinstance(text, str):
        return parse_written(text, names, field, bounds=bounds).quantity()
    node = ScalarNode(text, Where("", None))
    try:
        return parse_written(node, names, field, bounds=bounds).quantity()
    except DescriptionError as error:
        raise ValueRangeError(f"{field}: {error.message}" if field else error.message) from None


def parse_point(node: Node, dimensions: str | tuple[str, ...], field: str) -> float:
    """The number without bounds that a node says, in SI units: its nearest double."""
    return nearest(parse_exact(node, dimensions, field))


def parse_not_negative(
    node: Node | None, dimensions: str | tuple[str, ...], field: str
) -> float | None:
    """As `parse_point`, None for no node; a number below 0 is refused."""
    if node is None:
        return None
    value = parse_point(node, dimensions, field)
    if value < 0:
        raise node.where.error(field, f"{value:g} is negative; it is at least 0; write 0 or more")
    return value


def parse_positive(
    node: Node | None, dimensions: str | tuple[str, ...], field: str
) -> float | None:
    """As `parse_point`, None for no node; a number that is not above 0 is refused."""
    if node is None:
        return None
    value = parse_point(node, dimensions, field)
    if value <= 0:
        raise node.where.error(
            field, f"{value:g} is not positive; it must be above 0; write a positive number"
        )
    return value


def parse_exact(node: Node, dimensions: str | tuple[str, ...], field: str) -> Fraction:
    """The number without bounds that a node says, in SI units, to 10^-99 where pi is in it."""
    names = (dimensions,) if isinstance(dimensions, str) else dimensions
    written = parse_written(node, names, field, bounds=False)
    value = written.nominal.middle
    written.double(value, nearest)  # refuses what is beyond the doubles
    return value


def parse_angle(node: Node, field: str) -> Fraction:
    """The angle [rad] of a constant transform, as `parse_exact`.

    Raises:
        DescriptionError: No angle, or beyond what `geometry.cos_sin` takes.
    """
    value = parse_exact(node, "angle", field)
    if abs(value) > MAX_ANGLE:
        raise node.where.error(
            field,
            f"{float(value):g} rad; an angle lies within {MAX_ANGLE:g} rad; "
            "reduce it by whole turns",
        )
    return value


def parse_written(
    node: Node, dimensions: tuple[str, ...], field: str, *, bounds: bool = True
) -> Written:
    """The exact quantity that a node says.

    Raises:
        DescriptionError: Not a quantity, of another dimension, bounds reversed or not allowed,
            nominal outside its bounds.
    """
    known = tuple(DIMENSIONS[name] for name in dimensions)
    if isinstance(node, ScalarNode):
        return _scalar(node, known, field, bounds)
    if not bounds:
        raise node.where.error(
            field, f'{kind_of(node)}; one number without bounds is expected; write "NUMBER UNIT"'
        )
    if isinstance(node, ListNode):
        if len(node.items) != 2:
            raise node.where.error(
                field,
                f"a list of {len(node.items)}; bounds are a list of two; write [lo, hi]",
            )
        lo = _point(node.items[0], known, f"{field}[0]")
        hi = _point(node.items[1], known, f"{field}[1]")
        nominal = (lo + hi).scaled(Fraction(1, 2))
        return _between(nominal, lo, hi, node.where, field)
    return _mapping(node, known, field)


def _mapping(node: MapNode, known: tuple[Dimension, ...], field: str) -> Written:
    for key in node:
        if key not in _BOUND_KEYS:
            raise node.place(key).error(field, unknown_key(key, _BOUND_KEYS))
    for key in _BOUND_KEYS:
        if key not in node.entries:
            raise node.where.error(field, f'no "{key}"; bounds are {{nominal, lo, hi}}; add {key}')
    nominal, lo, hi = (_point(node.entries[key], known, f"{field}.{key}") for key in _BOUND_KEYS)
    return _between(nominal, lo, hi, node.where, field)


def _between(nominal: Enclosure, lo: Enclosure, hi: Enclosure, where: Where, field: str) -> Written:
    if lo.middle > hi.middle:
        raise where.error(
            field,
            f"lower bound {_text(lo)} above upper bound {_text(hi)}; bounds are [lo, hi]; "
            "exchange them",
        )
    if not lo.middle <= nominal.middle <= hi.middle:
        raise where.error(
            field,
            f"nominal {_text(nominal)} outside its bounds [{_text(lo)}, {_text(hi)}]; the nominal "
            "value lies inside; widen the bounds or correct it",
        )
    return Written(nominal, lo - nominal, hi - nominal, None, where, field)


def _text(value: Enclosure) -> str:
    try:
        return f"{nearest(value.middle):.12g}"
    except OverflowError:
        return "1e309 or more"


def _point(node: Node, known: tuple[Dimension, ...], field: str) -> Enclosure:
    if not isinstance(node, ScalarNode):
        raise node.where.error(
            field, f'{kind_of(node)}; one number is expected here; write "NUMBER UNIT"'
        )
    return _scalar(node, known, field, False).nominal


def _scalar(node: ScalarNode, known: tuple[Dimension, ...], field: str, bounds: bool) -> Written:
    try:
        return _parse_text(node, known, field, bounds)
    except NumberError as error:
        raise node.where.error(field, str(error)) from None


def _parse_text(
    node: ScalarNode, known: tuple[Dimension, ...], field: str, bounds: bool
) -> Written:
    first, *rest = _PLUS_MINUS.split(node.text, maxsplit=2)
    number = parse_number(first, known)
    exact = Written(number.value, None, None, None, node.where, field)
    if not rest:
        return exact
    if not bounds:
        raise NumberError(f"{shown(node.text)} has bounds; this field takes none; remove them")
    if len(rest) > 1:
        raise NumberError(
            f"{shown(node.text)} has two bounds; a quantity has one ±; keep one of them"
        )
    if rest[0].rstrip().endswith("%"):
        # A per cent of 0 is refused in `ends`.
        return replace(exact, percent=parse_percent(rest[0], node.text))
    deviation = parse_number(rest[0], known, number.unit).value
    if deviation.middle < 0:
        raise NumberError(f"{shown(node.text)} has a negative width; ± is positive; remove the -")
    return exact.widened(deviation)


def parse_percent(text: str, whole: str) -> Fraction:
    """The number before a per cent sign, exact.

    Raises:
        NumberError: Not a number, or negative.
    """
    percent = parse_number(text.rstrip().removesuffix("%"), (DIMENSIONS["number"],)).value.middle
    if percent < 0:
        raise NumberError(f"{shown(whole)} has a negative width; ± is positive; remove the -")
    return percent


def parse_vector(
    node: Node, dimensions: tuple[str, ...], field: str, *, bounds: bool = True
) -> tuple[Written, Written, Written]:
    """Three quantities: a list of three, or ``{nominal: [..], lo: [..], hi: [..]}``."""
    if isinstance(node, MapNode) and bounds:
        node = _transposed(node, field)
    if not isinstance(node, ListNode) or len(node.items) != 3:
        found = f"a list of {len(node.items)}" if isinstance(node, ListNode) else kind_of(node)
        raise node.where.error(field, f"{found}; a vector is a list of three; write [x, y, z]")
    x, y, z = (
        parse_written(item, dimensions, f"{field}[{i}]", bounds=bounds)
        for i, item in enumerate(node.items)
    )
    return x, y, z


def _transposed(node: MapNode, field: str) -> ListNode:
    """A mapping of three lists as a list of three mappings."""
    for key in node:
        if key not in _BOUND_KEYS:
            raise node.place(key).error(field, unknown_key(key, _BOUND_KEYS))
    columns = []
    for key in _BOUND_KEYS:
        column = node.entries.get(key)
        if column is None:
            raise node.where.error(field, f'no "{key}"; bounds are {{nominal, lo, hi}}; add {key}')
        if not isinstance(column, ListNode) or len(column.items) != 3:
            found = kind_of(column)
            if isinstance(column, ListNode):
                found = f"a list of {len(column.items)}"
            raise column.where.error(
                f"{field}.{key}", f"{found}; a vector is a list of three; write [x, y, z]"
            )
        columns.append(column.items)
    rows = zip(*columns, strict=True)
    items = tuple(MapNode(dict(zip(_BOUND_KEYS, row, strict=True)), node.where) for row in rows)
    return ListNode(items, node.where)
