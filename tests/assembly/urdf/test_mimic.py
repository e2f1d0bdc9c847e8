"""Mimic joints, docs/theory/equations.md (15)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Bounded, MimicJoints, Robot
from support.random_robots import random_robot, tied
from support.rounding import slack
from support.states import State, state_of

MULTIPLIER = np.array([-0.5, 2.0])
OFFSET = np.array([0.3, -0.1])
LEADERS = np.array([1, 0], np.int32)


@pytest.fixture(
    params=[(0, (4, 5)), (1, (4, 5)), (2, (4, 5)), (3, (1, 3)), (4, (0, 2))],
    ids=["tree 0", "tree 1", "tree 2", "carrying free ones", "the first one mimics"],
)
def pair(request: Any) -> tuple[Robot, Robot]:
    """Six free joints in a tree or a chain, and the same robot with two mimic joints."""
    seed, joints = request.param
    rng = np.random.default_rng(seed)
    whole = random_robot(rng, 6, tree=joints == (4, 5))
    free = [i for i in range(6) if i not in joints]
    d = whole.disturbance
    tied = replace(
        whole,
        joint_names=tuple(whole.joint_names[i] for i in free),
        position_limits=whole.position_limits[free],
        velocity_limits=whole.velocity_limits[free],
        effort_limits=whole.effort_limits[free],
        acceleration_limits=whole.acceleration_limits[free],
        disturbance=Bounded(d.nominal[free], d.lo[free], d.hi[free]),
        mimic=MimicJoints(
            tuple(whole.joint_names[i] for i in joints), LEADERS, MULTIPLIER, OFFSET, joints
        ),
    )
    return whole, tied


def mimicking(robot: Robot) -> np.ndarray:
    """G (j, n): all velocities are G dq, (15)."""
    G = np.zeros((6, 4))
    for k, i in enumerate(i for i in range(6) if i not in robot.mimic.joints):
        G[i, k] = 1.0
    for i, leader, multiplier in zip(robot.mimic.joints, LEADERS, MULTIPLIER, strict=True):
        G[i, leader] = multiplier
    return G


def states(robot: Robot, seed: int = 1) -> list[tuple[State, State]]:
    """The free joints' vectors and those of all joints."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(20):
        free = state_of(rng.normal(size=(4, 4)))
        full = state_of(mimicking(robot) @ x for x in free)
        full[0][robot.mimic.joints] += OFFSET
        found.append((free, full))
    return found


def test_torques_are_those_of_the_whole_tree_moved_by_the_free_joints(pair: Any) -> None:
    whole, tied = pair
    for free, full in states(tied):
        expected = mimicking(tied).T @ mr.inverse_dynamics(whole, *full)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(mr.inverse_dynamics(tied, *free), expected, atol=1e-12 * scale)


def test_the_mass_matrix_is_projected(pair: Any) -> None:
    whole, tied = pair
    G = mimicking(tied)
    for free, full in states(tied):
        expected = G.T @ mr.mass_matrix(whole, full[0]) @ G
        np.testing.assert_allclose(mr.mass_matrix(tied, free[0]), expected, rtol=1e-12, atol=1e-12)


def test_forward_dynamics_inverts_inverse_dynamics(pair: Any) -> None:
    _, tied = pair
    for (q, dq, _, ddq), _ in states(tied):
        tau = mr.inverse_dynamics(tied, q, dq, dq, ddq)
        np.testing.assert_allclose(mr.forward_dynamics(tied, q, dq, tau), ddq, atol=1e-8)


@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_bounds_hold_every_sample_and_corner(pair: Any, bound: str) -> None:
    _, tied = pair
    rng = np.random.default_rng(5)
    for free, _ in states(tied, 2):
        lo, hi = mr.inverse_dynamics_bounds(tied, *free, bound=bound)
        margin = 1e-12 * np.abs([lo, hi]).max()
        for _ in range(20):
            for point in (tied.sample_parameters(rng), tied.corner_parameters(rng)):
                tau = mr.inverse_dynamics(tied, *free, parameters=point)
                assert (lo - margin <= tau).all()
                assert (tau <= hi + margin).all()


@pytest.mark.parametrize("seed", range(4))
def test_the_slack_of_a_leader_holds_that_of_its_mimic_joints(seed: int) -> None:
    """Without drives it is that of the whole chain, grown by what mimic joints' angles are off."""
    rng = np.random.default_rng(seed)
    whole = random_robot(rng, types="rrrrrr")
    arm = tied(whole, 4, rng, anywhere=True)
    f = arm.mimic
    G = np.zeros((6, 4))
    G[arm.free, range(4)] = 1.0
    G[f.joints, f.leaders] = f.multiplier
    free = state_of(rng.normal(size=(4, 4)))
    full = state_of(G @ x for x in free)
    full[0][f.joints] += f.offset
    ours, apart = (
        slack(robot, *state, drives=False) for robot, state in ((arm, free), (whole, full))
    )
    grown = ours / (np.abs(G).T @ apart)
    assert 1.0 < grown[0] < 1.5
    np.testing.assert_allclose(grown, grown[0], rtol=1e-9)


def test_frames_of_mimic_joints_move_with_their_leaders(pair: Any) -> None:
    whole, tied = pair
    for free, full in states(tied, 3):
        np.testing.assert_allclose(
            mr.forward_kinematics(tied, free[0]), mr.forward_kinematics(whole, full[0]), atol=1e-12
        )


def test_the_resolved_robot_names_leader_multiplier_and_offset(pair: Any) -> None:
    _, tied = pair
    joints = tied.to_dict()["joints"]
    assert [joint["name"] for joint in joints] == [f"joint{i}" for i in range(6)]
    mimics = {i: joint["mimic"] for i, joint in enumerate(joints) if "mimic" in joint}
    first, second = tied.mimic.joints.tolist()
    free = [i for i in range(6) if i not in (first, second)]
    assert mimics == {
        first: {"joint": free[1], "multiplier": -0.5, "offset": 0.3},
        second: {"joint": free[0], "multiplier": 2.0, "offset": -0.1},
    }
    assert tied.to_dict()["dh"] is None


ARM = """<robot name="palletiser">
<link name="base"/>{links}
{joints}
</robot>"""
LINK = (
    '<link name="{0}"><inertial><origin xyz="{1}"/><mass value="{2}"/><inertia ixx="0.02" ixy="0" '
    'ixz="0.001" iyy="0.03" iyz="0" izz="0.02"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/>'
    '<origin xyz="0.1 0 0.3" rpy="0.1 0.2 0"/><axis xyz="{4}"/>'
    '<limit lower="-2" upper="2" velocity="2" effort="50"/>{5}</joint>'
)
CHAIN = [  # name, type, parent, child, axis, mimic: the tool's joint stands on a mimic joint
    ("pan", "revolute", "base", "column", "0 0 1", ""),
    ("lift", "revolute", "column", "upper", "0 1 0", ""),
    ("elbow", "revolute", "upper", "fore", "0 1 0", ""),
    ("level", "revolute", "fore", "wrist", "0 1 0", '<mimic joint="lift" multiplier="-1.5"/>'),
    ("tool", "prismatic", "wrist", "hand", "1 0 1", ""),
    ("jaw", "prismatic", "hand", "finger", "0 1 0", '<mimic joint="tool" offset="0.1"/>'),
]


def palletiser(tmp_path: Path) -> Path:
    links = "".join(
        LINK.format(row[3], f"0.1 0 {k / 10}", 3 - k / 3) for k, row in enumerate(CHAIN)
    )
    joints = "".join(JOINT.format(*row) for row in CHAIN)
    path = tmp_path / "palletiser.urdf"
    path.write_text(ARM.format(links=links, joints=joints), encoding="utf-8")
    return path


def test_a_free_joint_may_be_carried_by_a_mimic_joint(tmp_path: Path) -> None:
    """Against Pinocchio, for which all joints are free: G' tau."""
    pin = pytest.importorskip("pinocchio")
    path = palletiser(tmp_path)
    arm = mr.load_robot(path, tolerance="mass=5%,com=5mm,inertia=10%")
    assert arm.joint_names == ("pan", "lift", "elbow", "tool")
    assert arm.all_joint_names == ("pan", "lift", "elbow", "level", "tool", "jaw")
    assert [("mimic" in joint) for joint in arm.to_dict()["joints"]] == [0, 0, 0, 1, 0, 1]
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    at = [model.joints[model.getJointId(name)].idx_v for name in arm.all_joint_names]
    G = np.zeros((6, 4))
    G[at[:3], range(3)], G[at[3], 1], G[at[4:], 3] = 1.0, -1.5, 1.0
    rng = np.random.default_rng(0)
    for q, dq, ddq in rng.normal(size=(20, 3, 4)):
        whole = G @ q
        whole[at[5]] += 0.1
        tau = G.T @ pin.rnea(model, data, whole, G @ dq, G @ ddq)
        np.testing.assert_allclose(mr.inverse_dynamics(arm, q, dq, dq, ddq), tau, atol=1e-9)
        upper = np.triu(pin.crba(model, data, whole))
        M = G.T @ (upper + np.triu(upper, 1).T) @ G
        np.testing.assert_allclose(mr.mass_matrix(arm, q), M, atol=1e-9)


@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_the_loop_of_such_an_arm_keeps_its_bound_and_tracks(tmp_path: Path, bound: str) -> None:
    arm = mr.load_robot(palletiser(tmp_path), tolerance="mass=5%,com=5mm,inertia=10%")
    arm = replace(arm, controller=replace(arm.controller, bound=bound))
    run = mr.simulate(arm, parameters="random", seed=3, duration=0.3)
    assert run.statistics is not None
    assert run.statistics.violations == 0
    assert run.statistics.error_last < 0.05
