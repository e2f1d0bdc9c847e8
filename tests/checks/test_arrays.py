"""Arguments of the numerical functions: what is accepted, and the wording of what is not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.checks import as_indices
from modrobust.errors import InputError, ValueRangeError
from modrobust.model import Bounded
from support.random_robots import random_robot
from support.states import state_of

ROBOT = replace(random_robot(np.random.default_rng(1), types="rrp"), name="arm3")
ZERO = np.zeros(3)


@pytest.mark.parametrize(
    ("q", "message"),
    [
        (np.zeros(4), 'q: expected shape (3,), got (4,); robot "arm3" has 3 joints'),
        (np.zeros((3, 1)), 'q: expected shape (3,), got (3, 1); robot "arm3" has 3 joints'),
        (0.0, 'q: expected shape (3,), got a single number; robot "arm3" has 3 joints'),
        ([], 'q: expected shape (3,), got (0,); robot "arm3" has 3 joints'),
        ([0.0, np.nan, 0.0], "q[1] is nan; every entry must be finite"),
        ([0.0, 0.0, -np.inf], "q[2] is -inf; every entry must be finite"),
        ("abc", "q: holds text; expected 3 numbers"),
        (["1", "2", "3"], "q: holds text; expected 3 numbers"),
        ([True, False, True], "q: holds truth values; expected 3 numbers"),
        ([0j, 0.0, 0.0], "q: holds complex entries; expected 3 numbers"),
        (np.zeros(3, "M8[s]"), "q: holds dates; expected 3 numbers"),
        (np.zeros(3, "m8[s]"), "q: holds spans of time; expected 3 numbers"),
        ([0.0, None, 0.0], "q: holds None; expected 3 numbers"),
        ([0.0, {}, 0.0], "q: holds {}; expected 3 numbers"),
        (
            np.ma.masked_array([0.0, 0.0, 0.0], [False, True, False]),
            "q: is a masked array; expected 3 numbers; fill it",
        ),
    ],
)
def test_a_wrong_vector_is_refused_in_these_words(q: Any, message: str) -> None:
    with pytest.raises(InputError) as caught:
        mr.inverse_dynamics(ROBOT, q, ZERO, ZERO, ZERO)
    assert str(caught.value) == message


@pytest.mark.parametrize("position", range(4))
def test_the_message_names_the_argument(position: int) -> None:
    state = [ZERO, ZERO, ZERO, ZERO]
    state[position] = np.zeros(2)
    name = ("q", "dq", "dq_a", "ddq_a")[position]
    with pytest.raises(InputError, match=rf"^{name}: expected shape \(3,\), got \(2,\)"):
        mr.perturbation_bounds(ROBOT, *state_of(state))


def test_an_unknown_method_is_refused_with_those_known() -> None:
    with pytest.raises(InputError, match="hull, ianea"):
        mr.inverse_dynamics_bounds(ROBOT, ZERO, ZERO, ZERO, ZERO, bound="hul")


def test_parameters_of_another_robot_are_refused() -> None:
    other = random_robot(np.random.default_rng(2), types="rr").nominal
    for call in (
        lambda: mr.inverse_dynamics(ROBOT, ZERO, ZERO, ZERO, ZERO, parameters=other),
        lambda: mr.mass_matrix(ROBOT, ZERO, parameters=other),
        lambda: mr.forward_dynamics(ROBOT, ZERO, ZERO, ZERO, parameters=other),
    ):
        with pytest.raises(InputError, match='robot "arm3" has'):
            call()


def test_lists_integers_and_strided_views_give_the_same_torque() -> None:
    q = np.array([1.0, 9.0, -2.0, 9.0, 3.0, 9.0])
    expected = mr.inverse_dynamics(ROBOT, [1.0, -2.0, 3.0], ZERO, ZERO, ZERO)
    for same in (
        q[::2],
        (1, -2, 3),
        np.array([1, -2, 3], np.int64),
        np.array([1, -2, 3], np.float32),
    ):
        tau = mr.inverse_dynamics(ROBOT, same, ZERO, ZERO, ZERO)
        np.testing.assert_array_equal(tau, expected)


def test_arguments_are_left_alone_and_each_result_is_a_new_array() -> None:
    q = np.array([0.3, 0.2, 0.1])
    q.setflags(write=False)
    first = mr.inverse_dynamics(ROBOT, q, q, q, q)
    kept = first.copy()
    second = mr.inverse_dynamics(ROBOT, q, q, q, q)
    second[:] = 0.0
    np.testing.assert_array_equal(first, kept)


@pytest.mark.parametrize("speed", [1e154, 1e160, 1e300])
@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_a_result_beyond_the_range_of_doubles_is_an_error_and_never_a_bound(
    speed: float, bound: str
) -> None:
    fast = np.full(3, speed)
    with pytest.raises(InputError, match="not finite"):
        mr.inverse_dynamics(ROBOT, ZERO, fast, fast, ZERO)
    with pytest.raises(InputError, match="not finite"):
        mr.inverse_dynamics_bounds(ROBOT, ZERO, fast, fast, ZERO, bound=bound)


def test_large_whole_numbers_stay_what_they_are() -> None:
    far = 2**32 + 5
    box = Bounded(np.array([0]), np.array([-far]), np.array([far]))
    assert (box.lo[0], box.hi[0]) == (-far, far)
    with pytest.raises(ValueRangeError, match=r"^leaders: holds 4294967301; an index must lie in"):
        as_indices("leaders", np.array([far]))
