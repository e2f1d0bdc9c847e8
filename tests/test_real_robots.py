"""Real robots as their makers describe them: dynamics against Pinocchio's own URDF reader.

Every manipulator of the three packages (test dependencies): it loads with the same dynamics, or it
is refused, or flagged, for the reason that its file gives.
"""

from __future__ import annotations

import importlib.metadata
import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import xacro  # type: ignore[import-untyped]
from numpy.typing import NDArray

import modrobust as mr
from test_urdf import pinocchio_terms

Array = NDArray[np.float64]
STATES = 3
SEED = 20261123

# File: joints that move freely, and what else is asked.
LOADED = {
    "example-robot-data": {
        "ur3_robot": 6, "ur5_robot": 6, "ur10_robot": 6, "ur3_gripper": 6, "ur5_gripper": 6,
        "ur3_joint_limited_robot": 6, "ur5_joint_limited_robot": 6, "ur10_joint_limited_robot": 6,
        "panda": 8, "panda_collision": 8, "xarm7": 7, "z1": 7, "so100": 6, "so101": 6, "kinova": 6,
        "talos_left_arm": 7, "talos_reduced": 32, "talos_full_v2": 32, "baxter": 17,
        "tiago_no_hand": 12, "tiago_dual": 101, "tiago_pro": 23, "alex_nub_hands": 19,
        "g1_29dof_rev_1_0": 29, "b1-z1": 19, "TwoDofs": 2,
    },
    "pybullet": {
        "kuka_iiwa/model": 7, "kuka_iiwa/model_vr_limits": 7, "kuka_iiwa/model_for_sdf": 7,
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
    ("pybullet", "kuka_iiwa/model"): "link lbr_iiwa_link_0, mass: left out, since it does not move",
    ("rtb-data", "kr16_2"): "joint joint_a1: effort limit of 0 taken as not given",
    ("rtb-data", "px100"): "link /fingers_link: 0.001 kg with a radius of gyration of 1.22 m: a "
    "placeholder?",
}
REFUSED = {
    ("example-robot-data", "pr2"): "link sensor_mount_link, inertia: principal moments 0.001, "
    "0.001, 0.01 kg m^2 break the triangle inequality",
    ("example-robot-data", "hyq_no_sensors"): "link lf_foot, inertia: principal moments "
    "-1.99283e-22, 8.51804e-23, 3e-06 kg m^2; the nominal tensor must be positive definite",
    ("example-robot-data", "finger_edu"): "link finger_lower_link, inertia.zz: 0 kg m^2 is zero",
    ("example-robot-data", "bolt"): "link FL_FOOT, mass: 0 kg with an inertia tensor that is not 0",
    ("example-robot-data", "allegro_left_hand"): "break the triangle inequality",
    ("example-robot-data", "alex_psyonic_hands"): 'joint Left_index_q2, mimic: joint "index_q1" '
    'does not exist; did you mean "Left_index_q1"?',
    ("example-robot-data", "double_pendulum"): "joint joint1, limits: lower and upper limit are "
    "both 0; such a joint cannot move",
    ("example-robot-data", "ur3"): "robot: no <link>",
    ("pybullet", "franka_panda/panda"): "link panda_link8, mass: 0 kg with an inertia tensor",
    ("pybullet", "xarm/xarm6_robot"): "link link2, inertia: principal moments 0.00305792, "
    "0.0236436, 0.0268997 kg m^2 break the triangle inequality",
    ("pybullet", "TwoJointRobot_w_fixedJoints"): "break the triangle inequality",
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


def for_pinocchio(path: Path, folder: Path) -> Path:
    """The file itself, or what the package xacro makes of it: Pinocchio reads no xacro."""
    if path.suffix != ".xacro":
        return path
    expanded = folder / path.stem
    expanded.write_text(xacro.process_file(str(path)).toxml(), encoding="utf-8")
    return expanded


def spread(arm: mr.Robot) -> tuple[tuple[str, ...], Array]:
    """Names of all joints, and G (j, n) with velocities of all joints = G dq."""
    rows = np.zeros((arm.j, arm.n))
    rows[: arm.n] = np.eye(arm.n)
    f = arm.followers
    for k, (leader, multiplier) in enumerate(zip(f.leaders, f.multiplier, strict=True)):
        rows[arm.n + k, leader] = multiplier
    return arm.all_joint_names, rows


@pytest.mark.parametrize(
    ("package", "name"), [(package, name) for package, names in LOADED.items() for name in names]
)
def test_a_real_robot_has_the_dynamics_that_pinocchio_reads(
    package: str, name: str, tmp_path: Path
) -> None:
    path = located(package, name)
    arm = mr.load_robot(path)
    assert arm.n == LOADED[package][name]
    if (package, name) in FLAGGED:
        assert any(note.startswith(FLAGGED[package, name]) for note in arm.notes), arm.notes
    names, G = spread(arm)
    plain = for_pinocchio(path, tmp_path)
    rng = np.random.default_rng(SEED)
    rest = np.zeros(arm.n)
    for _ in range(STATES):
        q, dq, ddq = rng.uniform(-1.5, 1.5, (3, arm.n))
        tau, g, M = pinocchio_terms(plain, names, arm.all_positions(q), G @ dq, G @ ddq, {})
        pairs = (
            (mr.inverse_dynamics(arm, q, dq, dq, ddq, drives=False), G.T @ tau),
            (mr.inverse_dynamics(arm, q, rest, rest, rest, drives=False), G.T @ g),
            (mr.mass_matrix(arm, q, drives=False), G.T @ M @ G),
        )
        for ours, theirs in pairs:
            np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-9 * np.max(np.abs(theirs)))


@pytest.mark.parametrize(("package", "name"), REFUSED)
def test_a_robot_with_impossible_figures_is_refused_for_its_reason(package: str, name: str) -> None:
    path = located(package, name)
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(path)
    assert REFUSED[package, name] in str(caught.value)
    assert str(caught.value).startswith(str(path))


def test_a_gripper_of_pr2_is_flagged_as_placeholders() -> None:
    arm = mr.load_robot(located("pybullet", "pr2_gripper"))
    assert any("placeholders?" in note and "left_gripper" in note for note in arm.notes)


def test_a_refused_robot_loads_with_the_figure_it_lacks(tmp_path: Path) -> None:
    located("pybullet", "franka_panda/panda")
    (tmp_path / "arm.yaml").write_text(
        "modrobust: 1\nrobot: arm\nurdf: package:pybullet/franka_panda/panda.urdf\n"
        "tip_link: panda_hand\ntolerance: {mass: 5%, com: 5 mm, inertia: 10%}\n"
        "links: {panda_link8: {mass: 0.1 kg}}\n",
        encoding="utf-8",
    )
    arm = mr.load_robot(tmp_path / "arm.yaml")
    assert arm.n == 7
    assert arm.dh is not None


def test_the_example_of_the_documentation_loads(tmp_path: Path) -> None:
    located("example-robot-data", "ur5_robot")
    page = Path(__file__).parents[1] / "docs" / "reference" / "urdf.md"
    (example,) = re.findall(r"```yaml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "my-ur5.yaml").write_text(example, encoding="utf-8")
    arm = mr.load_robot(tmp_path / "my-ur5.yaml")
    assert arm.n == 5
    assert arm.gear_ratio[arm.joint_names.index("elbow_joint")] == 101.0


def test_a_file_cut_anywhere_never_loads_as_a_smaller_robot(tmp_path: Path) -> None:
    data = located("example-robot-data", "ur5_robot").read_bytes()
    for end in np.linspace(1, len(data.rstrip()) - 1, 199).astype(int):
        cut = tmp_path / "cut.urdf"
        cut.write_bytes(data[:end])
        with pytest.raises(mr.ModrobustError):
            mr.load_robot(cut)


def test_pinocchio_is_the_version_that_reads_mimic_joints_as_free_ones() -> None:
    # `pinocchio_terms` relies on it.
    model = pin.buildModelFromUrdf(str(located("example-robot-data", "panda")))
    assert model.nv == 9
