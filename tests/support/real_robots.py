"""Manipulators of three packages of URDFs: which load, which are flagged, which are refused."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import pytest

# File: joints that move freely, and what else is asked.
LOADED = {
    "example-robot-data": {
        "ur3_robot": 6, "ur5_robot": 6, "ur10_robot": 6, "ur3_gripper": 6, "ur5_gripper": 6,
        "ur3_joint_limited_robot": 6, "ur5_joint_limited_robot": 6, "ur10_joint_limited_robot": 6,
        "panda": 8, "panda_collision": 8, "xarm7": 7, "z1": 7, "so100": 6, "so101": 6, "kinova": 6,
        "talos_left_arm": 7, "talos_reduced": 32, "talos_full_v2": 32, "baxter": 17,
        "tiago_no_hand": 12, "tiago_dual": 101, "tiago_pro": 23, "alex_nub_hands": 19,
        "g1_29dof_rev_1_0": 29, "b1-z1": 19, "TwoDofs": 2, "pr2": 20, "hyq_no_sensors": 12,
        "finger_edu": 3, "bolt": 6, "allegro_left_hand": 16,
    },
    "pybullet": {
        "kuka_iiwa/model": 7, "kuka_iiwa/model_vr_limits": 7, "kuka_iiwa/model_for_sdf": 7,
        "franka_panda/panda": 8, "xarm/xarm6_robot": 6, "TwoJointRobot_w_fixedJoints": 2,
    },
    "rtb-data": {
        "kr120r2500pro": 6, "kr16_2": 6, "kr210l150": 6,
        "px100": 6, "px150": 7, "rx150": 7, "rx200": 7, "vx250": 7, "vx300": 7, "vx300s": 8,
        "wx200": 7, "wx250": 7, "wx250s": 8,
    },
}  # fmt: skip
FLAGGED = {
    ("example-robot-data", "so101"): "link gripper_frame_link: taken as a point mass",
    ("example-robot-data", "talos_left_arm"): "link wrist_left_ft_link: taken as a point mass",
    ("example-robot-data", "baxter"): "link right_gripper: taken as a point mass",
    ("example-robot-data", "pr2"): "2 links have figures that no rigid body has, "
    "sensor_mount_link most (largest principal moment 400 % above the sum of the other two)",
    ("example-robot-data", "hyq_no_sensors"): "4 links have figures that no rigid body has, "
    "lf_foot most (a principal moment about one axis alone)",
    ("example-robot-data", "bolt"): "2 links have figures that no rigid body has, "
    "FL_FOOT most (an inertia tensor without mass)",
    ("example-robot-data", "allegro_left_hand"): "4 links have figures that no rigid body has, "
    "link_11.0 most (largest principal moment 25.6 % above",
    ("pybullet", "franka_panda/panda"): "2 links have figures that no rigid body has, panda_link8 "
    "most (an inertia tensor without mass)",
    ("pybullet", "xarm/xarm6_robot"): "2 links have figures that no rigid body has, link3 most "
    "(largest principal moment 15.6 % above",
    ("pybullet", "TwoJointRobot_w_fixedJoints"): "2 links have figures that no rigid body has, "
    "link_1 most (largest principal moment 0.795 % above",
    ("rtb-data", "kr16_2"): "joint joint_a1: effort limit of 0 taken as not given",
    ("rtb-data", "px100"): "link /fingers_link: 0.001 kg with a radius of gyration of 1.22 m: a "
    "placeholder?",
}
REFUSED = {
    ("example-robot-data", "alex_psyonic_hands"): 'joint Left_index_q2, mimic: joint "index_q1" '
    'does not exist; did you mean "Left_index_q1"?',
    ("example-robot-data", "double_pendulum"): "joint joint1, limits: lower and upper limit are "
    "both 0; such a joint cannot move",
    ("example-robot-data", "ur3"): "robot: no <link>",
    ("pybullet", "bicycle/bike"): "not XML: Unsupported version '0.0'",
    ("rtb-data", "irb140"): "no link that moves has mass: a file for pictures",
    ("rtb-data", "lbr_iiwa_14_r820"): "no link that moves has mass: a file for pictures",
    ("rtb-data", "puma560_robot"): "no link that moves has mass: a file for pictures",
    ("rtb-data", "al5d_robot"): "joint j4: nothing behind it has inertia about its axis",
    **{
        ("rtb-data", name): "no link that moves has mass: a file for pictures"
        for name in ("pxxls", "vxxmd", "vxxms", "wxxmd", "wxxms")
    },
}


def located(package: str, name: str) -> Path:
    """The URDF of a package whose path ends so; else the xacro file."""
    try:
        files = importlib.metadata.files(package) or []
    except importlib.metadata.PackageNotFoundError:
        pytest.skip(f"{package} is not installed")
    for end in (f"/{name}.urdf", f"/{name}.urdf.xacro"):
        found = sorted({str(f.locate()) for f in files if str(f).endswith(end)})
        if found:
            return Path(found[0])
    pytest.skip(f"{package} of this version holds no {name}.urdf")
