"""Units: factors by dimension, products and powers; a ``/`` divides by the next factor only.

A unit is a rational times a power of pi times m^a kg^b s^c rad^d. Pure angles (rad, rad/s) must
match in rad too, so that an angle never passes for a number or a length; beside m or kg the
radian is optional, because N m s/rad and N m s mean the same to everyone.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from fractions import Fraction

_MAX_POWER = 6


@dataclass(frozen=True)
class Unit:
    """scale * pi ** pi_power * m^a kg^b s^c rad^d, with powers = (a, b, c, d)."""

    scale: Fraction
    pi_power: int
    powers: tuple[int, int, int, int]

    def times(self, other: Unit, power: int) -> Unit:
        """The product ``self * other ** power``."""
        m, kg, s, rad = (a + power * b for a, b in zip(self.powers, other.powers, strict=True))
        return Unit(
            self.scale * other.scale**power,
            self.pi_power + power * other.pi_power,
            (m, kg, s, rad),
        )


@dataclass(frozen=True)
class Dimension:
    """What a field measures: its name in words, its SI unit, its powers of m, kg, s, rad."""

    name: str
    si: str
    powers: tuple[int, int, int, int]

    def accepts(self, unit: Unit) -> bool:
        """Whether a value in `unit` may stand in a field of this dimension."""
        if unit.powers[:3] != self.powers[:3]:
            return False
        if unit.powers[3] == self.powers[3]:
            return True
        composite = self.powers[0] != 0 or self.powers[1] != 0
        return composite and unit.powers[3] == 0


def _unit(scale: str, m: int = 0, kg: int = 0, s: int = 0, rad: int = 0, pi_power: int = 0) -> Unit:
    return Unit(Fraction(scale), pi_power, (m, kg, s, rad))


ONE = _unit("1")
UNITS = {
    "m": _unit("1", m=1),
    "mm": _unit("1e-3", m=1),
    "cm": _unit("1e-2", m=1),
    "kg": _unit("1", kg=1),
    "g": _unit("1e-3", kg=1),
    "s": _unit("1", s=1),
    "ms": _unit("1e-3", s=1),
    "min": _unit("60", s=1),
    "rad": _unit("1", rad=1),
    "deg": _unit("1/180", rad=1, pi_power=1),
    "rpm": _unit("1/30", s=-1, rad=1, pi_power=1),
    "N": _unit("1", m=1, kg=1, s=-2),
    "Nm": _unit("1", m=2, kg=1, s=-2),
    "Hz": _unit("1", s=-1),
    "kHz": _unit("1e3", s=-1),
    "MHz": _unit("1e6", s=-1),
}

DIMENSIONS = {
    dimension.name: dimension
    for dimension in (
        Dimension("number", "", (0, 0, 0, 0)),
        Dimension("length", "m", (1, 0, 0, 0)),
        Dimension("angle", "rad", (0, 0, 0, 1)),
        Dimension("time", "s", (0, 0, 1, 0)),
        Dimension("mass", "kg", (0, 1, 0, 0)),
        Dimension("inertia", "kg m^2", (2, 1, 0, 0)),
        Dimension("force", "N", (1, 1, -2, 0)),
        Dimension("torque", "N m", (2, 1, -2, 0)),
        Dimension("speed", "m/s", (1, 0, -1, 0)),
        Dimension("angular speed", "rad/s", (0, 0, -1, 1)),
        Dimension("acceleration", "m/s^2", (1, 0, -2, 0)),
        Dimension("angular acceleration", "rad/s^2", (0, 0, -2, 1)),
        Dimension("viscous friction", "N s/m", (0, 1, -1, 0)),
        Dimension("angular viscous friction", "N m s/rad", (2, 1, -1, -1)),
        Dimension("gear ratio per length", "rad/m", (-1, 0, 0, 1)),
        Dimension("rate", "1/s", (0, 0, -1, 0)),
        Dimension("rate of a rate", "1/s^2", (0, 0, -2, 0)),
        Dimension("frequency", "Hz", (0, 0, -1, 0)),
    )
}

_FACTOR = re.compile(r"\s*(?:([*·/])\s*)?(?:([A-Za-z]+|°|1(?!\d))(?:\^(-?\d{1,2})|([²³]))?)")
_SUPERSCRIPTS = {"²": 2, "³": 3}


class UnitError(ValueError):
    """A unit that cannot be read; the message is found; rule."""


def parse_unit(text: str) -> Unit:
    """The unit that a text such as ``kg m^2`` or ``N m s/rad`` says; empty = one.

    Raises:
        UnitError: Unknown unit, or not a product of units.
    """
    unit = ONE
    position = 0
    text = text.strip()
    while position < len(text):
        match = _FACTOR.match(text, position)
        if match is None or (position == 0 and match[1] in ("*", "·")):
            raise UnitError(
                f'"{text}" is not a unit; units are products such as "kg m^2" or "N m s/rad", '
                'where "/" applies to the next factor only'
            )
        sign = -1 if match[1] == "/" else 1
        written = match[3] if match[3] is not None else str(_SUPERSCRIPTS.get(match[4], 1))
        power = sign * int(written)
        if abs(power) > _MAX_POWER:
            raise UnitError(
                f'"{text}" has the power {written}; powers go up to {_MAX_POWER}; lower it'
            )
        unit = unit.times(_factor(match[2]), power)
        if max(abs(p) for p in (*unit.powers, unit.pi_power)) > 2 * _MAX_POWER:
            raise UnitError(f'"{text}" is no unit of mechanics; check its powers')
        position = match.end()
    return unit


def _factor(name: str) -> Unit:
    if name == "1":
        return ONE
    if name == "°":
        name = "deg"
    if name in UNITS:
        return UNITS[name]
    close = difflib.get_close_matches(name, UNITS, 1, 0.6) or [
        known for known in UNITS if known.lower() == name.lower()
    ]
    hint = f'did you mean "{close[0]}"? ' if close else ""
    raise UnitError(f'unknown unit "{name}"; {hint}known: {", ".join(UNITS)} and their products')
