"""What a URDF becomes: frames, axes, bodies, bounds, selection; dynamics against Pinocchio."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import modrobust as mr
from modrobust.model import ModuleNode
from support.float_transforms import rotation_to
from support.pinocchio_urdf import pinocchio_terms
from support.urdf_texts import INERTIA, INERTIAL, LIMIT, joint, link, robot, two_links, written

Array = NDArray[np.float64]
RNG = 20261123
AXES = [
    "1 0 0", "0 1 0", "0 0 1", "-1 0 0", "0 -1 0", "0 0 -1", "1 2 -3", "-0.3 0.2 -0.9",
    "1e-9 0 -1", "3e-160 4e-160 0", "0.5773502691896258 0.5773502691896258 0.5773502691896258",
]  # fmt: skip


def branched() -> str:
    """Six joints of every kind, oblique axes, turned inertials, fixed links, two branches."""
    pose = '<origin xyz="0.1 -0.02 0.03" rpy="0.3 -0.4 0.5"/>'
    turned = f'<inertial>{pose}<mass value="1.5"/>{INERTIA}</inertial>'
    slide = '<origin xyz="0.1 0 0.2" rpy="0 1.57079632679 0.2"/><axis xyz="1 2 -3"/>' + LIMIT
    oblique = '<origin xyz="0 0.2 0.1" rpy="0.1 0.2 -0.3"/><axis xyz="-1 0.4 0"/>' + LIMIT
    spin = '<origin rpy="-1.2 0 0"/><axis xyz="0 0 -1"/>'
    weld = '<origin xyz="0.05 0.06 -0.07" rpy="0.4 -0.5 0.6"/>'
    return robot(
        link("base"), link("a"), link("b", turned), link("plate", turned), link("c"), link("d"),
        link("e", turned), link("tool", ""), link("f"),
        joint("a1", "base", "a"), joint("b1", "a", "b", "prismatic", slide),
        joint("plate1", "b", "plate", "fixed", weld), joint("c1", "plate", "c", "continuous", spin),
        joint("d1", "a", "d", inside=oblique), joint("e1", "d", "e", inside=oblique),
        joint("tool1", "e", "tool", "fixed", weld), joint("f1", "tool", "f", inside=oblique),
    )  # fmt: skip


def assert_agrees(
    path: Path, arm: mr.Robot, locked: dict[str, float] | None = None, states: int = 5
) -> None:
    rng = np.random.default_rng(RNG)
    rest = np.zeros(arm.n)
    for _ in range(states):
        q, dq, ddq = rng.uniform(-1.5, 1.5, (3, arm.n))
        tau, g, M = pinocchio_terms(path, arm.joint_names, q, dq, ddq, locked or {})
        pairs = (
            (mr.inverse_dynamics(arm, q, dq, dq, ddq, drives=False), tau),
            (mr.inverse_dynamics(arm, q, rest, rest, rest, drives=False), g),
            (mr.mass_matrix(arm, q, drives=False), M),
        )
        for ours, theirs in pairs:
            scale = max(np.max(np.abs(theirs)), 1e-3)
            np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-9 * scale)


def test_a_branched_robot_has_the_dynamics_that_pinocchio_reads(tmp_path: Path) -> None:
    path = written(tmp_path, branched())
    arm = mr.load_robot(path)
    assert arm.joint_names == ("a1", "b1", "c1", "d1", "e1", "f1")
    assert arm.parents.tolist() == [-1, 0, 1, 0, 3, 4]
    assert_agrees(path, arm)


@pytest.mark.parametrize("axis", AXES)
def test_a_joint_about_any_axis_is_a_joint_about_z(tmp_path: Path, axis: str) -> None:
    inside = f'<origin xyz="0.1 0.2 0.3" rpy="0.3 0.1 -0.2"/><axis xyz="{axis}"/>{LIMIT}'
    path = written(tmp_path, two_links(inside))
    arm = mr.load_robot(path)
    written_axis = [Fraction(text) for text in axis.split()]
    direction = np.array([float(text / max(map(abs, written_axis))) for text in written_axis])
    unit = direction / np.linalg.norm(direction)
    turned = rotation_to(written_axis)
    np.testing.assert_allclose(turned[:3, :3] @ turned[:3, :3].T, np.eye(3), atol=1e-15)
    assert np.linalg.det(turned[:3, :3]) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(turned[:3, 2], unit, atol=1e-15)
    assert np.array_equal(arm.after[0], turned.T)
    if "e-160" not in axis:  # whose square is 0 for Pinocchio
        assert_agrees(path, arm)


def test_an_axis_along_a_coordinate_is_exact(tmp_path: Path) -> None:
    for axis in AXES[:6]:
        turned = rotation_to([Fraction(text) for text in axis.split()])
        assert set(np.abs(turned).ravel().tolist()) == {0.0, 1.0}
    arm = mr.load_robot(written(tmp_path, two_links()))
    assert np.array_equal(arm.after[0], np.eye(4))


def test_an_angle_near_a_right_one_is_not_snapped(tmp_path: Path) -> None:
    inside = '<origin rpy="1.57079632679 0 0"/><axis xyz="0 0 1"/>' + LIMIT
    arm = mr.load_robot(written(tmp_path, two_links(inside)))
    # Of the decimal as written; the cosine of its nearest double is 4.89658...e-12.
    assert arm.before[0, 1, 1] == 4.896619231321692e-12  # pi/2 - 1.57079632679
    assert arm.before[0, 1, 1] != 0.0


def test_pitch_is_not_transposed(tmp_path: Path) -> None:
    inside = '<origin rpy="0 0.5 0"/><axis xyz="0 0 1"/>' + LIMIT
    arm = mr.load_robot(written(tmp_path, two_links(inside)))
    c, s = math.cos(0.5), math.sin(0.5)
    turned = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    np.testing.assert_allclose(arm.before[0, :3, :3], turned, atol=1e-15)


def test_a_body_keeps_the_frame_that_makes_its_figures_exact(tmp_path: Path) -> None:
    arm = mr.load_robot(written(tmp_path, branched()))
    a, b = arm.body_names.index("a"), arm.body_names.index("b")
    assert np.array_equal(arm.placement[a], np.eye(4))
    assert arm.nominal.com[a].tolist() == [0.0, 0.0, 0.1]
    assert arm.placement[b][:3, 3].tolist() == [0.1, -0.02, 0.03]
    assert arm.nominal.com[b].tolist() == [0.0, 0.0, 0.0]


def test_links_behind_a_fixed_joint_stay_bodies_of_their_own(tmp_path: Path) -> None:
    arm = mr.load_robot(written(tmp_path, branched()))
    own = dict(zip(arm.body_names, arm.body_joints.tolist(), strict=True))
    assert own == {"base": -1, "a": 0, "b": 1, "plate": 1, "c": 2, "d": 3, "e": 4, "f": 5}


def test_a_locked_joint_moves_with_its_parent(tmp_path: Path) -> None:
    path = written(tmp_path, branched())
    locked: dict[str, float | str] = {"b1": 0.2, "e1": "-0.7 rad"}
    arm = mr.load_robot(path, lock=locked)
    assert arm.joint_names == ("a1", "c1", "d1", "f1")
    assert_agrees(path, arm, {"b1": 0.2, "e1": -0.7})


def mimicking() -> str:
    """One joint is the leader of three: one beside, one behind, one that mimics the second."""
    axis = '<origin xyz="0 0.1 0.2" rpy="0.3 0 0.1"/><axis xyz="1 0 0.4"/>' + LIMIT

    def mimicking(leader: str, multiplier: float, offset: float) -> str:
        return f'{axis}<mimic joint="{leader}" multiplier="{multiplier}" offset="{offset}"/>'

    return robot(
        link("base", ""), *(link(name) for name in ("a", "b", "c", "d", "e")),
        joint("d1", "a", "d", "prismatic", mimicking("b1", -0.25, 0.1)), joint("a1", "base", "a"),
        joint("b1", "a", "b", inside=axis), joint("c1", "b", "c", inside=mimicking("b1", 0.5, 0.0)),
        joint("e1", "c", "e", inside=mimicking("c1", 0.8, -0.05)),
    )  # fmt: skip


def test_joints_that_mimic_follow_with_their_torque_on_the_leader(tmp_path: Path) -> None:
    path = written(tmp_path, mimicking())
    arm = mr.load_robot(path)
    assert arm.joint_names == ("a1", "b1")
    mimic_joints = dict(zip(arm.mimic.names, arm.mimic.multiplier.tolist(), strict=True))
    assert mimic_joints == {"d1": -0.25, "c1": 0.5, "e1": 0.4}
    names = ("a1", "b1", "c1", "d1", "e1")
    G = np.array([[1, 0], [0, 1], [0, 0.5], [0, -0.25], [0, 0.4]])
    offset = np.array([0, 0, 0, 0.1, -0.05])
    rng = np.random.default_rng(RNG)
    for _ in range(5):
        q, dq, ddq = rng.uniform(-1.5, 1.5, (3, 2))
        tau, _, M = pinocchio_terms(path, names, G @ q + offset, G @ dq, G @ ddq, {})
        ours = mr.inverse_dynamics(arm, q, dq, dq, ddq, drives=False)
        np.testing.assert_allclose(ours, G.T @ tau, rtol=1e-9)
        np.testing.assert_allclose(mr.mass_matrix(arm, q, drives=False), G.T @ M @ G, rtol=1e-9)


def test_a_leader_keeps_its_mimic_joints_within_their_limits(tmp_path: Path) -> None:
    arm = mr.load_robot(written(tmp_path, mimicking()))
    # d1 in [-2, 2.5] with q = -0.25 b1 + 0.1 allows more; e1 = 0.4 b1 - 0.05 as well.
    assert arm.position_limits[1].tolist() == [-2.0, 2.5]
    faster = mimicking().replace('multiplier="0.5"', 'multiplier="2"')
    arm = mr.load_robot(written(tmp_path, faster))
    assert arm.position_limits[1].tolist() == [-1.0, 1.25]
    assert arm.velocity_limits[1] == 0.75
    assert any("so that joint c1, which mimics it, keeps its own" in note for note in arm.notes)


def test_limits_that_a_mimic_joint_can_never_keep_are_left_out_and_said(tmp_path: Path) -> None:
    arm = mr.load_robot(written(tmp_path, mimicking().replace('offset="0.1"', 'offset="9"')))
    assert arm.position_limits[1].tolist() == [-2.0, 2.5]
    told = "joint d1: its position limits left out; mimicking b1 it is never inside them"
    assert told in arm.notes


def test_a_lock_of_the_leader_locks_its_mimic_joints(tmp_path: Path) -> None:
    path = written(tmp_path, mimicking())
    arm = mr.load_robot(path, lock={"b1": 0.4})
    assert arm.joint_names == ("a1",)
    assert_agrees(path, arm, {"b1": 0.4, "c1": 0.2, "d1": 0.0, "e1": 0.11})


def test_base_and_tip_select_a_chain(tmp_path: Path) -> None:
    path = written(tmp_path, branched())
    arm = mr.load_robot(path, base="a", tip="e")
    assert arm.joint_names == ("d1", "e1")
    assert arm.body_names == ("a", "d", "e")
    assert arm.notes[-3:] == (
        "left out behind joint b1, since the chain ends at e: b, plate, c (5 kg)",
        "left out behind joint tool1, since the chain ends at e: f (2 kg)",
        "upright is the root base of the URDF; between it and the base a moves what is held still "
        "here: joint a1 at 0 rad; where it stands elsewhere, gravity has another direction: lock "
        "it there (lock:), or turn the root (base: {rpy})",
    )
    ends = mr.load_robot(path, base="a", tip="tool")
    q = np.array([0.3, -0.4])
    last = mr.forward_kinematics(arm, q)[-1]
    tip = mr.forward_kinematics(ends, q)[-1]
    behind = np.linalg.inv(last) @ tip
    np.testing.assert_allclose(behind[:3, 3], [0.05, 0.06, -0.07], atol=1e-15)
    np.testing.assert_allclose(mr.mass_matrix(ends, q), mr.mass_matrix(arm, q), rtol=1e-13)


def test_limits_friction_and_reductions_are_taken(tmp_path: Path) -> None:
    text = robot(
        link("base", ""), link("arm"), link("rail"),
        joint("turn", "base", "arm",
              inside=LIMIT + '<dynamics damping="0.7" friction="1.2"/>'),
        joint("slide", "arm", "rail", "prismatic", LIMIT + '<dynamics damping="0"/>'),
        '<transmission name="t"><type>x</type><joint name="turn"/><actuator name="m">'
        "<mechanicalReduction>-100</mechanicalReduction></actuator></transmission>",
    )  # fmt: skip
    arm = mr.load_robot(written(tmp_path, text))
    assert arm.position_limits.tolist() == [[-2.0, 2.5], [-2.0, 2.5]]
    assert arm.effort_limits.tolist() == [30.0, 30.0]
    assert arm.velocity_limits.tolist() == [1.5, 1.5]
    assert arm.nominal.viscous.tolist() == [0.7, 0.0]
    assert arm.nominal.coulomb.tolist() == [1.2, 0.0]
    assert arm.gear_ratio.tolist() == [100.0, 0.0]
    assert "slide.friction" in arm.not_modelled  # damping="0" is how "not known" is written


def test_a_continuous_joint_has_no_position_limits(tmp_path: Path) -> None:
    arm = mr.load_robot(written(tmp_path, two_links(LIMIT, kind="continuous")))
    assert arm.joint_types == ("continuous",)
    assert arm.to_dict()["joints"][0]["type"] == "continuous"
    assert np.isinf(arm.position_limits).all()


def test_without_bounds_everything_is_said_to_be_exact(tmp_path: Path) -> None:
    path = written(tmp_path, two_links())
    arm = mr.load_robot(path)
    assert np.array_equal(arm.lower.packed, arm.upper.packed)
    assert arm.notes[0].startswith(
        "no bounds are given: every figure of the URDF is taken as exact"
    )
    bounded = mr.load_robot(path, tolerance="mass=5%,com=5mm,inertia=10%")
    assert not any("exact" in note for note in bounded.notes)
    assert bounded.lower.mass[0] <= 1.9 <= 2.1 <= bounded.upper.mass[0]
    assert bounded.upper.com[0, 2] >= 0.105
    assert bounded.upper.inertia[0, 0, 1] >= 0.003  # 10 % of the largest principal moment


def test_a_payload_hangs_in_the_frame_of_its_link(tmp_path: Path) -> None:
    path = written(tmp_path, branched())
    arm = mr.load_robot(path, payload="mass=[0 kg, 2 kg], com=[0, 0, [20 mm, 80 mm]], at=tool")
    k = arm.body_names.index("payload")
    assert arm.body_joints[k] == 4
    np.testing.assert_allclose(arm.placement[k][:3, 3], [0.05, 0.06, -0.07])
    assert (arm.lower.mass[k], arm.upper.mass[k]) == (0.0, 2.0)
    with pytest.raises(mr.ModrobustError, match='no "at"; this robot has several ends'):
        mr.load_robot(path, payload="mass=1 kg, com=[0, 0, 0]")


OVERLAY = """
modrobust: 1
robot: overlaid
urdf: small.urdf
base_link: base
lock: {b1: 100 mm, c1: 90 deg}
tolerance: {mass: 5%, com: 5 mm, inertia: 10%}
links:
  a: {mass: "[1.9 kg, 2.2 kg]", com: [0, 0, "[80 mm, 120 mm]"], inertia: {xx: 0.021}}
  e: {com: [0.1, 0, 0], inertia: {xx: 0.02, yy: 0.03, zz: 0.02}}
  tool: {mass: 0.3 kg ± 1%, com: [0, 0, 0], inertia: {xx: 1e-3, yy: 1e-3, zz: 1e-3}}
joints:
  a1: {drive: {gear_ratio: 100, rotor_inertia: 1e-5 ± 20%}, limits: {torque: 50 N m}}
  d1: {friction: {viscous: "[0, 2]", coulomb: 1 N m ± 50%}}
payload: {at: tool, mass: "[0 kg, 1 kg]", com: [0, 0, 30 mm]}
disturbance: 0 ± 0.5 N m
controller: {K_r: 12, epsilon: 0.02 rad}
initial: {q: {a1: 0, d1: 10 deg, e1: 0, f1: 0}}
"""


def test_an_assembly_file_lays_over_a_urdf_what_a_urdf_cannot_say(tmp_path: Path) -> None:
    written(tmp_path, branched())
    arm = mr.load_robot(written(tmp_path, OVERLAY.replace('"', ""), "overlaid.yaml"))
    assert arm.name == "overlaid"
    assert arm.joint_names == ("a1", "d1", "e1", "f1")
    at = arm.body_names.index
    assert (arm.lower.mass[at("a")], arm.upper.mass[at("a")]) == (1.9, 2.2)
    assert arm.nominal.inertia[at("a")].diagonal().tolist() == [0.021, 0.03, 0.01]
    assert np.array_equal(arm.placement[at("e")], np.eye(4))  # both given: in link axes
    assert arm.nominal.com[at("e")].tolist() == [0.1, 0.0, 0.0]
    assert arm.nominal.mass[at("tool")] == 0.3
    assert arm.gear_ratio.tolist() == [100.0, 0.0, 0.0, 0.0]
    assert arm.upper.rotor_inertia[0] >= 1.2e-5
    assert arm.effort_limits.tolist() == [50.0, 30.0, 30.0, 30.0]
    assert arm.upper.viscous.tolist() == [0.0, 2.0, 0.0, 0.0]
    assert arm.disturbance.hi.tolist() == [0.5] * 4
    assert arm.controller.K_r == (12.0,) * 4
    assert arm.body_joints[at("payload")] == arm.body_joints[at("tool")]


REFUSED = {
    "links: {amr: {mass: 1 kg}}": (
        'small.yaml:4: links.amr: no link named "amr"; did you mean "arm"? known: base, arm'
    ),
    "joints: {turm: {limits: {}}}": (
        'small.yaml:4: joints.turm: no joint named "turm"; did you mean "turn"? known: turn'
    ),
    "links: {base: {mass: 1 kg}}": (
        "small.yaml:4: links.base: no com, inertia; the URDF gives this link no inertial; give "
        "mass, com and inertia"
    ),
    "links: {arm: {mas: 1 kg}}": (
        'small.yaml:4: links.arm: unknown key "mas"; did you mean "mass"? known: mass, com, inertia'
    ),
    "chain: [tool]": (
        "small.yaml:4: chain: beside urdf; a robot is of modules or of a URDF; remove one"
    ),
    "lock: {turn: 4 rad}": (
        "small.yaml:4: lock.turn: 4 lies outside the joint's limits [-2, 2.5] (line 3); lock it at "
        "a position that it can have"
    ),
    "links: {arm: {com: [0, 0, 0]}}": (
        "small.yaml:4: links.arm: one of com and inertia; the URDF gives this link's inertial in "
        "rotated axes (line 4) and an overlay is in the axes of the link; give com and all six "
        "entries of inertia, or neither"
    ),
}


@pytest.mark.parametrize("line", REFUSED)
def test_a_fault_of_an_overlay_is_refused_at_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str
) -> None:
    turned = INERTIAL.replace('xyz="0 0 0.1"', 'xyz="0 0 0.1" rpy="0.1 0 0"')
    written(tmp_path, two_links(inside_link=turned))
    monkeypatch.chdir(tmp_path)
    text = f"modrobust: 1\nrobot: small\nurdf: small.urdf\n{line}\n"
    written(tmp_path, text, "small.yaml")
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot("small.yaml")
    assert str(caught.value) == REFUSED[line]


PACKAGES = {
    "package:no-such-package/a.urdf": (
        'package "no-such-package" is not installed; its URDF comes with it; '
        "pip install no-such-package"
    ),
    "package:numpy/../../etc/passwd.urdf": (
        '"package:numpy/../../etc/passwd.urdf" is not package:NAME/PATH with a path inside the '
        "package; write e.g. package:example_robot_data/robots/ur_description/urdf/ur5_robot.urdf"
    ),
    "package:numpy/no.urdf": (
        'package "numpy" has no file whose path ends in "no.urdf"; give the path of one file '
        "inside the package"
    ),
}


@pytest.mark.parametrize("urdf", PACKAGES)
def test_a_urdf_of_no_package_is_refused(tmp_path: Path, urdf: str) -> None:
    path = written(tmp_path, f"modrobust: 1\nrobot: small\nurdf: {urdf}\n", "small.yaml")
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(path)
    assert str(caught.value) == f"{path}:3: urdf: {PACKAGES[urdf]}"


def test_figures_that_look_made_up_are_named(tmp_path: Path) -> None:
    same = INERTIAL.replace("0.02", "1").replace("0.03", "1").replace("0.01", "1")
    text = robot(
        link("base", ""), *(link(name, same) for name in "abc"),
        joint("a1", "base", "a"), joint("b1", "a", "b"), joint("c1", "b", "c"),
    )  # fmt: skip
    notes = mr.load_robot(written(tmp_path, text)).notes
    assert (
        "the same inertia tensor on 3 links (a, b, c): placeholders? no bound around a made-up "
        "figure holds the true one"
    ) in notes
    tiny = same.replace('"2"', '"0.01"')
    notes = mr.load_robot(written(tmp_path, two_links(inside_link=tiny))).notes
    assert (
        "link arm: 0.01 kg with a radius of gyration of 12.2 m: a placeholder? no bound around a "
        "made-up figure holds the true one"
    ) in notes


def test_what_does_not_move_may_be_wrong_and_is_left_out_with_a_note(tmp_path: Path) -> None:
    wrong = INERTIAL.replace('"2"', '"-2"')
    arm = mr.load_robot(
        written(tmp_path, two_links().replace(link("base", ""), link("base", wrong)))
    )
    assert arm.body_names == ("arm",)
    assert any(
        note.startswith("link base, mass: left out, since it does not move") for note in arm.notes
    )


def test_a_tensor_of_zeros_is_a_point_mass_and_said_to_be(tmp_path: Path) -> None:
    zeros = " ".join(f'i{entry}="0"' for entry in ("xx", "xy", "xz", "yy", "yz", "zz"))
    point = f'<inertial><origin xyz="0.2 0 0"/><mass value="2"/><inertia {zeros}/></inertial>'
    arm = mr.load_robot(written(tmp_path, two_links(inside_link=point)))
    assert mr.mass_matrix(arm, [0.0])[0, 0] == pytest.approx(0.08)
    assert any(note.startswith("link arm: taken as a point mass") for note in arm.notes)


def test_xacro_is_expanded_where_its_package_is_there(tmp_path: Path) -> None:
    pytest.importorskip("xacro")
    macro = two_links().replace(
        '<robot name="small">',
        '<robot name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:property name="h" value="${0.1 * 3}"/>',
    )
    path = written(tmp_path, macro.replace("0 0 0.3", "0 0 ${h}"), "small.xacro")
    assert mr.load_robot(path).before[0, 2, 3] == pytest.approx(0.3)
    broken = written(tmp_path, macro.replace("0 0 0.3", "0 0 ${nothing}"), "broken.xacro")
    with pytest.raises(mr.ModrobustError, match=r"xacro cannot expand it: .*nothing"):
        mr.load_robot(broken)


def test_xacro_without_its_package_says_how(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    path = written(tmp_path, two_links(), "small.xacro")
    with pytest.raises(mr.ModrobustError, match='pip install "modrobust\\[xacro\\]"'):
        mr.load_robot(path)


def test_branches_of_a_robot_hang_on_the_link_that_they_leave(tmp_path: Path) -> None:
    loaded = mr.load_robot(written(tmp_path, branched()))

    def shown(nodes: tuple[ModuleNode, ...]) -> list[object]:
        return [(node.instance, shown(node.children)) for node in nodes]

    arm: object = ("b", [("c", [])])
    other: object = ("d", [("e", []), ("f", [])])
    assert shown(loaded.modules) == [("base", []), ("a", [arm, other])]


def test_the_law_of_a_urdf_alone_is_auto(tmp_path: Path) -> None:
    loaded = mr.load_robot(written(tmp_path, two_links()))
    assert (loaded.controller.law, loaded.controller.epsilon) == ("auto", 0.01)
