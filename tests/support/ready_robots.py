"""Built-in robots for tests: some load a URDF from a package that may not be installed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.assembly import builtin_robots
from modrobust.errors import DescriptionError
from modrobust.model import Bounded, MimicJoints, Robot


@cache
def _loaded(name: str) -> Robot | str:
    try:
        return mr.load_robot(name)
    except DescriptionError as problem:
        if "is not installed" not in str(problem):
            raise
        return str(problem)


def load_builtin(name: str) -> Robot:
    """The built-in robot; skips the test, with the reason, where its package is absent."""
    robot = _loaded(name)
    if isinstance(robot, str):
        pytest.skip(robot)
    return robot


def available() -> list[Robot]:
    """Those whose package is there, for parameters of fixtures, which cannot skip."""
    found = (_loaded(name) for name in sorted(builtin_robots()))
    return [robot for robot in found if not isinstance(robot, str)]


def freed(robot: Robot) -> tuple[Robot, Any]:
    """The robot with its mimic joints as free joints, and G (j, n): its velocities are G dq."""
    f = robot.mimic
    G = np.zeros((robot.j, robot.n))
    G[robot.free, np.arange(robot.n)] = 1.0
    G[f.joints, f.leaders] = f.multiplier
    if robot.j == robot.n:
        return robot, G
    d = robot.disturbance

    def longer(x: Any, fill: float) -> Any:
        everything = np.full((robot.j, *x.shape[1:]), fill)
        everything[robot.free] = x
        return everything

    free = replace(
        robot,
        joint_names=robot.all_joint_names,
        position_limits=longer(robot.position_limits, np.inf),
        velocity_limits=longer(robot.velocity_limits, np.inf),
        effort_limits=longer(robot.effort_limits, np.inf),
        disturbance=Bounded(*(longer(x, 0.0) for x in (d.nominal, d.lo, d.hi))),
        mimic=MimicJoints(),
        controller=replace(robot.controller, K_r=(10.0,) * robot.j),
        trajectory=None,
        initial_q=None,
        initial_dq=None,
        acceleration_limits=longer(robot.acceleration_limits, np.inf),
        scenarios={},
    )
    return free, G
