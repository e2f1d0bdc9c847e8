"""The kernel's own sine and cosine against arbitrary-precision balls."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flint import arb, ctx

from modrobust import _kernel
from support.paths import ROOT

WORST, ULPS = 39027.220137382596, 0.807  # [rad]; the largest error seen, in its cosine


@pytest.fixture(autouse=True)
def _precision():
    before, ctx.prec = ctx.prec, 300
    yield
    ctx.prec = before


def angles() -> list[float]:
    rng = np.random.default_rng(0)
    hard = [k * math.pi / 2 for k in range(-63661, 63661, 997)]  # near a zero of one of the two
    small = [
        float(s) * 10.0**e for e, s in zip(range(-320, 0), rng.uniform(-10, 10, 320), strict=True)
    ]
    wide = rng.uniform(-1e5, 1e5, 3000).tolist()
    near = rng.uniform(-4.0, 4.0, 3000).tolist()
    return [*hard, *small, *wide, *near, WORST, 0.0, 1e5, -1e5, math.pi / 4, -math.pi / 4]


def test_sine_and_cosine_are_within_a_stated_number_of_ulps() -> None:
    for x in angles():
        for got, exact in zip(_kernel.sincos(x), (arb(x).sin(), arb(x).cos()), strict=True):
            error = abs(float(arb(got) - exact))
            # an exact value that rounds to 0 or to a subnormal has the spacing 2^-1074
            assert error <= ULPS * math.ulp(got), (x.hex(), got, float(exact))


def test_the_largest_error_that_was_seen_is_the_one_that_the_pages_say() -> None:
    error = abs(float(arb(_kernel.sincos(WORST)[1]) - arb(WORST).cos()))
    assert error == pytest.approx(ULPS * math.ulp(1.0) / 2.0, rel=1e-3)
    page = (ROOT / "docs" / "theory" / "rounding.md").read_text()
    assert f"{ULPS} units in the last place, in the cosine of {WORST}," in page


def test_exact_values_are_exact() -> None:
    assert _kernel.sincos(0.0) == (0.0, 1.0)


def test_symmetry_is_exact() -> None:
    for x in angles():
        s, c = _kernel.sincos(x)
        assert _kernel.sincos(-x) == (-s, c)


@pytest.mark.parametrize("x", [1.0000001e5, -2e5, math.inf, math.nan])
def test_an_angle_beyond_the_range_is_refused(x: float) -> None:
    with pytest.raises(_kernel.KernelError):
        _kernel.sincos(x)
