"""Four small test modules as files, and the same four as Pinocchio puts them together."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import ArrayLike

from modrobust.dynamics import forward_kinematics, inverse_dynamics, mass_matrix
from modrobust.errors import DescriptionError
from modrobust.model import Robot

HINGE = """
modrobust: 1
module: hinge
name: Test hinge
source: generic, not a product
product: false
connectors: {in: {type: t}, out: {type: t}}
chain:
  - body: stator
    span: {xyz: [0, 10 mm, 100 mm], rpy: [0, 0.2, 0]}
    mass: 1 kg
    com: [0, 10 mm, 50 mm]
    inertia: {xx: 0.002, yy: 0.003, zz: 0.004, xy: 1e-4}
  - joint: axis
    type: revolute
  - body: rotor
    span: {dh: {convention: standard, a: 50 mm, alpha: pi/2, d: 20 mm, theta: 0.3}}
    expressed_in: end
    mass: 0.7 kg
    com: [-20 mm, 5 mm, 1 mm]
    inertia: {xx: 0.001, yy: 0.0015, zz: 0.002, yz: -2e-4}
"""
SLIDE = """
modrobust: 1
module: slide
name: Test slide
source: generic, not a product
product: false
connectors: {in: {type: t}, out: {type: t}}
chain:
  - joint: axis
    type: prismatic
  - body: carriage
    span: {xyz: [0.1, 0, 0]}
    mass: 1.5 kg
    com: [10 mm, 0, 0]
    inertia: {xx: 0.001, yy: 0.0015, zz: 0.002}
"""
OBLIQUE = """
modrobust: 1
module: oblique
name: Test link, oblique with a twist
source: generic, not a product
product: false
connectors: {in: {type: t}, out: {type: t}}
chain:
  - body: tube
    span:
      giusti2015:
        {convention: giusti, p: 30 mm, delta_in: 0.4, a: 0.2, alpha: 0.7, n: 0.15, delta_out: -0.9}
    mass: 1.2 kg
    com: [0.1, 0.02, -0.03]
    inertia: {xx: 0.004, yy: 0.009, zz: 0.008, xz: 3e-4}
"""
TOOL = """
modrobust: 1
module: tool
name: Test tool
source: generic, not a product
product: false
connectors: {in: {type: t}}
chain:
  - body: hand
    span: {xyz: [0, 0, 0.08]}
    mass: 0.5 kg
    com: [1 mm, 2 mm, 40 mm]
    inertia: {xx: 5e-4, yy: 6e-4, zz: 3e-4}
"""
MODULES = {"hinge": HINGE, "slide": SLIDE, "oblique": OBLIQUE, "tool": TOOL}


class Composed:
    """A chain put together by Pinocchio, body by body, from the tip of what is there already."""

    def __init__(self) -> None:
        self.model, self.joint, self.cursor = pin.Model(), 0, pin.SE3.Identity()

    def span(self, *motions: pin.SE3) -> None:
        for motion in motions:
            self.cursor = self.cursor * motion

    def turn(self, kind: str) -> None:
        model = pin.JointModelRZ() if kind == "revolute" else pin.JointModelPZ()
        name = f"joint{self.model.njoints}"
        self.joint = self.model.addJoint(self.joint, model, self.cursor, name)
        self.cursor = pin.SE3.Identity()

    def body(self, mass: float, com: Sequence[float], inertia: ArrayLike) -> None:
        body = pin.Inertia(mass, np.array(com), np.array(inertia, dtype=float))
        self.model.appendBodyToJoint(self.joint, body, self.cursor)

    # The test modules, motion by motion.
    def hinge(self) -> None:
        self.body(1.0, [0, 0.01, 0.05], [[0.002, 1e-4, 0], [1e-4, 0.003, 0], [0, 0, 0.004]])
        self.span(move(0, 0.01, 0.1), rotate("y", 0.2))
        self.turn("revolute")
        self.span(rotate("z", 0.3), move(0, 0, 0.02), move(0.05, 0, 0), rotate("x", math.pi / 2))
        self.body(
            0.7, [-0.02, 0.005, 0.001], [[0.001, 0, 0], [0, 0.0015, -2e-4], [0, -2e-4, 0.002]]
        )

    def slide(self) -> None:
        self.turn("prismatic")
        self.body(1.5, [0.01, 0, 0], np.diag([0.001, 0.0015, 0.002]))
        self.span(move(0.1, 0, 0))

    def oblique(self) -> None:
        self.body(1.2, [0.1, 0.02, -0.03], [[0.004, 0, 3e-4], [0, 0.009, 0], [3e-4, 0, 0.008]])
        self.span(move(0, 0, -0.03), rotate("z", -0.4), move(0.2, 0, 0), rotate("x", 0.7))
        self.span(move(0, 0, 0.15), rotate("z", -0.9))

    def tool(self) -> None:
        self.body(0.5, [0.001, 0.002, 0.04], np.diag([5e-4, 6e-4, 3e-4]))
        self.span(move(0, 0, 0.08))


def move(x: float, y: float, z: float) -> pin.SE3:
    return pin.SE3(np.eye(3), np.array([x, y, z], dtype=float))


def rotate(axis: str, angle: float) -> pin.SE3:
    return pin.SE3(pin.utils.rotate(axis, angle), np.zeros(3))


def assert_same_robot(robot: Robot, composed: Composed) -> None:
    """Tip, mass matrix and gravity torques agree at random poses."""
    model, data = composed.model, composed.model.createData()
    model.gravity.linear = robot.base[:3, :3].T @ robot.gravity
    rng = np.random.default_rng(0)
    zero = np.zeros(robot.n)
    for _ in range(10):
        q = rng.uniform(-2.0, 2.0, robot.n)
        pin.forwardKinematics(model, data, q)
        tip = (data.oMi[composed.joint] * composed.cursor).homogeneous
        np.testing.assert_allclose(forward_kinematics(robot, q)[-1], tip, rtol=0, atol=1e-13)
        M = pin.crba(model, data, q)
        M = np.triu(M) + np.triu(M, 1).T
        np.testing.assert_allclose(mass_matrix(robot, q, drives=False), M, rtol=0, atol=1e-12)
        g = pin.computeGeneralizedGravity(model, data, q)
        torque = inverse_dynamics(robot, q, zero, zero, zero, drives=False)
        np.testing.assert_allclose(torque, g, rtol=0, atol=1e-12)


def message(
    load: Callable[..., object],
    *arguments: Any,
    error: type[Exception] = DescriptionError,
    **named: Any,
) -> str:
    """The message with which an assembly text is refused."""
    with pytest.raises(error) as caught:
        load(*arguments, **named)
    return str(caught.value)
