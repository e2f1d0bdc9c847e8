"""What other tools write about torque in a URDF: read where we have a field, named where not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import modrobust as mr
from support.urdf_texts import LIMIT, joint, link, robot, two_links, written

AXIS = '<axis xyz="0 0 1"/>'
STILL = 0.01  # kg m^2, the arm about its axis


def arm(folder: Path, dynamics: str = "", more: str = "", inside: str = "") -> mr.Robot:
    text = robot(
        link("base", ""), joint("turn", "base", "arm", inside=AXIS + LIMIT + dynamics + inside),
        link("arm"), more,
    ).replace("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ')  # fmt: skip
    return mr.load_robot(written(folder, text))


def named(loaded: mr.Robot) -> list[str]:
    """What makes torque and is not modelled, as far as the file says it; with its remark."""
    own = ("turn.drive", "turn.friction", "turn.friction.viscous", "turn.friction.coulomb")
    found = [name for name in loaded.not_modelled if name not in (*own, "disturbance")]
    remarks = [note for note in loaded.notes if note.startswith("not modelled, though")]
    assert len(remarks) == bool(found)
    return found


def inertia(loaded: mr.Robot) -> float:
    return float(mr.mass_matrix(loaded, np.zeros(1))[0, 0])


TORQUE = {
    'spring_stiffness="5" spring_reference="0.3"': ["turn.spring_stiffness"],
    'stiffness="500.0" spring_mount="1 0 0 0"': ["turn.stiffness"],
    'rotor_inertia="0.05"': ["turn.rotor_inertia"],
    'K="7000" D="1" mu_coulomb="0" mu_viscous="16" damping="0.003"': [
        "turn.K", "turn.D", "turn.mu_viscous",
    ],
    'frictionloss="0.1"': ["turn.frictionloss"],
    'spring_stiffness="0" spring_reference="0.3"': [],
    'rotor_inertia="0"': [],
    'friction="0.2" stiffness="much"': ["turn.stiffness"],
}  # fmt: skip


@pytest.mark.parametrize("attributes", TORQUE)
def test_what_makes_torque_in_dynamics_is_named(tmp_path: Path, attributes: str) -> None:
    loaded = arm(tmp_path, f"<dynamics {attributes}/>")
    assert named(loaded) == TORQUE[attributes]
    assert inertia(loaded) == STILL


def test_the_remark_names_words_and_joints_once(tmp_path: Path) -> None:
    loaded = arm(tmp_path, '<dynamics K="1" D="2"/>')
    assert (
        "not modelled, though the file gives it and it makes torque: K, D (turn); no bound holds "
        "it; give what it can make as a disturbance, or as drive or friction (joints:), in an "
        "assembly file"
    ) in loaded.notes


BESIDE = {
    '<gazebo reference="turn"><springStiffness>5</springStiffness></gazebo>': [
        "turn.gazebo springStiffness"
    ],
    '<gazebo reference="turn"><springStiffness>0</springStiffness></gazebo>': [],
    '<gazebo reference="turn"><implicitSpringDamper>1</implicitSpringDamper></gazebo>': [],
    '<gazebo reference="turn"><joint><axis><dynamics><damping>5</damping><friction>0</friction>'
    "</dynamics></axis></joint></gazebo>": ["turn.gazebo damping"],
    '<gazebo reference="arm"><kp>1e6</kp><mu1>0.5</mu1><turnGravityOff>true</turnGravityOff>'
    "</gazebo>": ["arm.gazebo turnGravityOff true"],
    '<gazebo reference="base"><turnGravityOff>true</turnGravityOff></gazebo>': [],
    '<mujoco><compiler meshdir="x" balanceinertia="true" boundmass="0"/></mujoco>': [
        "mujoco compiler balanceinertia"
    ],
    '<mujoco><option gravity="0 0 0"/></mujoco>': ["mujoco option gravity"],
    '<mujoco><joint name="turn" armature="0.1"/></mujoco>': ["mujoco joint armature"],
    "<drake:linear_bushing_rpy/>": ["<drake:linear_bushing_rpy> (line 5)"],
    '<drake:joint name="x" type="ball"/>': ["<drake:joint> (line 5)"],
    "<drake:collision_filter_group/>": [],
    '<transmission name="t"><joint name="turn"/><actuator name="m">'
    "<rotor_inertia>1e-4</rotor_inertia></actuator></transmission>": ["turn.rotor_inertia"],
    '<transmission name="t"><passive_joint name="turn"/></transmission>': [
        "<passive_joint> of transmission t"
    ],
}


@pytest.mark.parametrize("more", BESIDE)
def test_what_makes_torque_beside_the_joints_is_named(tmp_path: Path, more: str) -> None:
    assert named(arm(tmp_path, more=more)) == BESIDE[more]


def test_what_makes_torque_inside_a_joint_is_named(tmp_path: Path) -> None:
    assert named(arm(tmp_path, inside='<drake:rotor_inertia value="1e-4"/>')) == [
        "turn.drake:rotor_inertia"
    ]
    assert named(arm(tmp_path, inside='<joint_properties damping="0.1" friction="0"/>')) == [
        "turn.joint_properties damping"
    ]
    assert named(arm(tmp_path, inside='<joint_properties damping="0" friction="0"/>')) == []
    motor = '<hardware><motor rotor_inertia="1e-4"/></hardware>'
    assert named(arm(tmp_path, inside=motor)) == ["turn.motor rotor_inertia"]


def test_what_a_locked_joint_says_is_not_missed(tmp_path: Path) -> None:
    text = robot(
        link("base"), link("arm"), link("tip"),
        joint("turn", "base", "arm"),
        joint("last", "arm", "tip", inside=AXIS + LIMIT + '<dynamics spring_stiffness="5"/>'),
    )  # fmt: skip
    path = written(tmp_path, text)
    assert "last.spring_stiffness" in mr.load_robot(path).not_modelled
    assert "last.spring_stiffness" not in mr.load_robot(path, lock={"last": 0}).not_modelled


def test_an_armature_is_read_on_the_joint_s_side(tmp_path: Path) -> None:
    loaded = arm(tmp_path, '<dynamics armature="0.05"/>')
    assert inertia(loaded) == pytest.approx(STILL + 0.05, rel=1e-15)
    assert named(loaded) == []
    assert "turn.drive" not in loaded.not_modelled
    told = "armature read as a rotor_inertia with a gear_ratio of 1"
    assert f"{told}: turn" in loaded.notes
    geared = transmission("<mechanicalReduction>100</mechanicalReduction>")
    loaded = arm(tmp_path, '<dynamics armature="0.05"/>', geared)
    assert inertia(loaded) == pytest.approx(STILL + 0.05, rel=1e-15)
    aside = "not the transmission's, since it is on the joint's side"
    assert f"{told}, {aside}: turn" in loaded.notes
    assert inertia(arm(tmp_path, '<dynamics armature="0"/>')) == STILL


def test_a_drive_in_an_assembly_file_counts_more_than_an_armature(tmp_path: Path) -> None:
    text = two_links(AXIS + LIMIT + '<dynamics armature="0.05"/>')
    written(tmp_path, text)
    overlay = (
        "modrobust: 1\nrobot: over\nurdf: small.urdf\n"
        "joints: {turn: {drive: {gear_ratio: 10, rotor_inertia: 1e-3}}}\n"
    )
    loaded = mr.load_robot(written(tmp_path, overlay, "over.yaml"))
    assert inertia(loaded) == pytest.approx(STILL + 0.1, rel=1e-15)
    assert (
        "joint turn: armature of 0.05 left out, since an assembly file gives its drive"
        in loaded.notes
    )


def transmission(inside: str) -> str:
    return (
        '<transmission name="t"><type>x</type><joint name="turn"/>'
        f'<actuator name="m">{inside}</actuator></transmission>'
    )


DRAKE = '<drake:rotor_inertia value="1e-4"/>'


def test_drakes_rotor_inertia_acts_through_its_gear_ratio(tmp_path: Path) -> None:
    loaded = arm(tmp_path, more=transmission(DRAKE + '<drake:gear_ratio value="100"/>'))
    assert loaded.gear_ratio.tolist() == [100.0]
    assert loaded.nominal.rotor_inertia.tolist() == [1e-4]
    assert inertia(loaded) == pytest.approx(STILL + 1.0, rel=1e-15)
    assert named(loaded) == []


def test_without_a_gear_ratio_of_its_own_drakes_is_1_and_that_is_said(tmp_path: Path) -> None:
    reduced = "<mechanicalReduction>100</mechanicalReduction>"
    loaded = arm(tmp_path, more=transmission(DRAKE + reduced))
    assert inertia(loaded) == pytest.approx(STILL + 1e-4, rel=1e-15)
    assert (
        "transmission t: its mechanicalReduction of 100 left out; drake:rotor_inertia acts through "
        "drake:gear_ratio, which is 1 where it is not written"
    ) in loaded.notes
    assert inertia(arm(tmp_path, more=transmission(DRAKE))) == pytest.approx(STILL + 1e-4)


def test_an_armature_beside_a_rotor_inertia_is_refused(tmp_path: Path) -> None:
    with pytest.raises(mr.ModrobustError, match="both are the inertia of the motor"):
        arm(tmp_path, '<dynamics armature="0.05"/>', transmission(DRAKE))


def test_a_limit_of_acceleration_is_read_in_each_spelling(tmp_path: Path) -> None:
    for spelling in ("acceleration", "drake:acceleration"):
        limits = LIMIT.replace("/>", f' {spelling}="10"/>')
        text = two_links(AXIS + limits)
        text = text.replace("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ')
        loaded = mr.load_robot(written(tmp_path, text))
        assert loaded.acceleration_limits.tolist() == [10.0]
        assert loaded.to_dict()["joints"][0]["limits"]["acceleration"] == 10.0
    limits = LIMIT.replace("/>", ' acceleration="10" deceleration="12" jerk="500"/>')
    text = two_links(AXIS + limits).replace("<robot ", '<robot version="1.2" ')
    loaded = mr.load_robot(written(tmp_path, text))
    assert loaded.acceleration_limits.tolist() == [10.0]
    assert "limits of deceleration and jerk are not looked at (turn)" in loaded.notes


def test_limits_of_real_files_that_say_nothing_here_are_passed(tmp_path: Path) -> None:
    limits = LIMIT.replace("/>", ' command_effort="40" current="10" gear_velocity="10"/>')
    loaded = mr.load_robot(written(tmp_path, two_links(AXIS + limits)))
    assert loaded.effort_limits.tolist() == [30.0]


QUATERNIONS = {
    "0 0.7071067811865476 0 0.7071067811865476": "0 1.5707963267948966 0",
    "0.5 0.5 0.5 0.5": "1.5707963267948966 0 1.5707963267948966",
    "0 0 0.3826834323650898 0.9238795325112867": "0 0 0.7853981633974483",
    "-0.2 0.4 -0.4 0.8": None,
}


@pytest.mark.parametrize("quaternion", QUATERNIONS)
def test_a_quaternion_turns_as_its_angles_do(tmp_path: Path, quaternion: str) -> None:
    inside = f'<origin xyz="0.1 0.2 0.3" quat_xyzw="{quaternion}"/>' + AXIS + LIMIT
    text = two_links(inside).replace("<robot ", '<robot version="1.1" ')
    turned = mr.load_robot(written(tmp_path, text)).before[0]
    x, y, z, w = (float(part) for part in quaternion.split())
    assert turned[:3, 3].tolist() == [0.1, 0.2, 0.3]
    for vector in np.eye(3):  # p + 2 w (u x p) + 2 u x (u x p), another way to write q p q*
        u = np.array([x, y, z])
        expected = vector + 2.0 * w * np.cross(u, vector) + 2.0 * np.cross(u, np.cross(u, vector))
        np.testing.assert_allclose(turned[:3, :3] @ vector, expected, atol=1e-15)
    angles = QUATERNIONS[quaternion]
    if angles is not None:
        inside = f'<origin xyz="0.1 0.2 0.3" rpy="{angles}"/>' + AXIS + LIMIT
        written_so = mr.load_robot(written(tmp_path, two_links(inside))).before[0]
        np.testing.assert_allclose(turned, written_so, atol=2e-16)


def test_a_quaternion_to_a_plate_on_the_wall_makes_the_torque_of_gravity(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>'
    body = f'<inertial><origin xyz="0.3 0 0"/><mass value="2"/>{tensor}</inertial>'
    mount = '<origin xyz="0 0 0.5" quat_xyzw="0 0.7071067811865476 0 0.7071067811865476"/>'
    text = robot(
        link("base", ""), joint("mount", "base", "plate", "fixed", mount), link("plate", ""),
        joint("turn", "plate", "arm", inside=AXIS + LIMIT), link("arm", body),
    ).replace("<robot ", '<robot version="1.1" ')  # fmt: skip
    loaded = mr.load_robot(written(tmp_path, text))
    still = np.zeros(1)
    lo, hi = mr.inverse_dynamics_bounds(loaded, [0.7], still, still, still)
    assert lo[0] <= 2 * 9.81 * 0.3 * np.sin(0.7) <= hi[0]
    assert hi[0] - lo[0] < 1e-12


def test_a_quaternion_of_no_rotation_or_beside_rpy_is_refused(tmp_path: Path) -> None:
    for given, told in (
        ('quat_xyzw="0 0 0 0"', "length 0; the four numbers"),
        ('quat_xyzw="0 0 1 1"', r"length 1\.41421"),
        ('quat_xyzw="0 0 1"', "3 entries; a vector has four"),
        ('quat_xyzw="0 0 0 1" rpy="0 0 0"', "beside rpy; an origin is rotated once"),
    ):
        text = two_links(f"<origin {given}/>" + AXIS + LIMIT)
        text = text.replace("<robot ", '<robot version="1.1" ')
        with pytest.raises(mr.ModrobustError, match=told):
            mr.load_robot(written(tmp_path, text))
