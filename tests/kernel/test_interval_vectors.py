"""The kernel's interval operations and its sine and cosine on the IEEE 1788 test vectors.

Taken are the vectors with finite bounds, in and out. A result contains the expected one and is at
each end at most WIDER ulps, or 2^-1021, further out; random operands against exact fractions too.
"""

from __future__ import annotations

import ctypes
import json
import math
import subprocess
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modrobust import _kernel
from support.kernel.native import FLAGS, FOLDER, compiler

Interval = tuple[float, float]
Operate = Callable[..., Interval]
HERE = Path(__file__).parent
VECTORS = HERE.parents[2] / "shared/data/itl_vectors.jsonl"
TINY = 2.0**-1021
WIDER = {"add": 2, "sub": 2, "mul": 2, "scale": 2, "fma": 4}
ANGLE_ULPS = 1  # more than the error of sine and cosine, see test_sincos.py


@pytest.fixture(scope="module")
def operations(tmp_path_factory: pytest.TempPathFactory) -> Operate:
    """Calls an operation of intervals.c by name."""
    path = tmp_path_factory.mktemp("intervals") / "intervals.so"
    command: list[str | Path] = [compiler("gcc"), *FLAGS, "-fPIC", "-shared", "-I", FOLDER]
    command += [HERE / "intervals.c", "-o", path]
    subprocess.run(command, check=True)
    library = ctypes.CDLL(str(path))

    def operate(name: str, *operands: Interval) -> Interval:
        out = (ctypes.c_double * 2)()
        library[name](*((ctypes.c_double * 2)(*x) for x in operands), out)
        return out[0], out[1]

    return operate


def fractions_of(ends: Interval) -> tuple[Fraction, Fraction]:
    return Fraction(ends[0]), Fraction(ends[1])


def exact(name: str, *operands: Interval) -> tuple[Fraction, Fraction]:
    """The range of an operation over its operands."""
    x, *rest = [tuple(map(Fraction, operand)) for operand in operands]
    if name == "sub":
        rest = [(-rest[0][1], -rest[0][0])]
    if name in ("add", "sub"):
        return x[0] + rest[0][0], x[1] + rest[0][1]
    products = [a * b for a in x for b in rest[0]]
    z = rest[1] if name == "fma" else (0, 0)
    return min(products) + z[0], max(products) + z[1]


def ways(op: str, operands: list[Interval]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """The kernel's ways to an operation of the vectors: names for `compute`, operands."""
    x = operands[0]
    if op in ("add", "sub", "mul", "fma"):
        yield op, tuple(operands)
    if op == "neg":
        yield "sub", ((0.0, 0.0), x)
    if op == "sqr" and not x[0] < 0 < x[1]:  # a square is more than a product of equals
        yield "mul", (x, x)
    if op == "mul" and x[0] == x[1]:
        yield "scale", tuple(operands)


def compute(
    operate: Callable[..., Interval], name: str, operands: tuple[Interval, ...]
) -> Interval:
    if name == "fma":
        x, y, z = operands
        return operate("add", operate("mul", x, y), z)
    return operate(name, *operands)


def unit(name: str, operands: tuple[Interval, ...], expected: Interval) -> float:
    """What WIDER counts: ulps of the result; of the largest term where there are several."""
    sizes = list(map(abs, expected))
    if name == "fma":
        x, y, z = operands
        sizes += [abs(a * b) for a in x for b in y] + list(map(abs, z))
    return math.ulp(max(sizes))


def assert_encloses(
    found: Interval, expected: tuple[Any, Any], ulps: float, what: tuple[Any, ...]
) -> None:
    steps = 2 if what[0] == "fma" else 1  # add of mul
    margin = max(Fraction(ulps), steps * Fraction(TINY))
    # an end that overflowed stands for the next number after the largest
    lo, hi = (
        Fraction(x) if math.isfinite(x) else Fraction(2) ** 1024 * (-1) ** (x < 0) for x in found
    )
    below, above = expected[0] - lo, hi - expected[1]
    assert 0 <= below <= margin, (what, found, expected)
    assert 0 <= above <= margin, (what, found, expected)


def vectors() -> list[tuple[str, list[Interval], Interval]]:
    """Operation, operands and result of the vectors whose intervals are all finite."""
    if not VECTORS.is_file():
        pytest.skip(f"{VECTORS.name} is not beside the checkout")
    out = []
    for line in VECTORS.read_text(encoding="utf-8").splitlines():
        vector = json.loads(line)
        intervals = [*vector["in"], *vector["out"]]
        if any(x["t"] != "I" for x in intervals):
            continue
        *operands, result = [(float.fromhex(x["lo"]), float.fromhex(x["hi"])) for x in intervals]
        if all(math.isfinite(end) for x in (*operands, result) for end in x):
            out.append((vector["op"], operands, result))
    return out


def test_the_operations_agree_with_the_vectors(operations: Operate) -> None:
    met: dict[str, int] = {}
    for op, operands, expected in vectors():
        for name, given in ways(op, operands):
            found = compute(operations, name, given)
            ulps = WIDER[name] * unit(name, given, expected)
            assert_encloses(found, fractions_of(expected), ulps, (name, given))
            met[name] = met.get(name, 0) + 1
    assert met == {"add": 10, "sub": 18, "mul": 40, "scale": 10, "fma": 32}


def test_sine_and_cosine_agree_with_the_vectors() -> None:
    """At points: the value give or take its stated error contains the tightest enclosure."""
    met = 0
    for op, ((lo, hi),), expected in [v for v in vectors() if v[0] in ("sin", "cos")]:
        if lo != hi or abs(lo) > _kernel.ANGLE_MAX:
            continue
        value = _kernel.sincos(lo)[op == "cos"]
        error = ANGLE_ULPS * math.ulp(value)
        found = value - error, value + error
        exact = fractions_of(expected)
        assert_encloses(found, exact, 2 * ANGLE_ULPS * math.ulp(value), (op, lo))
        met += 1
    assert met == 21


@pytest.mark.parametrize("name", ["add", "sub", "mul", "scale", "fma"])
def test_the_operations_enclose_exact_fractions(name: str, operations: Operate) -> None:
    """Of random operands, from subnormal to huge, with cancellation and zeros."""
    rng = np.random.default_rng(9)
    for _ in range(2000):
        scale = 2.0 ** rng.integers(-1074, 300, 3)
        ends = np.sort(rng.normal(size=(3, 2)) * scale[rng.integers(0, 3, 3)][:, None])
        ends[rng.random((3, 2)) < 0.05] = 0.0
        ends.sort()
        if name == "scale":
            ends[0, 1] = ends[0, 0]
        count = 3 if name == "fma" else 2
        given = tuple((float(lo), float(hi)) for lo, hi in ends[:count])
        expected = exact(name, *given)
        nearest = float(expected[0]), float(expected[1])
        ulps = (WIDER[name] + 1) * unit(name, given, nearest)
        assert_encloses(compute(operations, name, given), expected, ulps, (name, given))


@pytest.fixture(scope="module")
def boxes(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """Operations on middles and radii, boxes.c."""
    path = tmp_path_factory.mktemp("boxes") / "boxes.so"
    command: list[str | Path] = [compiler("gcc"), *FLAGS, "-fPIC", "-shared", "-I", FOLDER]
    command += [HERE / "boxes.c", "-o", path]
    subprocess.run(command, check=True)
    return ctypes.CDLL(str(path))


def test_a_product_of_middles_and_radii_is_the_range_of_its_corners(boxes: ctypes.CDLL) -> None:
    """Up to 16 u of its radius and 2 u of its middle, which (27) adds."""
    rng = np.random.default_rng(10)
    for _ in range(3000):
        middles = rng.normal(size=2) * 10.0 ** rng.integers(-3, 4, 2)
        radii = np.abs(rng.normal(size=2)) * 10.0 ** rng.integers(-6, 4, 2)
        radii[rng.random(2) < 0.1] = 0.0
        out = (ctypes.c_double * 2)()
        boxes.product_of(*map(ctypes.c_double, (middles[0], radii[0], middles[1], radii[1])), out)
        (x, y), (dx, dy) = (list(map(Fraction, pair.tolist())) for pair in (middles, radii))
        corners = [(x + s * dx) * (y + t * dy) for s in (-1, 1) for t in (-1, 1)]
        middle, radius = map(Fraction, out)
        most = (16 * radius + 2 * abs(x * y)) / 2**53
        assert abs(middle - radius - min(corners)) <= most
        assert abs(middle + radius - max(corners)) <= most


def test_boxes_turned_levered_and_summed_hold_their_errors(boxes: ctypes.CDLL) -> None:
    """Of the rotation, of the lever and of the sum, which the body's error mostly hides."""
    rng = np.random.default_rng(11)
    error, nearly = 27 * 2.0**-53, Fraction(1) - Fraction(1, 2**50)
    for _ in range(300):
        R, lever, x, y = (rng.normal(size=n) for n in (9, 3, 6, 6))
        x[3:], y[3:] = np.abs(x[3:]) * 1e-16, 0.0
        a, b, c = lever
        cross = np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
        around = Fraction(error) * sum(map(Fraction, np.abs(x).tolist()))
        for rows, function, given in (
            (R.reshape(3, 3), boxes.turned, R),
            (cross, boxes.moment, lever),
        ):
            out = np.zeros(6)
            first, second, third = (np.ctypeslib.as_ctypes(v) for v in (given, x, out))
            function(first, ctypes.c_double(error), second, third)
            for row, radius in zip(rows.tolist(), out[3:].tolist(), strict=True):
                terms = zip(row, x[3:].tolist(), strict=True)
                exact_radius = sum(abs(Fraction(k)) * Fraction(r) for k, r in terms)
                assert Fraction(radius) >= (exact_radius + around) * nearly
        total = y.copy()
        boxes.sum(np.ctypeslib.as_ctypes(x), np.ctypeslib.as_ctypes(total))
        for k in range(3):
            off = abs(Fraction(total[k]) - Fraction(x[k]) - Fraction(y[k]))
            assert Fraction(total[3 + k]) >= (Fraction(x[3 + k]) + off) * nearly
