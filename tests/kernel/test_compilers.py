"""One text, one arithmetic: every compiler and level computes the bits of the extension."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modrobust import _kernel
from modrobust.model import Robot
from support.kernel.kernel_cases import State, by_extension, by_native, differences, robots, states
from support.kernel.native import BOUNDS, Memory, Native, build, sincos
from support.states import doubles, state_of

CASES = 120
BUILDS = [
    (name, flags)
    for name in ("gcc", "clang")
    for flags in ("-O0", "-O1", "-O2", "-O3", "-O3 -march=native", "-O3 -fno-tree-vectorize")
]


@pytest.fixture(scope="module")
def expected() -> list[tuple[Robot, list[tuple[State, dict[str, Any]]]]]:
    rng = np.random.default_rng(0)
    return [
        (robot, [(state, by_extension(robot, state)) for state in states(rng, robot.n)])
        for robot in robots(1, CASES)
    ]


@pytest.fixture(scope="module")
def angles() -> list[float]:
    rng = np.random.default_rng(2)
    tiny = [float(x) * 10.0**e for e, x in enumerate(rng.uniform(-1, 1, 320), start=-319)]
    near = [k * np.pi / 2 for k in range(-63661, 63661, 331)]
    return [*rng.uniform(-1e5, 1e5, 1000), *near, *(x for x in tiny if abs(x) <= 1e5), 0.0, 5e-324]


def test_the_cases_hold_results_and_refusals(expected: Any) -> None:
    """So that equality below is about numbers, and about what an error leaves alone."""
    results = [results for _, cases in expected for _, results in cases]
    statuses = [status for result in results for status, _ in result.values()]
    assert statuses.count(0) > 1000
    assert statuses.count(_kernel.STATUS_NOT_FINITE) > 1000


@pytest.mark.parametrize(("name", "flags"), BUILDS)
def test_a_build_computes_the_same_bits(
    name: str, flags: str, expected: Any, angles: list[float], tmp_path: Path
) -> None:
    library = ctypes.CDLL(str(build(name, flags.split(), tmp_path)))
    wrong = []
    for robot, cases in expected:
        with Memory() as memory:
            native = Native(library, robot, memory)
            for state, results in cases:
                found = differences(results, by_native(native, state))
                wrong += [(robot.name, what) for what in found]
    assert wrong == []
    for x in angles:
        assert sincos(library, x) == _kernel.sincos(x), x.hex()


def test_a_row_of_the_batch_has_the_bits_of_the_single_call() -> None:
    """For every place in a register, for what is left over, and for every number of threads."""
    rng = np.random.default_rng(6)
    for robot in robots(7, 40):
        box = robot.model, robot.nominal.packed, robot.lower.packed, robot.upper.packed
        count, threads = int(rng.integers(1, 40)), int(rng.integers(1, 4))
        rows = state_of(rng.normal(size=(4, count, robot.n)) * 3.0)
        for code in BOUNDS.values():
            many = _kernel.inverse_dynamics_bounds_batch(*box, *rows, code, True, threads)
            for k in range(count):
                state = doubles(x[k] for x in rows)
                single = _kernel.inverse_dynamics_bounds(*box, *state, code, True)
                assert many[:, k].tobytes() == single.tobytes(), (robot.name, code, count, k)
