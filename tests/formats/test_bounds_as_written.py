"""Bounds of whole bodies hold the boxes that are written, in rationals, and no ulp more."""

import math
import random
from fractions import Fraction

import pytest

from modrobust.formats import load_assembly, load_module
from modrobust.formats.items import BodyItem

UNITS = {
    "kg": Fraction(1),
    "g": Fraction(1, 1000),
    "m": Fraction(1),
    "mm": Fraction(1, 1000),
    "kg m^2": Fraction(1),
}


def below(value):
    double = float(value)
    return double if Fraction(double) <= value else math.nextafter(double, -math.inf)


def above(value):
    return -below(-value)


def random_quantity(rng, least, most, units):
    """A text and what it says: nominal, lo, hi; lo and hi None without a bound."""
    unit = rng.choice(units)
    scale = UNITS[unit]
    a, b, c = sorted(Fraction(f"{rng.uniform(least, most) / scale:.5g}") for _ in range(3))
    d, p = (
        Fraction(f"{rng.uniform(0.001, 0.1) * least / scale:.3g}"),
        Fraction(f"{rng.uniform(0.1, 30):.2f}"),
    )
    text = {value: f"{float(value)!r} {unit}" for value in (a, b, c, d)}
    return rng.choice(
        (
            (text[b], b * scale, None, None),
            (f"{text[b]} ± {float(p)!r}%", b * scale, b * (1 - p / 100) * scale,
             b * (1 + p / 100) * scale),
            (f"{text[b]} ± {text[d]}", b * scale, (b - d) * scale, (b + d) * scale),
            (f"[{text[a]}, {text[c]}]", (a + c) / 2 * scale, a * scale, c * scale),
            (f"{{nominal: {text[b]}, lo: {text[a]}, hi: {text[c]}}}", b * scale, a * scale,
             c * scale),
        )
    )  # fmt: skip


def assert_says(quantity, nominal, lo, hi):
    assert quantity.nominal == float(nominal)
    if lo is None:
        assert (quantity.lo, quantity.hi, quantity.bounded) == (*[quantity.nominal] * 2, False)
    else:
        assert (quantity.lo, quantity.hi, quantity.bounded) == (below(lo), above(hi), True)


def bounded(value, width):
    """A value with the bound of its tolerance, where it has none of its own."""
    nominal, lo, _ = value
    return value if lo is not None else (nominal, nominal - width, nominal + width)


@pytest.mark.parametrize("seed", range(60))
def test_a_body_has_the_box_that_is_written(tmp_path, seed):
    rng = random.Random(seed)
    mass_text, *mass = random_quantity(rng, 0.5, 5, ("kg", "g"))
    coms = [random_quantity(rng, 0.01, 0.1, ("m", "mm")) for _ in range(3)]
    moments = [random_quantity(rng, 0.9, 1.1, ("kg m^2",)) for _ in range(3)]
    about = rng.choice(("com", "frame"))
    tolerance = "mass: 3%, com: 0.7 mm, inertia: 7%"
    # fmt: off
    (tmp_path / "m.yaml").write_text(
        "modrobust: 1\nmodule: m\nname: M\nsource: a test\n"
        f"tolerance: {{{tolerance}}}\nchain:\n  - body: b\n"
        f"    mass: {mass_text}\n    com: [{', '.join(com[0] for com in coms)}]\n"
        f"    inertia: {{about: {about}, xx: {moments[0][0]}, yy: {moments[1][0]}, "
        f"zz: {moments[2][0]}}}\n"
    )
    # fmt: on
    (body,) = load_module(tmp_path / "m.yaml").items
    assert isinstance(body, BodyItem)
    assert_says(body.mass, *bounded(mass, mass[0] * Fraction(3, 100)))
    for found, (_, *com) in zip(body.com, coms, strict=True):
        assert_says(found, *bounded(com, Fraction(7, 10000)))
    diagonal = [body.inertia[k] for k in (0, 3, 5)]
    assert body.inertia_about == about
    largest = max(moment[1] for moment in moments)
    for found, (text, *entry) in zip(diagonal, moments, strict=True):
        if "%" in text:  # of the entry as written
            width = Fraction(text.rsplit("±")[1].strip(" %")) / 100 * entry[0]
            assert_says(found, entry[0], entry[0] - width, entry[0] + width)
        else:
            assert_says(found, *bounded(entry, largest * Fraction(7, 100)))


@pytest.mark.parametrize("seed", range(40))
def test_a_box_of_uncertain_edges_has_the_tensors_of_its_ends(tmp_path, seed):
    rng = random.Random(seed)
    mass_text, *mass = random_quantity(rng, 0.5, 5, ("kg", "g"))
    sizes = [random_quantity(rng, 0.01, 0.1, ("m", "mm")) for _ in range(3)]
    (tmp_path / "r.yaml").write_text(
        "modrobust: 1\nrobot: r\nchain: [none]\npayload:\n"
        f"  mass: {mass_text}\n  com: [0, 0, 0]\n  size: [{', '.join(s[0] for s in sizes)}]\n"
    )
    payload = load_assembly(tmp_path / "r.yaml").payload
    assert payload is not None
    ends = [[mass[0], mass[1] or mass[0], mass[2] or mass[0]]]
    ends += [[nominal, lo or nominal, hi or nominal] for _, nominal, lo, hi in sizes]
    for k, found in enumerate(payload.inertia[i] for i in (0, 3, 5)):
        other = [ends[1 + i] for i in range(3) if i != k]
        exact = [ends[0][e] * (other[0][e] ** 2 + other[1][e] ** 2) / 12 for e in range(3)]
        without = mass[1] is None and all(size[2] is None for size in sizes)
        assert_says(found, exact[0], *([None, None] if without else exact[1:]))
