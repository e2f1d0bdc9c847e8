"""What the kernel itself refuses once the checks of the package are passed by.

A controller in C has no other guard: numbers that are not finite and boxes that are none give a
status and leave the result alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.kernel import BOUNDS
from modrobust.model import synthetic_chain
from support.kernel.native import gains_of

ROBOT = synthetic_chain(3)
N = ROBOT.n
ZERO = np.zeros(N)
STATE = (ZERO,) * 4
NOMINAL, LOWER, UPPER = ROBOT.nominal.packed, ROBOT.lower.packed, ROBOT.upper.packed
DISTURBANCE = np.stack([ROBOT.disturbance.lo, ROBOT.disturbance.hi])
LAWS: dict[str, dict[str, Any]] = {
    "norm": {"law": "norm"},
    "hold-aware": {"law": "componentwise", "hold_aware": True},
    "sampled": {"law": "sampled", "G": 40.0, "delay": 1.0},
}
GAINS = {name: gains_of(mr.RobustController(ROBOT, **options)) for name, options in LAWS.items()}
HULL = _kernel.HULL
BAD = (np.nan, np.inf, -np.inf)


def status(call: Callable[..., Any], *arguments: Any) -> Any:
    """Status of a call, with the row of a batch; 0 where it answers."""
    try:
        call(*arguments)
    except _kernel.KernelError as problem:
        return problem.args
    return 0


def bounds(lower: Any, nominal: Any, upper: Any, disturbance: Any) -> Iterator[Any]:
    """Status of every function that is given a box of parameters."""
    box = (ROBOT.model, nominal, lower, upper)
    for code in BOUNDS.values():
        yield status(_kernel.inverse_dynamics_bounds, *box, *STATE, code, True)
        yield status(_kernel.perturbation_bounds, *box, disturbance, *STATE, code)
        yield status(
            _kernel.inverse_dynamics_bounds_batch, *box, *(x[None] for x in STATE), code, True, 1
        )[:1]
        for gains in GAINS.values():
            controller = _kernel.Controller(*box, disturbance, {**gains, "bound": code})
            yield status(controller.command, 0.0, *STATE, ZERO)
    yield status(_kernel.bounds_slack, *box, *STATE, True)


def spoilt(values: Any, at: int, value: float) -> Any:
    other = np.array(values)
    other[at] = value
    return other


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("vector", range(4))
def test_a_state_that_is_not_finite_gives_no_torque(vector: int, value: float) -> None:
    state = [spoilt(ZERO, 1, value) if k == vector else ZERO for k in range(4)]
    rows = [np.stack([ZERO, x]) for x in state]
    box = (ROBOT.model, NOMINAL, LOWER, UPPER)
    wrong = (_kernel.STATUS_NOT_FINITE,)
    assert status(_kernel.inverse_dynamics, *box[:2], *state, True) == wrong
    assert status(_kernel.inverse_dynamics_rounding, *box[:2], *state, True) == wrong
    assert status(_kernel.bounds_slack, *box, *state, True) == wrong
    for code in BOUNDS.values():
        batch = _kernel.inverse_dynamics_bounds_batch
        assert status(_kernel.inverse_dynamics_bounds, *box, *state, code, True) == wrong
        assert status(_kernel.perturbation_bounds, *box, DISTURBANCE, *state, code) == wrong
        assert status(batch, *box, *rows, code, True, 1) == (*wrong, 1)
    if vector < 3:
        assert status(_kernel.forward_dynamics, *box[:2], *state[:3], True) == wrong
    if vector == 0:
        assert status(_kernel.mass_matrix, *box[:2], state[0], True) == wrong
        assert status(_kernel.forward_kinematics, ROBOT.model, state[0]) == wrong


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("signal", range(6))
@pytest.mark.parametrize("law", LAWS)
def test_a_signal_that_is_not_finite_gives_no_command(law: str, signal: int, value: float) -> None:
    controller = mr.RobustController(ROBOT, **LAWS[law]).kernel
    signals: list[Any] = [0.0, *(ZERO,) * 5]
    signals[signal] = value if signal == 0 else spoilt(ZERO, 1, value)
    assert status(controller.command, *signals) == (_kernel.STATUS_NOT_FINITE,)


def test_the_box_as_it_is_has_bounds() -> None:
    """So that each refusal below is due to what it changes."""
    box = (ROBOT.model, NOMINAL, LOWER, UPPER)
    assert status(_kernel.inverse_dynamics_bounds, *box, *STATE, HULL, True) == 0
    assert status(_kernel.bounds_slack, *box, *STATE, True) == 0


@pytest.mark.parametrize("at", range(NOMINAL.size))
def test_a_box_that_is_none_has_no_bounds(at: int) -> None:
    """Ends the wrong way round, a nominal value outside, an end that is not finite, each entry."""
    above = max(UPPER[at], NOMINAL[at]) + 1.0
    below = min(LOWER[at], NOMINAL[at]) - 1.0
    boxes = [
        (spoilt(LOWER, at, above), NOMINAL, UPPER),
        (LOWER, NOMINAL, spoilt(UPPER, at, below)),
        (LOWER, spoilt(NOMINAL, at, above), UPPER),
        (LOWER, spoilt(NOMINAL, at, below), UPPER),
        (spoilt(LOWER, at, -np.inf), NOMINAL, UPPER),
        (LOWER, NOMINAL, spoilt(UPPER, at, np.inf)),
        (spoilt(LOWER, at, np.nan), NOMINAL, UPPER),
        (LOWER, spoilt(NOMINAL, at, np.nan), UPPER),
        (LOWER, NOMINAL, spoilt(UPPER, at, np.nan)),
    ]
    for lower, nominal, upper in boxes:
        assert set(bounds(lower, nominal, upper, DISTURBANCE)) == {(_kernel.STATUS_NOT_FINITE,)}


@pytest.mark.parametrize("part", ["mass", "rotor_inertia", "viscous", "coulomb"])
def test_a_box_with_negative_masses_or_friction_has_no_bounds(part: str) -> None:
    b, j = ROBOT.b, ROBOT.j
    at = {"mass": 0, "rotor_inertia": 10 * b, "viscous": 10 * b + j, "coulomb": 10 * b + 2 * j}
    lower = spoilt(LOWER, at[part], -1e-9)
    assert set(bounds(lower, NOMINAL, UPPER, DISTURBANCE)) == {(_kernel.STATUS_NOT_FINITE,)}


@pytest.mark.parametrize("rows", [([1.0], [-1.0]), ([-np.inf], [1.0]), ([-1.0], [np.nan])])
def test_a_disturbance_that_is_no_interval_has_no_bounds(rows: Any) -> None:
    disturbance = np.repeat(np.array(rows), N, axis=1)
    box = (ROBOT.model, NOMINAL, LOWER, UPPER, disturbance)
    wrong = (_kernel.STATUS_NOT_FINITE,)
    for code in BOUNDS.values():
        assert status(_kernel.perturbation_bounds, *box, *STATE, code) == wrong
        for gains in GAINS.values():
            controller = _kernel.Controller(*box, {**gains, "bound": code})
            assert status(controller.command, 0.0, *STATE, ZERO) == wrong
