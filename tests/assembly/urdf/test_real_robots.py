"""Real robots as their makers describe them: dynamics against Pinocchio's own URDF reader.

Every manipulator of the three packages (test dependencies): it loads with the same dynamics, or it
is refused, or flagged, for the reason that its file gives.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import xacro  # type: ignore[import-untyped]
from numpy.typing import NDArray

import modrobust as mr
from support.paths import ROOT
from support.pinocchio_urdf import pinocchio_terms
from support.real_robots import FLAGGED, LOADED, REFUSED, located

Array = NDArray[np.float64]
STATES = 3
SEED = 20261123


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
    rows[arm.free, np.arange(arm.n)] = 1.0
    f = arm.mimic
    rows[f.joints, f.leaders] = f.multiplier
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
    page = ROOT / "docs" / "reference" / "urdf.md"
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
