"""The dynamics agree with Pinocchio on random chains and trees with placements and many bodies.

Pinocchio factorises C(q, dq) differently; the two are compared through C(q, dq) dq only.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.robot import Robot
from random_robots import random_robot, random_state

pin = pytest.importorskip("pinocchio")

SHAPES: list[dict[str, Any]] = [
    {"simple": True, "n": 6},
    {"simple": True, "types": "rprp"},
    {"simple": False, "types": "p"},
    {"simple": False, "n": 6},
    {"simple": False, "n": 12},
    {"simple": False, "n": 8, "tree": True},
]
TOLERANCE = 1e-12  # of the largest entry


def se3(T: Any) -> Any:
    return pin.SE3(T[:3, :3], T[:3, 3])


def pinocchio_model(robot: Robot) -> Any:
    """The same robot: Pinocchio's joint frame lies before our `after`, so bodies carry it."""
    model = pin.Model()
    model.gravity.linear = robot.base[:3, :3].T @ robot.gravity
    ids = []
    for i in range(robot.n):
        joint = pin.JointModelRZ() if robot.joint_types[i] == "revolute" else pin.JointModelPZ()
        parent = robot.parents[i]
        placement = robot.before[i] if parent < 0 else robot.after[parent] @ robot.before[i]
        ids.append(
            model.addJoint(0 if parent < 0 else ids[parent], joint, se3(placement), f"joint{i}")
        )
    p = robot.nominal
    for b, i in enumerate(robot.body_joints):
        if i >= 0:
            inertia = pin.Inertia(float(p.mass[b]), p.com[b], p.inertia[b])
            model.appendBodyToJoint(ids[i], inertia, se3(robot.after[i] @ robot.placement[b]))
    # a depth-first order may differ from ours in a tree
    assert [model.joints[k].idx_v for k in ids] == list(range(robot.n))
    return model


@pytest.fixture(params=SHAPES, ids=str)
def pairs(request: pytest.FixtureRequest) -> list[tuple[Robot, Any, tuple[Any, ...]]]:
    rng = np.random.default_rng(1)
    robots = [random_robot(rng, **request.param, drives=False) for _ in range(5)]
    return [(robot, pinocchio_model(robot), random_state(rng, robot.n)) for robot in robots]


Pairs = list[tuple[Robot, Any, tuple[Any, ...]]]


def assert_agree(ours: Any, theirs: Any) -> None:
    scale = np.abs(theirs).max()
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=TOLERANCE * scale)


def test_newton_euler_agrees_with_pinocchio(pairs: Pairs) -> None:
    for robot, model, (q, dq, _, ddq) in pairs:
        theirs = pin.rnea(model, model.createData(), q, dq, ddq)
        assert_agree(mr.inverse_dynamics(robot, q, dq, dq, ddq), theirs)


def test_gravity_agrees_with_pinocchio(pairs: Pairs) -> None:
    for robot, model, (q, *_) in pairs:
        zero = np.zeros(robot.n)
        theirs = pin.computeGeneralizedGravity(model, model.createData(), q)
        assert_agree(mr.inverse_dynamics(robot, q, zero, zero, zero), theirs)


def test_coriolis_torque_agrees_with_pinocchio(pairs: Pairs) -> None:
    for robot, model, (q, dq, *_) in pairs:
        zero = np.zeros(robot.n)
        theirs = pin.nonLinearEffects(model, model.createData(), q, dq)
        assert_agree(mr.inverse_dynamics(robot, q, dq, dq, zero), theirs)


def test_mass_matrix_agrees_with_pinocchio(pairs: Pairs) -> None:
    for robot, model, (q, *_) in pairs:
        upper = np.triu(pin.crba(model, model.createData(), q))
        theirs = upper + np.triu(upper, 1).T
        assert_agree(mr.mass_matrix(robot, q), theirs)


def test_forward_dynamics_agrees_with_pinocchio(pairs: Pairs) -> None:
    for robot, model, (q, dq, _, ddq) in pairs:
        tau = pin.rnea(model, model.createData(), q, dq, ddq)
        theirs = pin.aba(model, model.createData(), q, dq, tau)
        ours = mr.forward_dynamics(robot, q, dq, tau)
        condition = np.linalg.cond(mr.mass_matrix(robot, q))
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13 * condition)
