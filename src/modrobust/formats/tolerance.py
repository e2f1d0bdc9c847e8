"""The ``tolerance:`` block of a module: bounds for parameters that have none of their own."""

from __future__ import annotations

from fractions import Fraction

from modrobust.formats.exact import Enclosure
from modrobust.formats.nodes import Node, ScalarNode, shown
from modrobust.formats.number import NumberError, parse_number
from modrobust.formats.part_models import ToleranceModel
from modrobust.formats.quantity import Written, parse_percent, parse_written
from modrobust.formats.units import DIMENSIONS

_DIMENSIONS = {
    "mass": ("mass",),
    "com": ("length",),
    "inertia": ("inertia",),
    "rotor_inertia": ("inertia",),
    "viscous": ("angular viscous friction", "viscous friction"),
    "coulomb": ("torque", "force"),
}

_MUCH = 0.1  # [m], more than a centre of mass is ever wrong by


def _meant(value: float) -> str:
    """How the per cent is written that a bare number was likely meant as: 5 or 0.05 for 5 %."""
    percent = value if value > 0.5 else 100.0 * value
    return f"{percent:g} % is written {percent:g}%"


class Tolerances:
    """Fills in bounds and remembers which keys had something to act on."""

    def __init__(self, block: ToleranceModel | None) -> None:
        nodes: dict[str, Node | None] = {
            key: getattr(block, key) if block is not None else None for key in _DIMENSIONS
        }
        self._nodes = {key: node for key, node in nodes.items() if node is not None}
        self._used: set[str] = set()
        for key, dimensions in _DIMENSIONS.items():
            self._width(key, dimensions)  # refuse a wrong one even where nothing uses it

    @property
    def unused(self) -> tuple[str, ...]:
        """Keys that no parameter without a bound of its own was there for."""
        return tuple(key for key in self._nodes if key not in self._used)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is likely a slip: a number without a unit where a per cent is usual."""
        found = []
        for key, (dimension, *_) in _DIMENSIONS.items():
            bare = self._bare(key) if key in self._used else None
            if bare is not None and (key != "com" or bare[1] >= _MUCH):
                text, value = bare
                meant = _meant(value) if key != "com" else f"{value:g} mm is written {value:g} mm"
                unit = DIMENSIONS[dimension].si
                found.append(f"tolerance.{key}: {text} is {text} {unit}, not a per cent; {meant}")
        return tuple(found)

    def remedy(self, key: str, value: Written) -> str:
        """What to do where the lower bound of `value` is too low."""
        bare = None if value.bounded else self._bare(key)
        if bare is not None:
            return f"the tolerance {bare[0]} is no per cent; {_meant(bare[1])}"
        return "narrow the bounds" if value.bounded else "narrow the tolerance"

    def _bare(self, key: str) -> tuple[str, float] | None:
        """Text and value of a width without unit and without %, unless it is 0."""
        node = self._nodes.get(key)
        if not isinstance(node, ScalarNode) or node.text.rstrip().endswith("%"):
            return None
        number = parse_number(node.text, tuple(DIMENSIONS[name] for name in _DIMENSIONS[key]))
        value = float(number.value.middle)
        return None if number.unit is not None or value == 0.0 else (f"{value:g}", value)

    def apply(
        self,
        key: str,
        value: Written,
        dimension: str,
        reference: Fraction | None = None,
    ) -> Written:
        """`value` with the tolerance as its bound, unless it has one or there is no tolerance.

        Args:
            key: Which tolerance.
            value: The parameter.
            dimension: What the parameter measures.
            reference: What a per cent is of, where that is not the value itself.

        Raises:
            DescriptionError: A per cent of a written 0.
        """
        if value.bounded or key not in self._nodes:
            return value
        self._used.add(key)
        width = self._width(key, (dimension,))
        if isinstance(width, Enclosure):
            return value.widened(width)
        if width is None:
            return value
        base = abs(value.nominal) if reference is None else Enclosure(reference, reference)
        if base.middle == 0:
            raise value.where.error(
                value.field,
                f"tolerance.{key} is a per cent and this value is 0; a per cent of 0 leaves no "
                "width; give this value or the tolerance an absolute bound",
            )
        return value.widened(base.scaled(width / 100))

    def _width(self, key: str, dimensions: tuple[str, ...]) -> Fraction | Enclosure | None:
        """Per cent as a rational, absolute width as an enclosure, None for no tolerance."""
        node = self._nodes.get(key)
        if node is None:
            return None
        field = f"tolerance.{key}"
        if isinstance(node, ScalarNode) and node.text.rstrip().endswith("%"):
            try:
                return parse_percent(node.text, node.text)
            except NumberError as error:
                raise node.where.error(field, str(error)) from None
        width = parse_written(node, dimensions, field, bounds=False).nominal
        if width.middle < 0:
            text = node.text if isinstance(node, ScalarNode) else ""
            raise node.where.error(
                field, f"{shown(text)} is negative; a tolerance is a width; remove the -"
            )
        return width
