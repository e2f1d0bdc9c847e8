"""The real robots of ``assemblies/``: overlays reach the robot, the closed loop keeps the bound."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import modrobust as mr
from modrobust.assembly import builtin_robots
from modrobust.errors import DescriptionError
from support.ready_robots import load_builtin

# Free joints, parents of them, mass of the tool that the file adds [kg].
ROBOTS = {
    "ur5": ("ur5_robot", 6, 0.0),
    "panda": ("panda", 8, 0.0),
    "iiwa": ("model", 7, 0.0),
    "baxter": ("baxter", 15, 0.0),
    "tiago": ("tiago_no_hand", 8, 0.75),
}
PACKAGES = {"iiwa": "pybullet"}


def urdf_of(name: str) -> Path:
    package = PACKAGES.get(name, "example-robot-data")
    stem = ROBOTS[name][0]
    folder = "kuka_iiwa/" if name == "iiwa" else ""
    files = importlib.metadata.files(package) or []
    return Path(next(str(f.locate()) for f in files if str(f).endswith(f"/{folder}{stem}.urdf")))


@pytest.fixture(params=ROBOTS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_every_file_over_a_urdf_is_checked_here() -> None:
    over = [name for name, path in builtin_robots().items() if "\nurdf:" in path.read_text()]
    assert sorted(over) == sorted(ROBOTS)


def test_joints_and_moving_mass_are_those_of_the_urdf(name: str) -> None:
    robot = load_builtin(name)
    _, n, tool = ROBOTS[name]
    assert robot.n == n
    model = pin.buildModelFromUrdf(str(urdf_of(name)))
    kept = set(robot.all_joint_names)
    moving = np.zeros(model.njoints, bool)  # behind a joint that is not locked
    for i in range(1, model.njoints):
        moving[i] = moving[model.parents[i]] or model.names[i] in kept
    expected = sum(model.inertias[i].mass for i in range(1, model.njoints) if moving[i])
    ours = float(robot.nominal.mass[robot.body_joints >= 0].sum())
    assert ours == pytest.approx(expected + tool, rel=1e-9)


def test_every_body_that_moves_has_bounds(name: str) -> None:
    robot = load_builtin(name)
    moving = robot.body_joints >= 0
    assert (robot.lower.mass < robot.upper.mass)[moving].all()
    assert (robot.lower.com < robot.upper.com)[moving].all()


def test_the_robot_follows_its_own_motion(name: str) -> None:
    robot = load_builtin(name)
    result = mr.simulate(robot, duration=0.2, seed=7)
    assert result.ok, result.reasons
    assert result.statistics is not None
    assert result.statistics.violations == 0
    assert np.linalg.norm(result.q_des[0] - result.q[0]) > result.controller.epsilon
    assert result.epsilon_entered_at is not None
    assert 0 < result.epsilon_entered_at < result.controller.blend


def test_the_second_finger_of_the_panda_follows_the_first() -> None:
    robot = load_builtin("panda")
    assert robot.all_joint_names[-2:] == ("panda_finger_joint1", "panda_finger_joint2")
    assert robot.joint_types[-2:] == ("prismatic", "prismatic")


def test_the_trees_have_branches_and_the_torso_lifts() -> None:
    baxter = load_builtin("baxter")
    assert list(baxter.parents).count(-1) == 3  # head, right arm, left arm
    assert load_builtin("tiago").joint_types[0] == "prismatic"


def test_a_robot_whose_package_is_absent_names_it(tmp_path: Path) -> None:
    file = tmp_path / "iiwa.yaml"
    text = builtin_robots()["iiwa"].read_text(encoding="utf-8")
    file.write_text(text.replace("package:pybullet/", "package:pybullet-of-nobody/"), "utf-8")
    with pytest.raises(DescriptionError) as caught:
        mr.load_robot(file)
    assert str(caught.value).endswith(
        'urdf: package "pybullet-of-nobody" is not installed; its URDF comes with it; '
        "pip install pybullet-of-nobody"
    )
