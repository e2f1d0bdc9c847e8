"""Exported URDF and MJCF, read by engines that are not ours, move as our own dynamics say."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import modrobust as mr
from export.engine_twins import MjcfTwin, UrdfTwin
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.model import Bounded, Parameters, Robot
from modrobust.model.orientation import quaternion, roll_pitch_yaw
from support.random_robots import random_robot, random_state, steiner, tied
from support.ready_robots import available
from support.states import state_of

TOLERANCE = 1e-12  # of the largest entry


def cases() -> list[Robot]:
    rng = np.random.default_rng(3)
    return [
        random_robot(rng, 6),
        random_robot(rng, types="rprp", simple=True),
        random_robot(rng, 9, tree=True),
        random_robot(rng, 12),
        tied(random_robot(rng, 6, tree=True), 4, rng),
        tied(random_robot(rng, types="rrprr"), 3, rng, anywhere=True),
        *available(),
    ]


@pytest.fixture(scope="module", params=cases(), ids=lambda robot: robot.name)
def robot(request: pytest.FixtureRequest) -> Robot:
    return request.param


def points(robot: Robot) -> dict[str, Parameters]:
    return {
        "nominal": robot.nominal,
        "random": robot.sample_parameters(5),
        "upper": robot.physical_corner("upper")[0],
        "lower": robot.physical_corner("lower")[0],
        "corner": robot.physical_corner("corner", 6)[0],
    }


def without_coulomb(point: Parameters) -> Parameters:
    return replace(point, coulomb=0.0 * point.coulomb)


def assert_close(ours: Any, theirs: Any) -> None:
    np.testing.assert_allclose(theirs, ours, rtol=0, atol=TOLERANCE * np.abs(ours).max())


def losses(text: str) -> str:
    return text.split("<!--")[1].split("-->")[0]


def test_the_exported_urdf_has_the_same_dynamics_in_pinocchio(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    for point in points(robot).values():
        twin = UrdfTwin(urdf_text(robot, point).text, robot)
        q, dq, _, ddq = random_state(rng, robot.n)
        ours = mr.inverse_dynamics(robot, q, dq, dq, ddq, point, drives=False)
        assert_close(ours, twin.rnea(q, dq, ddq))
        assert_close(mr.mass_matrix(robot, q, point, drives=False), twin.mass_matrix(q))


def test_the_exported_mjcf_has_the_same_dynamics_in_mujoco_with_armature_and_damping(
    robot: Robot,
) -> None:
    rng = np.random.default_rng(2)
    for point in points(robot).values():
        twin = MjcfTwin(mjcf_text(robot, point).text, robot)
        q, dq, _, ddq = random_state(rng, robot.n)
        ours = mr.inverse_dynamics(robot, q, dq, dq, ddq, without_coulomb(point))
        assert_close(ours, twin.inverse_dynamics(q, dq, ddq))
        assert_close(mr.mass_matrix(robot, q, point), twin.mass_matrix(q))


def test_mujoco_reads_coulomb_friction_gravity_and_the_integrator(robot: Robot) -> None:
    point = robot.sample_parameters(5)
    twin = MjcfTwin(mjcf_text(robot, point, timestep=2e-4).text, robot)
    np.testing.assert_array_equal(twin.model.dof_frictionloss[twin.dofs], point.coulomb)
    np.testing.assert_array_equal(twin.model.opt.gravity, robot.gravity)
    assert twin.model.opt.timestep == 2e-4
    assert twin.model.opt.integrator == twin.mujoco.mjtIntegrator.mjINT_RK4.value
    assert not twin.model.jnt_limited.any()
    assert not twin.model.actuator_ctrllimited.any()
    tau = np.random.default_rng(6).normal(size=robot.n)
    twin.data.ctrl[:] = tau
    twin.mujoco.mj_forward(twin.model, twin.data)
    np.testing.assert_array_equal(twin.data.qfrc_actuator[twin.dofs[: robot.n]], tau)


def test_the_frames_of_the_exported_urdf_are_ours(robot: Robot) -> None:
    import pinocchio as pin

    twin = UrdfTwin(urdf_text(robot).text, robot)
    q = np.random.default_rng(4).uniform(-1.0, 1.0, robot.n)
    pin.framesForwardKinematics(twin.model, twin.data, twin.q(q))
    ours = mr.forward_kinematics(robot, q)
    for i in sorted(set(range(robot.j)) - set(robot.parents.tolist())):
        tip = twin.model.getFrameId(f"{robot.all_joint_names[i]}.tip", pin.FrameType.BODY)
        theirs = twin.data.oMf[tip].homogeneous
        np.testing.assert_allclose(theirs, robot.base @ ours[i], rtol=0, atol=1e-13)


def test_every_body_stays_a_link_of_its_own(robot: Robot) -> None:
    root = ET.fromstring(urdf_text(robot).text)
    links = {link.get("name"): link for link in root.iter("link")}
    masses = {name: link.find("inertial/mass") for name, link in links.items()}
    for name, mass in zip(robot.body_names, robot.nominal.mass, strict=True):
        found = masses[name]
        assert found is not None
        assert float(found.get("value", "nan")) == mass
    assert sum(mass is not None for mass in masses.values()) == robot.b
    joints = [joint.get("name") for joint in root.iter("joint") if joint.get("type")]
    assert len(joints) == len(set(joints)) == len(links) - 1


def test_limits_friction_and_gear_ratio_read_back_bit_for_bit() -> None:
    robot = mr.load_robot("lwa4p")
    root = ET.fromstring(urdf_text(robot).text)
    joints = {j.get("name"): j for j in root.findall("joint")}
    reductions = [float(e.text or "nan") for e in root.iter("mechanicalReduction")]
    assert reductions == robot.gear_ratio.tolist()
    for i, name in enumerate(robot.joint_names):
        limit, dynamics = joints[name].find("limit"), joints[name].find("dynamics")
        assert limit is not None
        assert dynamics is not None
        read = [float(limit.get(k, "nan")) for k in ("lower", "upper", "velocity", "effort")]
        wanted = [*robot.position_limits[i], robot.velocity_limits[i], robot.effort_limits[i]]
        assert read == wanted
        assert float(dynamics.get("damping", "nan")) == robot.nominal.viscous[i]
        assert float(dynamics.get("friction", "nan")) == robot.nominal.coulomb[i]


def test_what_urdf_cannot_hold_is_listed_in_the_file_and_returned() -> None:
    robot = mr.load_robot("lwa4p")
    exported = urdf_text(replace(robot, gravity=np.array([0.0, 0.0, 1.62])))
    assert exported.lost == (
        "the bounds of the dynamic parameters; one point of them is written",
        "controller settings, trajectory and scenarios",
        "rotor inertia of every joint",
        "coulomb_speed of every joint: the speed within which Coulomb friction is smoothed",
        "gravity (0.0 0.0 1.62) m/s^2; readers assume (0 0 -9.81)",
    )
    assert all(line in losses(exported.text) for line in exported.lost)


def test_what_mjcf_cannot_hold_is_listed_in_the_file_and_returned() -> None:
    robot = mr.load_robot("lwa4p-payload")
    exported = mjcf_text(robot)
    assert exported.lost == (
        "the bounds of the dynamic parameters; one point of them is written",
        "the disturbance [d]",
        "controller settings, trajectory and scenarios",
        "gear ratio and rotor inertia apart; armature holds k^2 I_m",
        "Coulomb friction as F_c s(dq); frictionloss holds F_c, MuJoCo makes a constraint of it",
        "velocity limits",
    )
    assert all(line in losses(exported.text) for line in exported.lost)


def test_mimic_joints_are_written_as_such() -> None:
    rng = np.random.default_rng(8)
    robot = replace(tied(random_robot(rng, types="prrr"), 2, rng))
    robot = replace(robot, position_limits=np.array([[-1.0, 2.0], [-0.5, 0.25]]))
    f = robot.mimic
    root = ET.fromstring(urdf_text(robot).text)
    for k, name in enumerate(f.names):
        joint = next(j for j in root.findall("joint") if j.get("name") == name)
        mimic, limit = joint.find("mimic"), joint.find("limit")
        assert mimic is not None
        assert limit is not None
        assert mimic.get("joint") == robot.joint_names[f.leaders[k]]
        assert float(mimic.get("multiplier", "nan")) == f.multiplier[k]
        assert float(mimic.get("offset", "nan")) == f.offset[k]
        ends = f.multiplier[k] * robot.position_limits[f.leaders[k]] + f.offset[k]
        assert [float(limit.get(e, "nan")) for e in ("lower", "upper")] == sorted(ends)
    exported = mjcf_text(robot)
    assert "that joint2, joint3 mimic exactly; MuJoCo's equality is soft" in exported.lost
    model = MjcfTwin(exported.text, robot).model
    np.testing.assert_array_equal(model.eq_data[:, 0], f.offset)
    np.testing.assert_array_equal(model.eq_data[:, 1], f.multiplier)


def test_missing_limits_are_said() -> None:
    robot = random_robot(np.random.default_rng(0), types="rpr")
    half_open = np.array([[-1.0, np.inf], [-np.inf, np.inf], [-1.0, 1.0]])
    lost = urdf_text(replace(robot, position_limits=half_open)).lost
    assert "the one-sided position limit of joint0" in lost
    assert "that joint0, joint1 has no position limit; 1e+09 is written" in lost
    assert "that every joint has no velocity limit; 1e+09 is written" in lost


def test_names_that_xml_or_the_exporter_would_stumble_on_are_kept_apart() -> None:
    robot = random_robot(np.random.default_rng(0), types="rr")
    names = ("world", "base", *robot.body_names[2:])
    robot = replace(robot, name='a--b<&">', body_names=names, joint_names=("base.mount", "joint0"))
    root = ET.fromstring(urdf_text(robot).text)
    assert root.get("name") == 'a--b<&">'
    links = [link.get("name") for link in root.iter("link")]
    assert len(set(links)) == len(links)
    state = random_state(np.random.default_rng(1), 2)
    q, dq, _, ddq = state
    ours = mr.inverse_dynamics(robot, q, dq, dq, ddq, drives=False)
    assert_close(ours, UrdfTwin(urdf_text(robot).text, robot).rnea(q, dq, ddq))
    assert_close(mr.mass_matrix(robot, q), MjcfTwin(mjcf_text(robot).text, robot).mass_matrix(q))


def test_links_without_an_extended_body_get_a_stand_in_that_mujoco_takes() -> None:
    """A point mass, a thin rod, and nothing at all: MuJoCo refuses each as a moving body."""
    robot = random_robot(np.random.default_rng(0), types="rrr", drives=False)
    bodies = [0, *(int(np.flatnonzero(robot.body_joints == i)[0]) for i in range(3))]
    inertia = np.array([np.eye(3), np.zeros((3, 3)), np.diag([1.0, 1.0, 0.0]), np.eye(3)]) * 0.01
    mass = np.array([1.0, 1.0, 1.0, 1.0])
    joints = np.array([-1, 0, 2, 2], dtype=np.int32)  # joint 1 moves nothing of its own
    zeros = np.zeros(3)
    com = np.full((4, 3), 0.1)
    point = Parameters(mass, com, inertia, zeros, zeros, zeros)
    robot = replace(
        robot,
        body_names=tuple(robot.body_names[k] for k in bodies),
        body_joints=joints,
        placement=robot.placement[bodies],
        nominal=point,
        lower=point,
        upper=point,
        disturbance=Bounded(zeros, zeros, zeros),
        inertia_about=(),
    )
    exported = mjcf_text(robot)
    q = np.array([0.3, -0.4, 0.5])
    assert_close(mr.mass_matrix(robot, q), MjcfTwin(exported.text, robot).mass_matrix(q))
    assert [line for line in exported.lost if "stand in" in line] == [
        f"that joint{i} moves no extended body of its own; 1e-14 kg and kg m^2 stand in"
        for i in (0, 1)
    ]


def test_a_tensor_that_no_body_has_is_refused_or_said_where_it_does_not_move() -> None:
    robot = random_robot(np.random.default_rng(0), types="r", drives=False)
    inertia = robot.nominal.inertia.copy()
    inertia[1] = np.diag([1.0, 1.0, 2.5]) + steiner(robot.nominal.mass, robot.nominal.com)[1]
    assert robot.inertia_about[1] == "frame"
    point = replace(robot.nominal, inertia=inertia)
    with pytest.raises(ValueRangeError, match="no rigid body has, and such are body1; nothing is"):
        mjcf_text(robot, point)
    with pytest.raises(ValueRangeError, match="such are body1;"):  # at any of its points
        mjcf_text(replace(robot, nominal=point, lower=point, upper=point), robot.nominal)
    still = replace(robot, body_joints=np.array([0, -1, *robot.body_joints[2:]]))
    exported = mjcf_text(still, point)
    assert any(line.startswith("the tensor of body1, which no rigid") for line in exported.lost)
    MjcfTwin(exported.text, still)


def test_bad_arguments_are_refused() -> None:
    robot, other = mr.load_robot("lwa4p"), mr.load_robot("scara")
    for export in (urdf_text, mjcf_text):
        with pytest.raises(ShapeError, match=r'robot "lwa4p" has \d+ and 6'):
            export(robot, other.nominal)
    with pytest.raises(ValueRangeError, match="timestep: 0 s; must be positive"):
        mjcf_text(robot, timestep=0.0)


def rotations() -> list[Any]:
    """Random ones, right angles, and pitches at and near the gimbal lock."""
    rng = np.random.default_rng(7)
    found = list(Rotation.random(50, rng=rng).as_matrix())
    near = [0.0, 1e-17, 1e-16, 3e-16, 1e-15, 1e-12, 1e-9, 1e-8, 1e-7, 1e-4, -1e-16, -1e-9]
    for gap in near:
        for side in (-1.0, 1.0):
            angles = [side * (np.pi / 2 - gap), *rng.uniform(-np.pi, np.pi, 2)]
            y, x, z = (
                Rotation.from_rotvec(a * e).as_matrix()
                for a, e in zip(angles, np.eye(3)[[1, 0, 2]], strict=True)
            )
            found.append(z @ y @ x)
    quarter = [Rotation.from_rotvec(k * np.pi / 2 * e) for k in range(4) for e in np.eye(3)]
    return [*found, *(np.round((a * b).as_matrix()) for a in quarter for b in quarter)]


def test_angles_and_quaternions_give_the_rotation_back_to_the_last_bits() -> None:
    for R in rotations():
        roll, pitch, yaw = roll_pitch_yaw(R)
        back = turn(yaw, 2) @ turn(pitch, 1) @ turn(roll, 0)
        assert np.abs(back - R).max() < 1e-15
        w, *v = quaternion(R)
        assert np.abs(from_quaternion(w, np.array(v)) - R).max() < 1e-15
        assert w >= 0.0


def turn(angle: float, axis: int) -> Any:
    c, s = np.cos(angle), np.sin(angle)
    R = np.eye(3)
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    R[i, i] = R[j, j] = c
    R[i, j], R[j, i] = -s, s
    return R


def from_quaternion(w: float, v: Any) -> Any:
    """Rodrigues: 1 + 2 w [v] + 2 [v]^2."""
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross


def test_our_own_importer_reads_the_urdf_back(robot: Robot, tmp_path: Path) -> None:
    point = robot.sample_parameters(9)
    file = tmp_path / "exported.urdf"
    file.write_text(urdf_text(robot, point).text)
    back = replace(mr.load_robot(file), gravity=robot.gravity)
    order = [back.joint_names.index(name) for name in robot.joint_names]
    assert sorted(order) == list(range(robot.n))
    rng = np.random.default_rng(5)
    q, dq, _, ddq = random_state(rng, robot.n)

    def there(x: Any) -> Any:
        out = np.empty(robot.n)
        out[order] = x
        return out

    ours = mr.inverse_dynamics(robot, q, dq, dq, ddq, point, drives=False)
    read = mr.inverse_dynamics(back, *state_of(map(there, (q, dq, dq, ddq))), drives=False)
    assert_close(ours, read[order])
    M = mr.mass_matrix(back, there(q), drives=False)[np.ix_(order, order)]
    assert_close(mr.mass_matrix(robot, q, point, drives=False), M)
    every = [back.all_joint_names.index(name) for name in robot.all_joint_names]
    np.testing.assert_array_equal(back.nominal.viscous[every], point.viscous)
    np.testing.assert_array_equal(back.nominal.coulomb[every], point.coulomb)
    np.testing.assert_array_equal(back.gear_ratio[every], robot.gear_ratio)
    for name, mass in zip(robot.body_names, point.mass, strict=True):
        assert back.nominal.mass[back.body_names.index(name)] == mass
