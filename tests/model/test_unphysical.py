"""Figures that no rigid body has: taken as written where the mass matrix is regular."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import DescriptionError, ValueRangeError
from modrobust.export.urdf import urdf_text
from modrobust.model.physical import excess, is_physical, least_moment

LINK = (
    '<link name="{name}"><inertial><origin xyz="{com}"/><mass value="{mass}"/><inertia ixx="{ixx}" '
    'ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"/></inertial></link>'
)
JOINT = (
    '<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
    '<origin xyz="{xyz}"/><axis xyz="{axis}"/>'
    '<limit lower="-2" upper="2" velocity="2" effort="500"/></joint>'
)


def arm(first: dict[str, Any], folder: Path, tail: str = "") -> Path:
    """Two joints, the first about z: what its link has about x and y makes no torque."""
    one = {"name": "one", "com": "0 0 0", "mass": 20, "ixx": 0, "iyy": 0, "izz": 14.6} | first
    two = {"name": "two", "com": "0.5 0 0", "mass": 20, "ixx": 1, "iyy": 4, "izz": 4}
    path = folder / "arm.urdf"
    path.write_text(
        '<robot name="arm"><link name="base"/>'
        + LINK.format(**one)
        + LINK.format(**two)
        + JOINT.format(name="a", parent="base", child="one", xyz="0 0 0", axis="0 0 1")
        + JOINT.format(name="b", parent="one", child="two", xyz="0.3 0 0.5", axis="0 1 0")
        + f"{tail}</robot>",
        encoding="utf-8",
    )
    return path


TOLERANCE = "mass=5%, com=5 mm, inertia=10%"


def remarks(robot: mr.Robot) -> list[str]:
    return [note for note in robot.notes if "no rigid body" in note]


def test_a_moment_about_the_axis_alone_gives_the_mass_matrix_worked_out_by_hand(
    tmp_path: Path,
) -> None:
    """M[0, 0] = 14.6 + 4 + 20 (0.3 + 0.5)^2, M[1, 1] = 4 + 20 0.5^2, g[1] = -20 9.81 0.5."""
    robot = mr.load_robot(arm({}, tmp_path))
    zero = np.zeros(2)
    np.testing.assert_allclose(mr.mass_matrix(robot, zero), np.diag([31.4, 9.0]), atol=1e-12)
    gravity = mr.inverse_dynamics(robot, zero, zero, zero, zero)
    np.testing.assert_allclose(gravity, [0, -98.1], atol=1e-12)


@pytest.mark.parametrize(
    ("figures", "remark"),
    [
        ({}, "a principal moment about one axis alone"),
        ({"mass": 0}, "an inertia tensor without mass"),
        (
            {"ixx": 5, "iyy": 5, "izz": 14.6},
            "largest principal moment 46 % above the sum of the other two",
        ),
        ({"ixx": -1e-22}, "a principal moment about one axis alone"),
    ],
)
def test_what_is_wrong_is_said_in_one_remark(
    tmp_path: Path, figures: dict[str, Any], remark: str
) -> None:
    robot = mr.load_robot(arm(figures, tmp_path))
    assert remarks(robot) == [
        f"link one: {remark}; no rigid body has that; taken as written, since the mass matrix is "
        "positive definite"
    ]
    assert list(robot.unphysical) == ["one"]


@pytest.mark.parametrize(
    "figures", [{"iyy": 14.6}, {"ixx": 14.6}, {"ixx": 7.3, "iyy": 7.3}, {"ixx": 14.6, "iyy": 14.6}]
)
def test_rods_and_plates_are_bodies_and_not_remarked(
    tmp_path: Path, figures: dict[str, Any]
) -> None:
    robot = mr.load_robot(arm(figures, tmp_path))
    assert remarks(robot) == []
    assert robot.to_dict()["unphysical"] == []


def test_several_links_are_one_remark_that_names_the_worst(tmp_path: Path) -> None:
    path = arm({"ixx": 5, "iyy": 5}, tmp_path)
    text = path.read_text(encoding="utf-8").replace('ixx="1"', 'ixx="1e-3"')
    path.write_text(text.replace('izz="4"', 'izz="4.4"'), encoding="utf-8")
    robot = mr.load_robot(path)
    assert remarks(robot) == [
        "2 links have figures that no rigid body has, one most (largest principal moment 46 % "
        "above the sum of the other two); taken as written, since the mass matrix is positive "
        "definite"
    ]
    listed = robot.to_dict()["unphysical"]
    assert [item["body"] for item in listed] == ["one", "two"]
    assert [item["excess"] for item in listed] == pytest.approx([0.46, 4.4 / 4.001 - 1])


def test_a_joint_that_nothing_turns_with_is_still_refused_by_its_name(tmp_path: Path) -> None:
    path = arm({}, tmp_path)
    text = path.read_text(encoding="utf-8").replace('iyy="4"', 'iyy="0"')
    path.write_text(text.replace('xyz="0.5 0 0"', 'xyz="0 0 0"'), encoding="utf-8")
    with pytest.raises(DescriptionError, match="joint b: nothing behind it has inertia about its"):
        mr.load_robot(path)


@pytest.mark.parametrize("which", ["lower", "upper", "corner"])
def test_sampled_points_are_within_bounds_and_keep_the_mass_matrix(
    tmp_path: Path, which: str
) -> None:
    """Of the box alone 10 % of 14.6 on every entry gives negative moments in most points."""
    robot = mr.load_robot(arm({}, tmp_path), tolerance=TOLERANCE)
    rng = np.random.default_rng(1)
    assert least_moment(robot.lower.inertia)[0] < -1.0
    points = [robot.sample_parameters(rng) for _ in range(100)]
    points += [robot.physical_corner(which, rng)[0] for _ in range(5)]
    for point in points:
        assert (robot.lower.packed <= point.packed).all()
        assert (point.packed <= robot.upper.packed).all()
        assert (np.linalg.eigvalsh(point.inertia) > -1e-12).all()
        for q in rng.uniform(-2, 2, (5, 2)):
            assert np.linalg.eigvalsh(mr.mass_matrix(robot, q, parameters=point))[0] > 0.1


def test_a_corner_without_any_inertia_is_pulled_until_the_joint_feels_some(tmp_path: Path) -> None:
    """The last joint's only moment has 0 as its lower bound."""
    figures = {"name": "two", "com": "0 0 0", "mass": 0, "ixx": 0, "iyy": 4, "izz": 0}
    path = arm({}, tmp_path)
    text = path.read_text(encoding="utf-8")
    old = text[text.index('<link name="two">') : text.index('<joint name="a"')]
    path.write_text(text.replace(old, LINK.format(**figures)), encoding="utf-8")
    assembly = tmp_path / "over.yaml"
    assembly.write_text(
        "modrobust: 1\nrobot: over\nurdf: arm.urdf\nlinks: {two: {inertia: {yy: [0, 8]}}}\n",
        encoding="utf-8",
    )
    robot = mr.load_robot(assembly)
    point, pulled = robot.physical_corner("lower")
    assert pulled == robot.body_names
    assert point.inertia[1, 1, 1] == 2.0  # half way from nominal
    assert np.linalg.eigvalsh(mr.mass_matrix(robot, [0.1, 0.2], parameters=point))[0] > 0.0


def test_an_overlay_is_taken_as_the_urdf_is(tmp_path: Path) -> None:
    arm({"ixx": 14.6, "iyy": 14.6}, tmp_path)
    path = tmp_path / "over.yaml"
    path.write_text(
        "modrobust: 1\nrobot: over\nurdf: arm.urdf\nlinks: {one: {inertia: {xx: 1, yy: 1}}}\n",
        encoding="utf-8",
    )
    assert remarks(mr.load_robot(path)) == [
        "link one: largest principal moment 630 % above the sum of the other two; no rigid body "
        "has that; taken as written, since the mass matrix is positive definite"
    ]


def test_a_tolerance_leaves_a_mass_of_zero_as_it_is(tmp_path: Path) -> None:
    robot = mr.load_robot(arm({"mass": 0}, tmp_path), tolerance="mass=5%, inertia=10%")
    assert "one.mass" in robot.exact
    assert robot.lower.mass[0] == robot.upper.mass[0] == 0.0
    assert robot.lower.mass[1] < robot.upper.mass[1]


def test_mujoco_refuses_such_a_robot_by_the_name_of_the_link(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    path = arm({}, tmp_path)
    robot = mr.load_robot(path, tolerance=TOLERANCE)
    told = 'robot "arm": MuJoCo takes no body whose inertia no rigid body has, and such are one;'
    with pytest.raises(ValueRangeError, match=re.escape(told)):
        mr.simulate(robot, plant="mujoco", duration=0.01)
    video, mjcf = str(tmp_path / "out.mp4"), str(tmp_path / "out.xml")
    for words in (
        ["simulate", str(path), "--plant", "mujoco"],
        ["simulate", str(path), "--video", video],
        ["assemble", str(path), "--mjcf", mjcf],
    ):
        command = [sys.executable, "-m", "modrobust", *words]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        assert ended.returncode == 2
        assert told in ended.stderr
        assert "Traceback" not in ended.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arm.urdf"]


def test_the_urdf_and_pinocchio_take_it(tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    robot = mr.load_robot(arm({}, tmp_path), tolerance=TOLERANCE)
    model = pin.buildModelFromXML(urdf_text(robot).text)
    q, dq, ddq = np.random.default_rng(0).normal(size=(3, 2))
    theirs = pin.rnea(model, model.createData(), q, dq, ddq)
    np.testing.assert_allclose(mr.inverse_dynamics(robot, q, dq, dq, ddq), theirs, atol=1e-12)
    run = mr.simulate(robot, plant="pinocchio", duration=0.02, rate=1000.0)
    assert run.statistics is not None
    assert run.statistics.violations == 0


def test_excess_is_relative_to_the_other_two() -> None:
    tensors = np.array([np.diag(x) for x in ([1, 1, 2.2], [0, 0, 1], [1, 1, 2], [0, 0, 0.0])])
    np.testing.assert_allclose(excess(np.ones(4), tensors), [0.1, np.inf, 0, 0], rtol=1e-9)
    assert excess(np.zeros(4), tensors).tolist() == [np.inf, np.inf, np.inf, 0.0]


def test_a_point_of_an_unphysical_body_has_no_negative_moment() -> None:
    """Least second moment -7.3 as the nominal's, yet it would spin with negative energy."""
    nominal = np.diag([0.0, 0.0, 14.6])
    assert is_physical(nominal, nominal)
    assert is_physical(np.diag([0.5, 0.5, 15.0]), nominal)
    assert not is_physical(np.diag([1.4, -1.4, 14.6]), nominal)
    assert not is_physical(np.diag([0.0, 0.0, 14.7]), nominal)


MODULE = """modrobust: 1
module: part
name: part
source: made up
connectors: {in: {type: plate}}
chain:
  - joint: q
    type: revolute
  - body: link
    mass: 2 kg
    com: [0.1, 0, 0]
    inertia: {xx: 0.1, yy: 0.1, zz: 0.3, physical: WORD}
"""


def test_a_module_may_say_that_its_figures_are_meant(tmp_path: Path) -> None:
    module, path = tmp_path / "part.yaml", tmp_path / "robot.yaml"
    path.write_text("modrobust: 1\nrobot: robot\nmodules: .\nchain: [part]\n", encoding="utf-8")
    module.write_text(MODULE.replace("WORD", "as-written"), encoding="utf-8")
    assert remarks(mr.load_robot(path)) == [
        "body part.link: largest principal moment 50 % above the sum of the other two; no rigid "
        "body has that; taken as written, since the mass matrix is positive definite"
    ]
    module.write_text(MODULE.replace("WORD", "balanced"), encoding="utf-8")
    with pytest.raises(DescriptionError, match=r'inertia.physical: "balanced" is not allowed here'):
        mr.load_robot(path)


def test_no_word_lets_a_negative_moment_pass(tmp_path: Path) -> None:
    module, path = tmp_path / "part.yaml", tmp_path / "robot.yaml"
    path.write_text("modrobust: 1\nrobot: robot\nmodules: .\nchain: [part]\n", encoding="utf-8")
    text = MODULE.replace("WORD", "as-written").replace("xx: 0.1", "xx: -0.001")
    module.write_text(text, encoding="utf-8")
    with pytest.raises(DescriptionError, match=r"inertia.xx: -0.001 kg m\^2 is negative"):
        mr.load_robot(path)
