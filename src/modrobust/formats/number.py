"""Texts of numbers: ``-1.5e-3``, ``pi/2``, ``2*pi/3`` and a unit, in exact arithmetic."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from modrobust.formats.exact import Enclosure, enclose
from modrobust.formats.nodes import shown
from modrobust.formats.units import ONE, Dimension, Unit, UnitError, parse_unit

MAX_LENGTH = 400
MAX_EXPONENT = 300

_DECIMAL = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_COMMA = re.compile(r"\s*[+-]?[0-9]+(,)[0-9]")
_PI = r"(?:pi|π)(?![^\W\d_])"
_VALUE = re.compile(
    rf"\s*(?P<sign>[+-]?)\s*(?P<product>(?:{_DECIMAL}|{_PI})"
    rf"(?:\s*[*/]\s*(?:{_DECIMAL}|{_PI})|\s*{_PI})*)(?P<rest>.*)",
    re.DOTALL,
)
_FACTOR = re.compile(rf"\s*([*/]?)\s*({_DECIMAL}|{_PI})")
_NOT_FINITE = re.compile(r"\s*[+-]?\s*\.?(nan|inf|infinity)\b", re.IGNORECASE)


class NumberError(ValueError):
    """A text that is not the number it should be; the message is found; rule; remedy."""


@dataclass(frozen=True)
class Number:
    """A number in SI units, and the unit it was written in (None = bare)."""

    value: Enclosure
    unit: Unit | None


def parse_number(
    text: str, dimensions: tuple[Dimension, ...], default_unit: Unit | None = None
) -> Number:
    """The number with unit that a text says.

    Args:
        text: Such as ``101.3 mm``, ``-pi/2`` or ``5e-5``.
        dimensions: What the field may measure; a bare number is SI.
        default_unit: Unit of a bare number instead of SI.

    Raises:
        NumberError: Not a number, not finite, out of range, or of another dimension.
    """
    if len(text) > MAX_LENGTH:
        raise NumberError(
            f"a number of {len(text)} characters; a number has at most {MAX_LENGTH}; shorten it"
        )
    match = _VALUE.fullmatch(text)
    comma = _COMMA.match(text)
    if comma is not None:
        raise NumberError(
            f"{shown(text)} has a comma; the decimal sign is a point; "
            f'write "{text[: comma.start(1)]}.{text[comma.end(1) :]}"'
        )
    if match is None:
        raise NumberError(_not_a_number(text))
    rational, pi_power = _product(match["product"], text)
    if match["sign"] == "-":
        rational = -rational
    written = match["rest"].strip()
    try:
        unit = parse_unit(written) if written else None
    except UnitError as error:
        raise NumberError(f"{shown(text)}: {error}") from None
    dimension = _check_unit(text, written, unit, dimensions)
    angular = dimension.powers[3] != 0 and dimension.powers[1] == 0
    if pi_power and not (angular and unit in (None, _SI_RADIANS.get(dimension.si))):
        raise NumberError(f"{shown(text)} uses pi; pi is for angles in rad; write a decimal number")
    factor = unit or default_unit or ONE
    return Number(enclose(rational * factor.scale, pi_power + factor.pi_power), unit)


# A product with pi is in radians; degrees times pi would be a slip.
_SI_RADIANS = {text: parse_unit(text) for text in ("rad", "rad/s", "rad/s^2", "rad/m")}


def _product(text: str, whole: str) -> tuple[Fraction, int]:
    rational, pi_power, factors = Fraction(1), 0, 0
    for sign, factor in _FACTOR.findall(text):
        power = -1 if sign == "/" else 1
        factors += 1
        if factor in ("pi", "π"):
            pi_power += power
            continue
        number = _decimal(factor)
        if power < 0 and number == 0:
            raise NumberError(f"{shown(whole)} divides by 0; a number is finite; divide by another")
        rational *= number**power
    if factors > 1 and not any(name in text for name in ("pi", "π")):
        raise NumberError(
            f"{shown(whole)} is a product; only products with pi are read; write a decimal number"
        )
    if abs(pi_power) > 4:
        raise NumberError(f"{shown(whole)} has too many pi; an angle has one; write it once")
    return rational, pi_power


def _decimal(text: str) -> Fraction:
    mantissa, _, exponent = text.lower().partition("e")
    if exponent and (len(exponent) > 6 or abs(int(exponent)) > MAX_EXPONENT):
        raise NumberError(
            f"{shown(text)} is out of range; exponents lie between -{MAX_EXPONENT} and "
            f"{MAX_EXPONENT}; check the exponent"
        )
    return Fraction(mantissa) * Fraction(10) ** int(exponent or "0")


def _not_a_number(text: str) -> str:
    found = _NOT_FINITE.match(text)
    if found and found[1].lower() == "nan":
        return f"{shown(text)} is not a number; numbers are finite; write a finite number"
    if found:
        return f"{shown(text)} is infinite; numbers are finite; write a finite number"
    if not text.strip():
        return 'nothing is written; a number is expected; write one such as "1.5 kg"'
    return (
        f'{shown(text)} is not a number; a quantity is NUMBER [UNIT] such as "101.3 mm", '
        '"5e-5 kg m^2" or "3.9 kg ± 2%"; write it so'
    )


def _check_unit(
    text: str, written: str, unit: Unit | None, dimensions: tuple[Dimension, ...]
) -> Dimension:
    if unit is None:
        return dimensions[0]
    for dimension in dimensions:
        if dimension.accepts(unit):
            return dimension
    expected = " or ".join(
        f"{_article(dimension.name)} [{dimension.si}]" if dimension.si else "a number without unit"
        for dimension in dimensions
    )
    units = " or ".join(dimension.si for dimension in dimensions if dimension.si)
    remedy = f"write it in {units}" if units else "leave the unit out"
    raise NumberError(f'{shown(text)} has the unit "{written}"; {expected} is expected; {remedy}')


def _article(name: str) -> str:
    return f"an {name}" if name[0] in "aeiou" else f"a {name}"
