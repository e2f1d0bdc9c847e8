"""Bounds of many states at once: bit for bit those of one at a time, in whatever registers."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import Robot
from support.paths import ROOT
from support.random_robots import random_robot, tied
from support.states import State, state_of

BOUNDS = ["hull", "ianea"]
COUNTS = [0, 1, 7, 8, 9, 1000]
SHAPES: list[dict[str, Any]] = [
    {"simple": True, "n": 6},
    {"simple": True, "types": "rprp"},
    {"simple": False, "types": "ppp"},
    {"simple": False, "n": 1},
    {"simple": False, "n": 7, "width": "mixed"},
    {"simple": False, "n": 6, "width": "exact"},
    {"simple": False, "n": 12},
    {"simple": False, "n": 9, "tree": True},
]


def states(rng: np.random.Generator, k: int, n: int) -> State:
    """Q, dQ, dQ_a, ddQ_a (k, n): at rest, slow and fast, angles of many turns, zeros."""
    Q = rng.uniform(-1.0, 1.0, (k, n)) * rng.choice([0.0, np.pi, 1e5], (k, 1))
    rates = rng.normal(size=(3, k, n)) * rng.choice([0.0, 1e-5, 1.0, 30.0], (1, k, 1))
    rates[rng.random(rates.shape) < 0.1] = 0.0
    return Q, rates[0], rates[1], rates[2]


def one_by_one(robot: Robot, rows: State, bound: str, drives: bool) -> Any:
    """(2, k, n) by the single call."""
    found = [
        mr.inverse_dynamics_bounds(robot, *state_of(row), bound=bound, drives=drives)
        for row in zip(*rows, strict=True)
    ]
    return np.array(found).reshape(-1, 2, robot.n).swapaxes(0, 1)


@pytest.mark.parametrize("bound", BOUNDS)
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_a_batch_has_the_bits_of_the_single_call(shape: dict[str, Any], bound: str) -> None:
    rng = np.random.default_rng(1)
    for drives in (False, True):
        robot = random_robot(rng, **shape)
        rows = states(rng, 1000, robot.n)
        expected = one_by_one(robot, rows, bound, drives)
        for k in COUNTS:
            part = state_of(a[:k] for a in rows)
            for threads in (1, 2, 5):
                bounds = mr.inverse_dynamics_bounds_batch(
                    robot, *part, bound=bound, drives=drives, threads=threads
                )
                assert [side.shape for side in bounds] == [(k, robot.n)] * 2
                assert np.array(bounds).tobytes() == expected[:, :k].tobytes()


@pytest.mark.parametrize("bound", BOUNDS)
def test_a_batch_has_the_bits_of_the_single_call_where_mimic_joints_move(bound: str) -> None:
    rng = np.random.default_rng(2)
    shapes = ({"types": "rprpr"}, {"n": 8, "tree": True}, {"types": "rrprr"})
    for shape, anywhere in zip(shapes, (False, False, True), strict=True):
        robot = tied(random_robot(rng, **shape), 3, rng, anywhere)  # type: ignore[arg-type]
        rows = states(rng, 100, robot.n)
        rows[0][:] *= 0.1  # a mimic joint turns up to twice as far
        bounds = mr.inverse_dynamics_bounds_batch(robot, *rows, bound=bound, threads=2)
        np.testing.assert_array_equal(bounds, one_by_one(robot, rows, bound, True))


def test_a_batch_takes_integers_lists_and_arrays_of_any_layout() -> None:
    rng = np.random.default_rng(3)
    robot = random_robot(rng, 4)
    rows = states(rng, 30, 4)
    strange = (
        np.asfortranarray(rows[0]),
        np.repeat(rows[1], 2, axis=0)[::2],
        rows[2][::-1][::-1].tolist(),
        np.hstack([rows[3], rows[3]])[:, :4],
    )
    expected = mr.inverse_dynamics_bounds_batch(robot, *rows)
    np.testing.assert_array_equal(mr.inverse_dynamics_bounds_batch(robot, *strange), expected)
    whole = state_of(np.round(3 * a / (1 + np.abs(a))).astype(int) for a in rows)
    np.testing.assert_array_equal(
        mr.inverse_dynamics_bounds_batch(robot, *whole),
        one_by_one(robot, whole, "hull", True),
    )
    narrow = state_of(a.astype(np.float32) for a in whole)
    np.testing.assert_array_equal(
        mr.inverse_dynamics_bounds_batch(robot, *narrow),
        mr.inverse_dynamics_bounds_batch(robot, *whole, threads=None),
    )


ROBOT = random_robot(np.random.default_rng(4), types="rrp")
ZEROS = np.zeros((20, 3))


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"Q": np.zeros(3)}, "Q: expected shape (3, 3), got (3,); "),
        ({"Q": 0.0}, "Q: expected shape (0, 3), got a single number; "),
        ({"Q": np.zeros((20, 4))}, "Q: expected shape (20, 3), got (20, 4); "),
        ({"dQ": np.zeros((19, 3))}, "dQ: expected shape (20, 3), got (19, 3); "),
        ({"dQ_a": np.zeros((3, 20))}, "dQ_a: expected shape (20, 3), got (3, 20); "),
        ({"ddQ_a": np.zeros((20, 3, 1))}, "ddQ_a: expected shape (20, 3), got (20, 3, 1); "),
    ],
)
def test_a_wrong_shape_names_the_argument(given: dict[str, Any], text: str) -> None:
    rows = {"Q": ZEROS, "dQ": ZEROS, "dQ_a": ZEROS, "ddQ_a": ZEROS, **given}
    with pytest.raises(ShapeError) as caught:
        mr.inverse_dynamics_bounds_batch(ROBOT, *rows.values())
    assert str(caught.value).startswith(text)
    assert str(caught.value).endswith(f'robot "{ROBOT.name}" has 3 joints')


@pytest.mark.parametrize("row", [0, 7, 8, 19])
@pytest.mark.parametrize("threads", [1, 3])
def test_an_input_that_is_refused_is_named_with_its_row(row: int, threads: int) -> None:
    def message(at: int, value: float, **more: Any) -> str:
        rows = state_of(ZEROS.copy() for _ in range(4))
        rows[at][row, 1] = value
        for index, other in more.get("also", ()):
            rows[at][index, 0] = other
        with pytest.raises(ValueRangeError) as caught:
            mr.inverse_dynamics_bounds_batch(ROBOT, *rows, threads=threads)
        return str(caught.value)

    for at, name in enumerate(("Q", "dQ", "dQ_a", "ddQ_a")):
        assert message(at, np.nan) == f"{name}[{row}][1] is nan; every entry must be finite"
        assert message(at, -np.inf) == f"{name}[{row}][1] is -inf; every entry must be finite"
    assert message(0, -2e5) == (
        f"Q[{row}][1] = -200000: a joint angle is beyond 100000 rad; reduce it by whole turns"
    )
    overflow = "is the largest input; the result is not finite; the inputs are too large"
    assert message(3, 1e280) == f"ddQ_a[{row}][1] = 1e+280 {overflow}"
    if row < 19:  # the first row that fails is told, not the largest of all
        assert message(3, 1e280, also=[(19, 1e290)]) == f"ddQ_a[{row}][1] = 1e+280 {overflow}"


def test_unknown_methods_and_thread_counts_are_refused() -> None:
    rows = [ZEROS] * 4
    for options, text in (
        ({"bound": "best"}, "bound: 'best' is not known; known: hull, ianea"),
        ({"threads": 0}, "threads: 0"),
        ({"threads": 1.5}, "threads: 1.5"),
    ):
        with pytest.raises(ValueRangeError, match=text):
            mr.inverse_dynamics_bounds_batch(ROBOT, *rows, **options)  # type: ignore[arg-type]


def test_other_threads_run_while_a_batch_is_computed() -> None:
    robot = random_robot(np.random.default_rng(5), 12)
    rows = states(np.random.default_rng(6), 20_000, 12)
    box = robot.nominal.packed, robot.lower.packed, robot.upper.packed
    stop, steps = threading.Event(), [0]

    def count() -> None:
        while not stop.wait(1e-3):
            steps[0] += 1

    other = threading.Thread(target=count)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(100.0)  # [s]: nobody is interrupted; the other runs where it is let
    try:
        other.start()
        before = steps[0]
        _kernel.inverse_dynamics_bounds_batch(robot.model, *box, *rows, _kernel.HULL, True, 1)
        during = steps[0] - before
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        other.join()
    assert during > 0


def test_as_many_threads_as_asked_for_are_used() -> None:
    robot = random_robot(np.random.default_rng(5), 12)
    rows = state_of(np.random.default_rng(k).normal(size=(30_000, 12)) for k in range(4))
    tasks = Path("/proc/self/task")
    if not tasks.is_dir():
        pytest.skip("threads are counted in /proc")
    done, most = threading.Event(), [0]

    def watch() -> None:
        while not done.is_set():
            most[0] = max(most[0], len(list(tasks.iterdir())))

    watcher = threading.Thread(target=watch)
    watcher.start()
    before = len(list(tasks.iterdir()))
    mr.inverse_dynamics_bounds_batch(robot, *rows, threads=3)
    done.set()
    watcher.join()
    assert most[0] >= before + 2


WITHOUT_THREADS = """
import resource, sys
import numpy as np
import modrobust as mr
from support.random_robots import random_robot
from dynamics.test_batch import states

robot = random_robot(np.random.default_rng(5), 6)
rows = states(np.random.default_rng(6), 500, 6)
expected = mr.inverse_dynamics_bounds_batch(robot, *rows, threads=1)
pages = int(open("/proc/self/statm").read().split()[0])
room = 24 << 20  # [B]: less than the stacks of the threads, 8 MiB each
limit = pages * resource.getpagesize() + room
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
found = mr.inverse_dynamics_bounds_batch(robot, *rows, threads=60)
assert np.array(found).tobytes() == np.array(expected).tobytes()
"""


@pytest.mark.skipif(not Path("/proc/self/statm").is_file(), reason="needs Linux's memory figures")
def test_where_no_thread_starts_the_calling_thread_does_its_part() -> None:
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_THREADS],
        env={**os.environ, "PYTHONPATH": str(ROOT / "tests")},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
