"""Numbers as arguments: what is accepted, and each refusal's words."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.bench.found_range import found_range
from modrobust.checks import as_integer, as_number
from modrobust.errors import ValueRangeError
from support.random_robots import random_robot
from support.states import state_of


@pytest.mark.parametrize(
    "value", [2, 2.0, True + 1, np.float32(2), np.int8(2), np.array(2.0), Fraction(2)]
)
def test_what_is_a_number_is_taken(value: object) -> None:
    number = as_number("x", value)
    assert (type(number) in (float, np.float64), number) == (True, 2.0)


def test_infinity_and_nan_are_for_the_caller_to_judge() -> None:
    assert as_number("x", math.inf) == math.inf
    assert math.isnan(as_number("x", np.float64("nan")))


@pytest.mark.parametrize(
    ("value", "unit", "message"),
    [
        ("abc", "s", "x: 'abc'; must be a number [s]"),
        ("1.5", "", "x: '1.5'; must be a number"),
        (None, "", "x: None; must be a number"),
        ([1.0], "", "x: [1.0]; must be a number"),
        (np.array([1.0]), "", "x: array([1.]); must be a number"),
        (np.array("1"), "", "x: array('1', dtype='<U1'); must be a number"),
        (1j, "", "x: 1j; must be a number"),
        (10**400, "", f"x: 1{'0' * 17}...{'0' * 19}; too large for a number"),
    ],
)
def test_what_is_no_number_is_refused(value: object, unit: str, message: str) -> None:
    with pytest.raises(ValueRangeError) as caught:
        as_number("x", value, unit)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (1.5, "k: 1.5; must be a whole number"),
        (1.0, "k: 1.0; must be a whole number"),
        ("1", "k: '1'; must be a whole number"),
        (None, "k: None; must be a whole number"),
        (0, "k: 0; must be at least 1"),
        (10, "k: 10; must be at most 9"),
    ],
)
def test_what_is_no_count_in_its_range_is_refused(value: object, message: str) -> None:
    with pytest.raises(ValueRangeError) as caught:
        as_integer("k", value, 1, 9)
    assert str(caught.value) == message


def test_both_ends_of_a_range_belong_to_it() -> None:
    assert (as_integer("k", 1, 1, 9), as_integer("k", np.int64(9), 1, 9)) == (1, 9)


@pytest.mark.parametrize("drives", [1, 0, None, "yes"])
def test_drives_are_true_or_false(drives: object) -> None:
    robot = random_robot(np.random.default_rng(0), 2)
    rest = np.zeros(2)
    given: Any = {"drives": drives}
    for call in (
        lambda: mr.inverse_dynamics(robot, rest, rest, rest, rest, **given),
        lambda: mr.inverse_dynamics_bounds(robot, rest, rest, rest, rest, **given),
        lambda: mr.inverse_dynamics_bounds_batch(robot, *state_of([rest[None]] * 4), **given),
        lambda: found_range(robot, *state_of([rest[None]] * 4), **given),
        lambda: mr.mass_matrix(robot, rest, **given),
        lambda: mr.forward_dynamics(robot, rest, rest, rest, **given),
    ):
        with pytest.raises(ValueRangeError, match=f"^drives: {drives!r}; must be True or False$"):
            call()
    with_numpy = mr.mass_matrix(robot, rest, drives=bool(np.True_))
    assert (with_numpy == mr.mass_matrix(robot, rest, drives=np.True_)).all()  # type: ignore[arg-type]


def test_absurd_counts_are_refused() -> None:
    robot = random_robot(np.random.default_rng(0), 2)
    with pytest.raises(ValueRangeError, match=r"^threads: 10+; must be at most 4096$"):
        mr.inverse_dynamics_bounds_batch(robot, *state_of(np.zeros((4, 1, 2))), threads=10**25)
    with pytest.raises(
        ValueRangeError, match=r"^duration: 1e\+308 s at 50000 Hz are more than 1e\+10 commands"
    ):
        mr.simulate(mr.load_robot("lwa4p-paper"), duration=1e308)
