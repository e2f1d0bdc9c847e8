"""Comparisons from Python: Pinocchio's own binding, and Algorithm 1 written out in NumPy."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np

from modrobust.bench.peers.cases import States, random_states, uncertain_everywhere
from modrobust.bench.peers.native import DISAGREEMENT, depth_first, require_comparable
from modrobust.bench.peers.timing import Comparison, interleaved
from modrobust.checks.types import Array
from modrobust.control import RobustController
from modrobust.dynamics import inverse_dynamics, inverse_dynamics_bounds
from modrobust.errors import MissingExtraError, ValueRangeError
from modrobust.model import Robot
from modrobust.model.physical import inertia_about_com
from modrobust.reference import box, newton_euler

ROUNDS = 15
PINOCCHIO = "Pinocchio, pin.rnea"
TRANSCRIPTION = "NumPy, NE*"
INTERVALS = "NumPy, IANEA*"


def pinocchio_python(robot: Robot, states: int = 200) -> Comparison:
    """Our functions against ``pin.rnea`` through the wheel's binding.

    Raises:
        MissingExtraError: The package pin is not installed.
        ValueRangeError: The robot has mimic joints, or the two do not agree.
    """
    require_comparable(robot)
    try:
        import pinocchio
    except ModuleNotFoundError:
        raise MissingExtraError(
            "comparison with Pinocchio from Python: the package pin is not installed; "
            'install it with pip install "modrobust[peers]"'
        ) from None
    model, order = _twin(pinocchio, robot)
    data = model.createData()
    s = random_states(robot, states)
    # In Pinocchio's order before the clock runs.
    rows = [np.ascontiguousarray(x[:, order]) for x in (s.q, s.dq, s.ddq_des)]

    def theirs(k: int) -> Array:
        torque = np.empty(robot.n)
        torque[order] = pinocchio.rnea(model, data, *(x[k] for x in rows))
        return torque

    def run_theirs() -> None:
        for q, dq, a in zip(*rows, strict=True):
            pinocchio.rnea(model, data, q, dq, a)

    subjects: dict[str, Callable[[], None]] = {PINOCCHIO: run_theirs, **_ours(robot, s)}
    return Comparison(
        "one call at a time, bounds and commands with every body uncertain",
        interleaved(subjects, states, ROUNDS),
        PINOCCHIO,
        _disagreement(robot, s, theirs),
    )


def numpy_transcription(robot: Robot, states: int = 10) -> Comparison:
    """Our functions against Algorithm 1 written line by line in NumPy, `modrobust.reference`.

    Raises:
        ValueRangeError: The robot has mimic joints, or the two do not agree.
    """
    require_comparable(robot)
    s = random_states(robot, states)
    everywhere = uncertain_everywhere(robot)
    boxes = box(everywhere)

    def line_by_line(parameters: Any) -> None:
        for q, dq, dq_a, a in zip(s.q, s.dq, s.dq_des, s.ddq_des, strict=True):
            newton_euler(robot, parameters, q, dq, dq_a, a)

    def theirs(k: int) -> Any:
        return newton_euler(robot, robot.nominal, s.q[k], s.dq[k], s.dq[k], s.ddq_des[k])

    subjects: dict[str, Callable[[], None]] = {
        TRANSCRIPTION: partial(line_by_line, robot.nominal),
        INTERVALS: partial(line_by_line, boxes),
        **_ours(robot, s),
    }
    return Comparison(
        "one call at a time, bounds and commands with every body uncertain",
        interleaved(subjects, states, 5),
        TRANSCRIPTION,
        _disagreement(robot, s, theirs),
    )


def _ours(robot: Robot, s: States) -> dict[str, Callable[[], None]]:
    everywhere = uncertain_everywhere(robot)

    def nominal() -> None:
        for q, dq, a in zip(s.q, s.dq, s.ddq_des, strict=True):
            inverse_dynamics(robot, q, dq, dq, a)

    def bounds(bound: str) -> None:
        for q, dq, dq_a, a in zip(s.q, s.dq, s.dq_des, s.ddq_des, strict=True):
            inverse_dynamics_bounds(everywhere, q, dq, dq_a, a, bound)

    def command(bound: str) -> None:
        controller = RobustController(everywhere, bound=bound)
        rows = zip(s.q, s.dq, s.q_des, s.dq_des, s.ddq_des, strict=True)
        for k, row in enumerate(rows):
            controller.command(1e-3 * k, *row)

    return {
        "inverse_dynamics": nominal,
        "bounds, hull": partial(bounds, "hull"),
        "bounds, ianea": partial(bounds, "ianea"),
        "command, hull": partial(command, "hull"),
        "command, ianea": partial(command, "ianea"),
    }


def _disagreement(robot: Robot, s: States, theirs: Callable[[int], Any]) -> float:
    ours = [
        inverse_dynamics(robot, q, dq, dq, a) for q, dq, a in zip(s.q, s.dq, s.ddq_des, strict=True)
    ]
    expected = np.array([theirs(k) for k in range(len(ours))])
    found = float(np.abs(np.array(ours) - expected).max() / np.abs(expected).max())
    if not found <= DISAGREEMENT:
        raise ValueRangeError(
            f"{robot.name}: our torques and the other's differ by {found:g} of the largest; "
            f"{DISAGREEMENT:g} is allowed. Their times cannot be compared"
        )
    return found


def _twin(pin: ModuleType, robot: Robot) -> tuple[Any, list[int]]:
    """The robot in Pinocchio, joint by joint, and our joints in its order.

    Pinocchio's joint frame lies before our ``after``, so that bodies and children carry it.
    """

    def se3(T: Array) -> Any:
        return pin.SE3(T[:3, :3], T[:3, 3])

    model = pin.Model()
    model.gravity.linear = robot.base[:3, :3].T @ robot.gravity
    order = depth_first(robot)
    ids = {-1: 0}
    for i in order:
        kind = pin.JointModelRZ() if robot.turns[i] else pin.JointModelPZ()
        parent = int(robot.parents[i])
        T = robot.before[i] if parent < 0 else robot.after[parent] @ robot.before[i]
        ids[i] = model.addJoint(ids[parent], kind, se3(T), f"joint{i}")
    p = robot.nominal
    tensors = inertia_about_com(p.mass, p.com, p.inertia, robot.framed)
    for b, i in enumerate(robot.body_joints.tolist()):
        if i >= 0:
            inertia = pin.Inertia(float(p.mass[b]), p.com[b], tensors[b])
            model.appendBodyToJoint(ids[i], inertia, se3(robot.after[i] @ robot.placement[b]))
    return model, order
