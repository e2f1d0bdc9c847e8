"""Containment for the robots of the catalogue, at usual states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import modrobust as mr
from support.containment.ball_comparison import check_state
from support.containment.extreme_states import Signals
from support.paths import ROOT

FOLDER = ROOT / "assemblies"
ROBOTS = [
    path for path in sorted(FOLDER.glob("*.yaml")) if "\nurdf:" not in path.read_text("utf-8")
]


@pytest.mark.parametrize("file", ROBOTS, ids=lambda path: path.stem)
def test_exact_torques_of_a_ready_robot_lie_within_the_bounds(file: Path) -> None:
    robot = mr.load_robot(file)
    rng = np.random.default_rng(0)
    for _ in range(3):
        q, q_des = rng.uniform(-1.5, 1.5, (2, robot.n))
        dq, dq_des, ddq_des = rng.normal(size=(3, robot.n))
        outcome = check_state(robot, Signals(q, dq, q_des, dq_des, ddq_des), rng, file.stem)
        assert not outcome.violations, "\n".join(outcome.violations)
        assert not outcome.refused
