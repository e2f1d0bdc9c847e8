"""The binding refuses arrays that do not belong together, if the package lets them through.

Without these checks a slip in the package would read beyond an array.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.model import synthetic_chain
from support.kernel.native import gains_of
from support.loops import make_loop

ROBOT = synthetic_chain(3)
N = ROBOT.n
ZERO = np.zeros(N)
ROWS = np.zeros((2, N))
BOX = (ROBOT.nominal.packed, ROBOT.lower.packed, ROBOT.upper.packed)
DISTURBANCE = np.zeros((2, N))
STATE = (ZERO,) * 4
OWN = mr.RobustController(ROBOT)
CONTROLLER = OWN.kernel


def parts(**changes: Any) -> list[Any]:
    """Arguments of a model of two revolute joints in a row with one body each."""
    eye = np.tile(np.eye(4), (2, 1, 1))
    whole = {
        "joint_type": np.zeros(2, np.int32),
        "parent": np.array([-1, 0], np.int32),
        "before": eye,
        "after": eye,
        "gravity": np.zeros(3),
        "body_joint": np.array([0, 1], np.int32),
        "placement": eye,
        "inertia_about": np.zeros(2, np.int32),
        "gear_ratio": np.ones(2),
        "coulomb_speed": np.ones(2),
        "moves": np.arange(2, dtype=np.int32),
        "leader": np.zeros(0, np.int32),
        "multiplier": np.zeros(0),
        "offset": np.zeros(0),
        "wraps": np.zeros(2, np.int32),
    }
    return list({**whole, **changes}.values())


def test_a_model_of_two_joints_is_made() -> None:
    """So that each refusal below is due to what it changes."""
    assert (_kernel.Model(*parts()).n, _kernel.Model(*parts()).b) == (2, 2)


LENGTHS = "arrays of joints and bodies differ in length"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parent": np.array([-1], np.int32)}, LENGTHS),
        ({"before": np.eye(4)[None]}, LENGTHS),
        ({"after": np.eye(4)[None]}, LENGTHS),
        ({"gravity": np.zeros(2)}, LENGTHS),
        ({"placement": np.eye(4)[None]}, LENGTHS),
        ({"gear_ratio": np.ones(3)}, LENGTHS),
        ({"coulomb_speed": np.ones(1)}, LENGTHS),
        ({"multiplier": np.ones(1)}, LENGTHS),
        ({"offset": np.ones(1)}, LENGTHS),
        ({name: np.zeros(2, np.int32) for name in ("leader", "multiplier", "offset")}, LENGTHS),
        ({"parent": np.array([-1, 1], np.int32)}, "a joint's parent must come before it"),
        ({"parent": np.array([-2, 0], np.int32)}, "a joint's parent must come before it"),
        ({"joint_type": np.array([0, 2], np.int32)}, "joint types are 0"),
        ({"body_joint": np.array([0, 2], np.int32)}, "a body's joint must exist"),
        ({"body_joint": np.array([0, -2], np.int32)}, "a body's joint must exist"),
    ],
)
def test_a_model_of_arrays_that_do_not_fit_is_refused(
    changes: dict[str, Any], message: str
) -> None:
    changes = {
        name: value.astype(float) if name in ("multiplier", "offset") else value
        for name, value in changes.items()
    }
    with pytest.raises(ValueError, match=message):
        _kernel.Model(*parts(**changes))


@pytest.mark.parametrize("leader", [-1, 1])
def test_a_leader_must_be_a_free_joint(leader: int) -> None:
    mimic = {"leader": np.array([leader], np.int32), "multiplier": np.ones(1), "offset": ZERO[:1]}
    with pytest.raises(ValueError, match="a leader is a free joint"):
        _kernel.Model(*parts(**mimic))


@pytest.mark.parametrize("at", range(4))
def test_a_state_of_another_length_is_refused(at: int) -> None:
    q, dq, dq_a, ddq_a = [np.zeros(N + 1) if k == at else ZERO for k in range(4)]
    with pytest.raises(ValueError, match="expected 3 entries, got 4"):
        _kernel.inverse_dynamics(ROBOT.model, BOX[0], q, dq, dq_a, ddq_a, True)


def test_parameters_of_another_length_are_refused() -> None:
    with pytest.raises(ValueError, match="wrong packed length"):
        _kernel.inverse_dynamics(ROBOT.model, BOX[0][:-1], *STATE, True)


def test_a_method_or_a_law_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="0 \\(hull\\) or 1 \\(ianea\\)"):
        _kernel.inverse_dynamics_bounds(ROBOT.model, *BOX, *STATE, 2, True)
    with pytest.raises(ValueError, match="0 \\(hull\\) or 1 \\(ianea\\)"):
        _kernel.inverse_dynamics_bounds(ROBOT.model, *BOX, *STATE, -1, True)


@pytest.mark.parametrize("shape", [(3, N), (2, N + 1)])
def test_rows_of_another_shape_are_refused(shape: tuple[int, int]) -> None:
    other = np.zeros(shape)
    with pytest.raises(ValueError, match="expected shape \\(k, n\\)"):
        _kernel.inverse_dynamics_bounds_batch(
            ROBOT.model, *BOX, ROWS, ROWS, ROWS, other, _kernel.HULL, True, 1
        )
    with pytest.raises(ValueError, match="expected shape \\(k, n\\)"):
        CONTROLLER.time_commands(np.zeros(2), ROWS, ROWS, ROWS, ROWS, other)
    loop = make_loop(OWN)
    with pytest.raises(ValueError, match="expected shape \\(k, n\\)"):
        loop.advance(ROWS, ROWS, other, 1)


def test_a_batch_without_threads_is_refused() -> None:
    with pytest.raises(ValueError, match="threads must be positive"):
        _kernel.inverse_dynamics_bounds_batch(
            ROBOT.model, *BOX, ROWS, ROWS, ROWS, ROWS, _kernel.HULL, True, 0
        )


@pytest.mark.parametrize("shape", [(1, N), (2, N - 1)])
def test_a_disturbance_of_another_shape_is_refused(shape: tuple[int, int]) -> None:
    other = np.zeros(shape)
    with pytest.raises(ValueError, match="disturbance"):
        _kernel.perturbation_bounds(ROBOT.model, *BOX, other, *STATE, _kernel.HULL)
    with pytest.raises(ValueError, match="disturbance"):
        _kernel.Controller(ROBOT.model, *BOX, other, gains_of(OWN))


@pytest.mark.parametrize(
    ("dt", "substeps"), [(0.0, 1), (-1.0, 1), (np.inf, 1), (np.nan, 1), (1, 0)]
)
def test_a_loop_without_a_step_is_refused(dt: float, substeps: int) -> None:
    with pytest.raises(ValueError, match="dt"):
        make_loop(OWN, dt=dt, substeps=substeps)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"law": 3}, "law: 0 "),
        ({"law": -1}, "law: 0 "),
        ({"bound": 2}, "0 \\(hull\\) or 1 \\(ianea\\)"),
        ({"K_r": np.ones(N + 1)}, "K_r: wrong length"),
        ({"effort_limit": np.ones(N - 1)}, "effort_limit: wrong length"),
        ({"centre": BOX[0][:-1]}, "centre: wrong length"),
        ({"light": np.append(BOX[0], 0.0)}, "light: wrong length"),
    ],
)
def test_gains_that_do_not_fit_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _kernel.Controller(ROBOT.model, *BOX, DISTURBANCE, {**gains_of(OWN), **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"delay": -0.1}, "delay lies in"),
        ({"delay": 1.5}, "delay lies in"),
        ({"delay": np.nan}, "delay lies in"),
        ({"noise_position": np.zeros(N + 1)}, "noise_position: expected 3 entries, got 4"),
        ({"quantisation_velocity": np.zeros(1)}, "quantisation_velocity: expected 3 entries"),
        ({"noise_seed": (0, 0)}, "both words are 0"),
        ({"disturbance": 4}, "disturbance: 0 to 3"),
        ({"disturbance": -1}, "disturbance: 0 to 3"),
    ],
)
def test_a_loop_that_does_not_fit_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make_loop(OWN, **changes)


def test_memory_of_another_length_is_refused() -> None:
    controller: Any = mr.RobustController(ROBOT).kernel
    *numbers, remembered = controller.memory()[:6]
    with pytest.raises(ValueError, match="memory: wrong length"):
        controller.recall(*numbers, remembered[:-1], *controller.memory()[6:])
