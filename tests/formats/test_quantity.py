"""The quantity grammar: units, exactness, outward rounding."""

import math
from fractions import Fraction

import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from modrobust.errors import ValueRangeError
from modrobust.formats import parse_quantity
from modrobust.formats.exact import PI_HI, PI_LO, above, below, nearest
from modrobust.formats.reader import _parse_yaml

QUICK = settings(max_examples=120, deadline=None, database=None, derandomize=True)

DECIMALS = st.builds(
    lambda digits, point, exponent: f"{digits}.{point}e{exponent}",
    st.integers(0, 10**12),
    st.integers(0, 10**12),
    st.integers(-40, 40),
)


def node(text):
    return _parse_yaml(f"x: {text}", "x.yaml").entries["x"]


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("2.5", "mass", 2.5),
        ("250 g", "mass", 0.25),
        ("101.3 mm", "length", 0.1013),
        ("5mm", "length", 0.005),
        ("5 cm", "length", 0.05),
        ("90 deg", "angle", math.pi / 2),
        ("90°", "angle", math.pi / 2),
        ("pi/2", "angle", math.pi / 2),
        ("-pi/2", "angle", -math.pi / 2),
        ("-pi/2 rad", "angle", -math.pi / 2),
        ("2*pi/3", "angle", 2.0943951023931953),
        ("2 pi/3", "angle", 2.0943951023931953),
        ("pi/5 rad/s", "angular speed", 0.6283185307179586),
        ("72 deg/s", "angular speed", 1.2566370614359172),
        ("30 rpm", "angular speed", math.pi),
        ("75.5 N m", "torque", 75.5),
        ("75.5 Nm", "torque", 75.5),
        ("75.5 N*m", "torque", 75.5),
        ("5 N mm", "torque", 0.005),
        ("1 kg m/s^2", "force", 1.0),
        ("15.68 N m s/rad", "angular viscous friction", 15.68),
        ("15.68 N m s", "angular viscous friction", 15.68),
        ("3 N s/m", "viscous friction", 3.0),
        ("5.23e-5 kg m^2", "inertia", 5.23e-5),
        ("2 g cm^2", "inertia", 2e-7),
        ("100 rad/m", "gear ratio per length", 100.0),
        ("160", "number", 160.0),
        ("10 1/s", "rate", 10.0),
        ("2 min", "time", 120.0),
        ("10 ms", "time", 0.01),
        ("+.5e1", "length", 5.0),
    ],
)
def test_a_number_with_a_unit_becomes_its_nearest_double_in_si(text, dimension, value):
    quantity = parse_quantity(text, dimension)
    if "pi/3" in text or text == "72 deg/s":
        value = nearest(
            (PI_LO + PI_HI) / 2 * (Fraction(2, 3) if "pi/3" in text else Fraction(2, 5))
        )
    assert (quantity.nominal, quantity.lo, quantity.hi) == (value, value, value)
    assert not quantity.bounded


def test_pi_is_enclosed_to_sixty_digits():
    old = ctx.prec
    ctx.prec = 400
    try:
        assert bool(arb(PI_LO.numerator) / arb(PI_LO.denominator) < arb.pi())
        assert bool(arb.pi() < arb(PI_HI.numerator) / arb(PI_HI.denominator))
    finally:
        ctx.prec = old
    assert Fraction(1, 10**60) >= PI_HI - PI_LO


@pytest.mark.parametrize("sign", ["±", "+-", "+/-"])
def test_a_tolerance_widens_to_both_sides(sign):
    for text in (f"4 kg {sign} 1", f"4 kg{sign}1 kg", f"4000 g {sign} 1 kg", f"4 kg {sign} 25%"):
        quantity = parse_quantity(text, "mass")
        assert (quantity.lo, quantity.nominal, quantity.hi) == (3.0, 4.0, 5.0)
        assert quantity.bounded


def test_after_the_sign_a_bare_number_takes_the_unit_of_the_nominal_value():
    assert parse_quantity("18 mm ± 2", "length").hi == above(Fraction(20, 1000))
    assert parse_quantity("3 ± 500 g", "mass").hi == 3.5


def test_a_per_cent_of_a_negative_number_is_positive():
    quantity = parse_quantity("-4 ± 25%", "length")
    assert (quantity.lo, quantity.hi) == (-5.0, -3.0)


def test_two_bounds_have_their_midpoint_as_nominal():
    quantity = parse_quantity(node("[0 kg, 2000 g]"), "mass")
    assert (quantity.lo, quantity.nominal, quantity.hi) == (0.0, 1.0, 2.0)


def test_written_nominal_and_bounds_are_kept():
    quantity = parse_quantity(node("{nominal: 5 mm, lo: -1 cm, hi: 5 mm}"), "length")
    assert quantity.nominal == 0.005
    assert quantity.lo == below(Fraction(-1, 100))
    assert quantity.hi == above(Fraction(5, 1000))


def test_a_text_without_a_file_says_which_option_is_wrong():
    with pytest.raises(ValueRangeError) as caught:
        parse_quantity("10 m", "time", field="--duration")
    assert str(caught.value) == (
        '--duration: "10 m" has the unit "m"; a time [s] is expected; write it in s'
    )


@given(DECIMALS, st.integers(0, 10**9), st.booleans())
@QUICK
def test_bounds_contain_the_written_decimals_and_are_one_ulp_wide(text, width, negative):
    value = Fraction(text) * (-1 if negative else 1)
    deviation = Fraction(width, 10**9)
    written = f"{'-' if negative else ''}{text} m ± {width}e-9"
    _holds_tightly(parse_quantity(written, "length"), value, value - deviation, value + deviation)


@given(DECIMALS.filter(lambda text: Fraction(text) > 0), st.integers(0, 10**6))
@QUICK
def test_percentages_are_exact(text, percent):
    value, offset = Fraction(text), Fraction(text) * Fraction(percent, 10**5) / 100
    quantity = parse_quantity(f"{text} ± {percent}e-5 %", "mass")
    _holds_tightly(quantity, value, value - offset, value + offset)


@given(DECIMALS, DECIMALS)
@QUICK
def test_pairs_are_exact(one, other):
    lo, hi = sorted((one, other), key=Fraction)
    quantity = parse_quantity(node(f"[{lo} g, {hi} g]"), "mass")
    low, high = Fraction(lo) / 1000, Fraction(hi) / 1000
    _holds_tightly(quantity, (low + high) / 2, low, high)


@given(st.integers(-720, 720), st.integers(1, 10**6))
@QUICK
def test_bounds_in_degrees_contain_the_angle(degrees, width):
    quantity = parse_quantity(f"{degrees} deg ± {width}e-6 deg", "angle")
    lo, hi = (Fraction(degrees) + sign * Fraction(width, 10**6) for sign in (-1, 1))
    assert Fraction(quantity.lo) <= min(lo * PI_LO, lo * PI_HI) / 180
    assert Fraction(quantity.hi) >= max(hi * PI_LO, hi * PI_HI) / 180
    assert Fraction(math.nextafter(quantity.lo, math.inf)) > lo * PI_LO / 180 - Fraction(1, 10**90)
    assert quantity.lo <= quantity.nominal <= quantity.hi


def _holds_tightly(quantity, nominal, lo, hi):
    assert quantity.nominal == float(nominal)
    assert Fraction(quantity.lo) <= lo
    assert hi <= Fraction(quantity.hi)
    assert Fraction(math.nextafter(quantity.lo, math.inf)) > lo
    assert Fraction(math.nextafter(quantity.hi, -math.inf)) < hi
    assert quantity.lo <= quantity.nominal <= quantity.hi
