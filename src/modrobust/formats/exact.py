r"""Exact numbers of a description: rationals, pi enclosed to 10^-100, and outward rounding.

A number is written as r pi^k with r rational (90 deg = pi/2). It is kept as an enclosure
[lo, hi] of rationals, of width zero unless pi is in it, so that a bound can be rounded outward and
a nominal value to its nearest double without an intermediate rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from modrobust.model.geometry import PI_DIGITS

PI_LO = Fraction(PI_DIGITS)  # truncated, so that it lies below pi
PI_HI = PI_LO + Fraction(1, 10**100)


@dataclass(frozen=True)
class Enclosure:
    """Rational bounds lo <= x <= hi of one real number x."""

    lo: Fraction
    hi: Fraction

    @property
    def middle(self) -> Fraction:
        """A rational within 10^-99 of the number, and the number itself when that is rational."""
        return self.lo if self.lo == self.hi else (self.lo + self.hi) / 2

    def __add__(self, other: Enclosure) -> Enclosure:
        return Enclosure(self.lo + other.lo, self.hi + other.hi)

    def __sub__(self, other: Enclosure) -> Enclosure:
        return Enclosure(self.lo - other.hi, self.hi - other.lo)

    def scaled(self, factor: Fraction) -> Enclosure:
        """The enclosure of factor x."""
        ends = (self.lo * factor, self.hi * factor)
        return Enclosure(min(ends), max(ends))

    def __abs__(self) -> Enclosure:
        return self if self.middle >= 0 else Enclosure(-self.hi, -self.lo)


def enclose(rational: Fraction, pi_power: int) -> Enclosure:
    """The enclosure of rational * pi ** pi_power."""
    if pi_power == 0 or rational == 0:
        return Enclosure(rational, rational)
    if pi_power > 0:
        powers = (PI_LO**pi_power, PI_HI**pi_power)
    else:
        powers = (1 / PI_HI**-pi_power, 1 / PI_LO**-pi_power)
    return Enclosure(*powers).scaled(rational)


def nearest(value: Fraction) -> float:
    """The double nearest to a rational; OverflowError beyond the doubles."""
    return value.numerator / value.denominator + 0.0  # int / int is rounded once; no -0.0


def below(value: Fraction) -> float:
    """The largest double at or below a rational (at most one unit in the last place below)."""
    double = nearest(value)
    return double if Fraction(double) <= value else math.nextafter(double, -math.inf)


def above(value: Fraction) -> float:
    """The smallest double at or above a rational."""
    double = nearest(value)
    return double if Fraction(double) >= value else math.nextafter(double, math.inf)
