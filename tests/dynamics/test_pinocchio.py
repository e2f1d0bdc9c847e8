"""The dynamics agree with Pinocchio on random chains and trees with placements and many bodies.

Pinocchio factorises C(q, dq) differently; the two are compared through C(q, dq) dq only.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Robot
from support.random_robots import about_com, random_robot, random_state

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


class Twin:
    """The same robot in Pinocchio, called in our order of joints.

    Pinocchio's joint frame lies before our `after`, so bodies and children carry it; its trees
    must be numbered depth first.
    """

    def __init__(self, robot: Robot) -> None:
        self.model = pin.Model()
        self.model.gravity.linear = robot.base[:3, :3].T @ robot.gravity
        self.order = depth_first(robot.parents)
        ids = {-1: 0}
        for i in self.order:
            kind = robot.joint_types[i]
            joint = pin.JointModelRZ() if kind != "prismatic" else pin.JointModelPZ()
            parent = int(robot.parents[i])
            T = robot.before[i] if parent < 0 else robot.after[parent] @ robot.before[i]
            ids[i] = self.model.addJoint(ids[parent], joint, se3(T), f"joint{i}")
        p = about_com(robot).nominal
        for b, i in enumerate(robot.body_joints):
            if i >= 0:
                inertia = pin.Inertia(float(p.mass[b]), p.com[b], p.inertia[b])
                T = robot.after[i] @ robot.placement[b]
                self.model.appendBodyToJoint(ids[int(i)], inertia, se3(T))
        self.data = self.model.createData()

    def vector(self, function: Any, *arguments: Any) -> Any:
        """A function of vectors of joints that gives one."""
        result = function(self.model, self.data, *(x[self.order] for x in arguments))
        out = np.empty(len(self.order))
        out[self.order] = result
        return out

    def mass_matrix(self, q: Any) -> Any:
        upper = np.triu(pin.crba(self.model, self.data, q[self.order]))
        out = np.empty(upper.shape)
        out[np.ix_(self.order, self.order)] = upper + np.triu(upper, 1).T
        return out


def depth_first(parents: Any) -> list[int]:
    """The joints numbered so that each subtree is contiguous."""

    def below(i: int) -> list[int]:
        return [k for j in np.flatnonzero(parents == i) for k in (int(j), *below(int(j)))]

    return below(-1)


Cases = list[tuple[Robot, Twin, tuple[Any, ...]]]


@pytest.fixture(params=SHAPES, ids=str)
def cases(request: pytest.FixtureRequest) -> Cases:
    rng = np.random.default_rng(1)
    robots = [random_robot(rng, **request.param, drives=False) for _ in range(5)]
    return [(robot, Twin(robot), random_state(rng, robot.n)) for robot in robots]


def assert_agree(ours: Any, theirs: Any) -> None:
    scale = np.abs(theirs).max()
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=TOLERANCE * scale)


def test_newton_euler_agrees_with_pinocchio(cases: Cases) -> None:
    for robot, twin, (q, dq, _, ddq) in cases:
        theirs = twin.vector(pin.rnea, q, dq, ddq)
        assert_agree(mr.inverse_dynamics(robot, q, dq, dq, ddq), theirs)


def test_gravity_agrees_with_pinocchio(cases: Cases) -> None:
    for robot, twin, (q, *_) in cases:
        zero = np.zeros(robot.n)
        theirs = twin.vector(pin.computeGeneralizedGravity, q)
        assert_agree(mr.inverse_dynamics(robot, q, zero, zero, zero), theirs)


def test_coriolis_torque_agrees_with_pinocchio(cases: Cases) -> None:
    for robot, twin, (q, dq, *_) in cases:
        zero = np.zeros(robot.n)
        gravity = mr.inverse_dynamics(robot, q, zero, zero, zero)
        ours = mr.inverse_dynamics(robot, q, dq, dq, zero) - gravity
        g = twin.vector(pin.computeGeneralizedGravity, q)
        theirs = twin.vector(pin.nonLinearEffects, q, dq) - g
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=TOLERANCE * np.abs(g).max())


def test_mass_matrix_agrees_with_pinocchio(cases: Cases) -> None:
    for robot, twin, (q, *_) in cases:
        assert_agree(mr.mass_matrix(robot, q), twin.mass_matrix(q))


def test_forward_dynamics_agrees_with_pinocchio(cases: Cases) -> None:
    for robot, twin, (q, dq, _, ddq) in cases:
        tau = twin.vector(pin.rnea, q, dq, ddq)
        theirs = twin.vector(pin.aba, q, dq, tau)
        ours = mr.forward_dynamics(robot, q, dq, tau)
        condition = np.linalg.cond(mr.mass_matrix(robot, q))
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13 * condition)
