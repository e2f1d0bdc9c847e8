"""From files to a robot: links against an independent composition, parameters, settings."""

import math

import numpy as np
import pytest

from modrobust.assembly import load_robot
from modrobust.dynamics import forward_kinematics, inverse_dynamics, mass_matrix
from modrobust.errors import DescriptionError, FileError, ValueRangeError
from support.small_modules import Composed, assert_same_robot, message, rotate


@pytest.mark.parametrize(
    "chain",
    [
        ["hinge", "oblique", "hinge", "oblique", "hinge", "tool"],  # oblique links with a twist
        ["hinge", "hinge", "oblique", "tool"],  # a link before the tool
        ["hinge", "slide", "oblique"],  # the chain ends in a link
        ["hinge", "hinge", "oblique", "oblique"],  # ... in two links
        ["oblique", "hinge", "slide", "tool"],  # a link before the first joint
        ["slide", "slide", "hinge"],
    ],
)
def test_links_are_what_an_independent_composition_makes_of_them(load, chain):
    robot = load("base: {rpy: [0.3, -0.4, 0.5]}\nchain: [" + ", ".join(chain) + "]\n")
    composed = Composed()
    for module in chain:
        getattr(composed, module)()
    assert_same_robot(robot, composed)


def test_a_mount_turns_the_next_module_about_z(load):
    robot = load("chain: [hinge, {module: oblique, mount: 0.6}, {module: hinge, mount: -40 deg}]\n")
    composed = Composed()
    composed.hinge()
    composed.span(rotate("z", 0.6))
    composed.oblique()
    composed.span(rotate("z", math.radians(-40)))
    composed.hinge()
    assert_same_robot(robot, composed)


def test_a_mount_on_the_base_turns_the_whole_robot(load):
    robot = load("chain: [{module: hinge, mount: 0.7}, hinge]\n")
    np.testing.assert_allclose(
        robot.before[0][:2, 3], [-0.01 * math.sin(0.7), 0.01 * math.cos(0.7)]
    )


def test_total_mass_is_conserved(load):
    robot = load(
        "chain: [oblique, hinge, slide, oblique, tool]\npayload: {mass: 2 kg, com: [0, 0, 0]}\n"
    )
    assert math.fsum(robot.nominal.mass) == pytest.approx(
        1.2 + 1.7 + 1.5 + 1.2 + 0.5 + 2.0, abs=1e-14
    )


@pytest.mark.parametrize("angle", ["30 deg", "0", "-1.1"])
def test_a_full_turn_more_of_a_mount_changes_nothing(load, angle):
    turned = {"30 deg": "390 deg", "0": "360 deg", "-1.1": "5.183185307179586"}[angle]
    one, two = (
        load(f"chain: [hinge, {{module: oblique, mount: {a}}}, hinge, tool]\n", name=name)
        for a, name in ((angle, "one"), (turned, "two"))
    )
    rng = np.random.default_rng(1)
    zero = np.zeros(one.n)
    for _ in range(5):
        q = rng.uniform(-3, 3, one.n)
        for compute in (
            mass_matrix,
            forward_kinematics,
            lambda robot, q: inverse_dynamics(robot, q, zero, zero, zero),
        ):
            np.testing.assert_allclose(compute(one, q), compute(two, q), rtol=0, atol=1e-12)


def test_splitting_a_body_in_two_leaves_the_mass_matrix_unchanged(load):
    # A ball of 2 kg as two halves of 1 kg at +-d: the halves' tensors about their own centres are
    # the whole one's half less the share of Steiner.
    whole, d = np.diag([0.02, 0.03, 0.04]), np.array([0.05, 0.03, -0.02])
    half = 0.5 * whole - (d @ d * np.eye(3) - np.outer(d, d))

    def body(name, mass, com, tensor):
        entries = {
            "xx": (0, 0),
            "xy": (0, 1),
            "xz": (0, 2),
            "yy": (1, 1),
            "yz": (1, 2),
            "zz": (2, 2),
        }
        text = ", ".join(f"{key}: {float(tensor[at])!r}" for key, at in entries.items())
        numbers = ", ".join(repr(float(x)) for x in com)
        return (
            f"  - body: {name}\n    mass: {mass}\n    com: [{numbers}]\n    inertia: {{{text}}}\n"
        )

    head = "modrobust: 1\nmodule: {}\nname: Test load\nsource: generic\nproduct: false\n"
    head += "connectors: {{in: {{type: t}}}}\nchain:\n"
    com = np.array([0.1, -0.2, 0.15])
    modules = {
        "whole": head.format("whole") + body("ball", 2, com, whole),
        "halves": head.format("halves")
        + body("left", 1, com + d, half)
        + body("right", 1, com - d, half),
    }
    one = load("chain: [hinge, slide, hinge, whole]\n", modules, name="one")
    two = load("chain: [hinge, slide, hinge, halves]\n", modules, name="two")
    assert two.b == one.b + 1
    for seed in range(5):
        q = np.random.default_rng(seed).uniform(-3, 3, 3)
        np.testing.assert_allclose(mass_matrix(one, q), mass_matrix(two, q), rtol=0, atol=1e-13)


def test_a_body_at_the_end_of_a_link_is_placed_exactly_there(load):
    robot = load("chain: [hinge, hinge]\n")
    k = robot.body_names.index("hinge-2.rotor")
    np.testing.assert_array_equal(robot.placement[k], np.eye(4))


def test_bodies_before_the_first_joint_are_fixed_to_the_base(load):
    robot = load("chain: [oblique, hinge]\n")
    assert robot.body_names == ("oblique.tube", "hinge.stator", "hinge.rotor")
    assert robot.body_joints.tolist() == [-1, -1, 0]
    np.testing.assert_array_equal(robot.placement[0], np.eye(4))
    composed = Composed()
    composed.oblique()
    tube_end = composed.cursor.homogeneous
    np.testing.assert_allclose(robot.placement[1], tube_end, rtol=0, atol=1e-15)


def test_a_set_value_replaces_what_the_module_says(load):
    robot = load(
        """
chain:
  - module: hinge
    set:
      rotor.mass: 3 kg ± 10%
      rotor.com: [0, 0, 0.1]
      rotor.span.dh.d: 40 mm
      axis.limits.torque: 9 N m
  - hinge
"""
    )
    k = robot.body_names.index("hinge.rotor")
    assert robot.nominal.mass[k] == 3.0
    assert robot.lower.mass[k] == pytest.approx(2.7, abs=1e-15)
    np.testing.assert_array_equal(robot.nominal.com[k], [0.0, 0.0, 0.1])
    assert robot.nominal.mass[k + 2] == 0.7
    assert robot.effort_limits.tolist() == [9.0, math.inf]
    assert robot.after[1][2, 3] == 0.02


def test_a_payload_without_inertia_or_size_is_a_point_mass_and_that_is_said(load):
    robot = load(
        "chain: [hinge, tool]\npayload: {mass: [0 kg, 2 kg], com: [0, 0, [20 mm, 80 mm]]}\n"
    )
    assert robot.body_names[-1] == "payload"
    assert robot.body_joints[-1] == 0
    np.testing.assert_array_equal(robot.placement[-1], np.eye(4))
    assert (robot.lower.mass[-1], robot.nominal.mass[-1], robot.upper.mass[-1]) == (0.0, 1.0, 2.0)
    np.testing.assert_array_equal(robot.nominal.inertia[-1], np.zeros((3, 3)))
    assert (
        "payload: taken as a point mass, since neither its inertia nor its size is given"
        in robot.notes
    )


def test_a_payload_can_be_at_any_instance_behind_a_joint(load):
    robot = load(
        "chain: [hinge, oblique, hinge]\npayload: {at: oblique, mass: 1 kg, com: [0, 0, 0]}\n"
    )
    assert robot.body_joints[-1] == 0
    before_stator = robot.placement[robot.body_names.index("hinge-2.stator")]
    np.testing.assert_array_equal(robot.placement[-1], before_stator)


def test_a_payload_at_an_unknown_instance_is_refused(load):
    text = "chain: [hinge, oblique]\npayload: {at: obligue, mass: 1 kg, com: [0, 0, 0]}\n"
    assert message(load, text) == (
        'arm.yaml:5: payload.at: no instance named "obligue"; did you mean "oblique"? '
        "known: hinge, oblique"
    )


def test_a_payload_on_the_base_is_refused(load):
    text = "chain: [oblique, hinge]\npayload: {at: oblique, mass: 1 kg, com: [0, 0, 0]}\n"
    assert message(load, text) == (
        'arm.yaml:5: payload.at: "oblique" is fixed to the base, where a payload moves with no '
        "joint; name an instance behind a joint"
    )


def test_exact_and_not_modelled_name_what_has_no_width_and_what_is_missing(load):
    robot = load(
        """
chain:
  - module: slide
    set:
      carriage.mass: 1.5 kg ± 2%
      carriage.com: [10 mm ± 1 mm, 0, 0]
      carriage.inertia.xy: 0 kg m^2 ± 1e-5 kg m^2
      axis.friction.viscous: 3 N s/m
      axis.drive: {gear_ratio: 100 rad/m, rotor_inertia: 1e-5 kg m^2 ± 10%}
  - tool
"""
    )
    assert robot.exact == (
        "slide.carriage.com.y",
        "slide.carriage.com.z",
        *(f"slide.carriage.inertia.{entry}" for entry in ("xx", "xz", "yy", "yz", "zz")),
        "tool.hand.mass",
        "tool.hand.com",
        "tool.hand.inertia",
        "slide.axis.friction.viscous",
    )
    assert robot.not_modelled == ("slide.axis.friction.coulomb", "disturbance")
    assert load("chain: [hinge]\ndisturbance: 1 N m ± 2 N m\n").not_modelled == (
        "hinge.axis.drive",
        "hinge.axis.friction",
    )


def test_settings_are_resolved_per_joint(load):
    robot = load(
        """
chain: [hinge, slide]
disturbance: {hinge.axis: "[-1 N m, 2 N m]", slide.axis: 3 N ± 1 N}
controller: {K_r: {hinge.axis: 5, slide.axis: 7}, epsilon: 0.02, bound: ianea}
trajectory:
  kind: sines
  amplitude: {hinge.axis: pi/2, slide.axis: 0.1 m}
  omega: [pi/5 rad/s]
  duration: 10 s
initial: {q: {hinge.axis: 0.1 rad, slide.axis: 20 mm}}
base: {xyz: [1, 2, 3]}
gravity: [0, 0, -1.62]
""".replace('"', "")
    )
    assert robot.disturbance.lo.tolist() == [-1.0, 2.0]
    assert robot.disturbance.hi.tolist() == [2.0, 4.0]
    assert robot.disturbance.nominal.tolist() == [0.5, 3.0]
    settings = robot.controller
    assert settings.K_r == (5.0, 7.0)
    assert (settings.law, settings.bound, settings.epsilon) == ("norm", "ianea", 0.02)
    assert (settings.kappa_P, settings.kappa_I, settings.phi_P, settings.phi_I) == (2, 100, 1, 200)
    assert robot.trajectory.kind == "sines"
    assert robot.trajectory.amplitude == (math.pi / 2, 0.1)
    assert robot.trajectory.omega == pytest.approx((math.pi / 5,), abs=1e-16)
    assert robot.trajectory.duration == 10.0
    assert robot.initial_q.tolist() == [0.1, 0.02]
    assert robot.initial_dq is None
    assert robot.base[:3, 3].tolist() == [1.0, 2.0, 3.0]
    assert robot.gravity.tolist() == [0.0, 0.0, -1.62]


def test_without_settings_the_published_gains_hold(load):
    robot = load("chain: [hinge, hinge]\n")
    assert robot.controller.K_r == (10.0, 10.0)
    assert robot.controller.bound == "hull"
    assert robot.trajectory is None
    assert robot.gravity.tolist() == [0.0, 0.0, -9.81]


def test_a_chain_without_a_joint_is_refused(load):
    assert message(load, "chain: [oblique, tool]\n") == (
        "arm.yaml:1: chain: no joint in the chain; a robot moves; add a module with a joint"
    )


SPINNER = """
modrobust: 1
module: spinner
name: A joint and a point mass on its axis
source: generic, not a product
product: false
connectors: {in: {type: t}}
chain:
  - joint: axis
    type: revolute
"""


def test_a_joint_that_moves_no_mass_is_refused_by_name(load):
    chain = "chain: [hinge, spinner]\npayload: {mass: 1 kg, com: [0, 0, 0.1]}\n"
    assert message(load, chain, {"spinner": SPINNER}) == (
        "modules/spinner.yaml:8: joint spinner.axis: nothing behind it has inertia about its axis, "
        "so the mass matrix is singular (nominal parameters, drives included); give it a drive or "
        "a body with inertia"
    )


def test_a_drive_makes_a_massless_joint_regular(load):
    text = SPINNER + "    drive: {gear_ratio: 100, rotor_inertia: 1e-5 kg m^2}\n"
    chain = "chain: [hinge, spinner]\npayload: {mass: 1 kg, com: [0, 0, 0.1]}\n"
    assert load(chain, {"spinner": text}).n == 2


def test_two_joints_on_one_line_with_nothing_between_are_refused(load):
    doubled = SPINNER.replace("module: spinner", "module: double") + (
        "  - joint: again\n    type: revolute\n"
    )
    text = "chain: [hinge, double]\npayload: {mass: 1 kg, com: [0.1, 0, 0]}\n"
    assert "joint double.axis: nothing behind it" in message(load, text, {"double": doubled})


def test_notes_of_the_file_follow_assumptions_and_precede_remarks_of_modules(load):
    text = (
        "notes: a test arm\nchain:\n  - {module: hinge, set: {rotor.inertia.xx: 0.001 ± 0.0009}}\n"
    )
    payload = "payload: {mass: 1 kg, com: [0, 0, 0]}\n"
    assert load(text + payload).notes == (
        "payload: taken as a point mass, since neither its inertia nor its size is given",
        "a test arm",
        "hinge: body rotor: the bounds of its inertia also hold tensors that no rigid body has",
    )
    assert load("chain: [hinge]\n").notes == ()


def test_an_unknown_joint_in_a_mapping_is_refused(load):
    text = "chain: [hinge, slide]\ncontroller: {K_r: {hinge.axis: 5, slide.axes: 7}}\n"
    assert 'did you mean "slide.axis"?' in message(load, text)


def test_a_robot_that_is_neither_file_nor_built_in_is_refused(load, monkeypatch, tmp_path):
    monkeypatch.setattr(
        "modrobust.assembly.modules.catalogue.data_directory", lambda kind: tmp_path
    )
    load("chain: [hinge]\n")
    with pytest.raises(FileError) as caught:
        load_robot("amr")
    assert str(caught.value) == (
        'amr: neither a file nor a built-in robot; did you mean "arm"? give a file or one of arm'
    )
    assert load_robot("arm").name == "arm"


def test_a_built_in_name_is_not_hidden_by_a_directory_of_that_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lwa4p-paper").mkdir()
    assert load_robot("lwa4p-paper").n == 6


def test_json_says_the_same_with_the_same_keys(load, tmp_path):
    yaml = load(
        "chain: [hinge, {module: oblique, mount: 0.2}, hinge]\npayload: {mass: 1, com: [0, 0, 0]}\n"
    )
    (tmp_path / "json").mkdir()
    text = """
{
  "modrobust": 1, "robot": "arm", "modules": ["../modules"],
  "chain": ["hinge", {"module": "oblique", "mount": 0.2}, "hinge"],
  "payload": {"mass": "1 kg", "com": [0, 0, 0]}
}
"""
    (tmp_path / "json" / "arm.json").write_text(text)
    assert load_robot("json/arm.json").to_dict() == yaml.to_dict()


def test_module_files_are_named_without_detours(load, tmp_path):
    load("chain: [hinge]\n")
    (tmp_path / "robots").mkdir()
    (tmp_path / "modules" / "broken.yaml").write_text("modrobust: 1\nmodule: wrong\n")
    text = "modrobust: 1\nrobot: arm\nmodules: ../modules\nchain: [broken]\n"
    (tmp_path / "robots" / "arm.yaml").write_text(text)
    with pytest.raises(DescriptionError) as caught:
        load_robot("robots/arm.yaml")
    assert str(caught.value).startswith("modules/broken.yaml:")


def test_acceleration_limits_of_modules_reach_the_robot(load):
    limited = """
modrobust: 1
module: fast
name: Limited joint
source: made up
connectors: {in: {type: t}, out: {type: t}}
chain:
  - joint: axis
    type: revolute
    limits: {acceleration: 150 deg/s^2}
  - body: rod
    mass: 1 kg
    com: [0, 0, 0]
    inertia: {xx: 1e-3, yy: 1e-3, zz: 1e-3}
"""
    robot = load("chain: [hinge, fast]\n", {"fast": limited})
    np.testing.assert_allclose(robot.acceleration_limits, [np.inf, math.radians(150)], rtol=1e-15)


def test_a_chain_that_is_singular_only_at_the_zero_pose_loads(load):
    # A point mass on a two-link arm, links of 0.3 m and 0.5 m: det M = m^2 a^2 b^2 sin(q2)^2.
    link = SPINNER.replace("{in: {type: t}}", "{in: {type: t}, out: {type: t}}")
    link += "  - frame: reach\n    span: {xyz: [0.3, 0, 0]}\n"
    robot = load(
        "chain: [spinner, {module: spinner, as: outer}]\npayload: {mass: 1 kg, com: [0.2, 0, 0]}\n",
        {"spinner": link},
    )
    stretched, bent = (mass_matrix(robot, np.array([0.0, q])) for q in (0.0, 1.0))
    assert abs(np.linalg.det(stretched)) < 1e-15
    assert np.linalg.det(bent) == pytest.approx((0.3 * 0.5 * math.sin(1.0)) ** 2)


def test_where_a_robots_figures_come_from_is_among_its_remarks(load):
    robot = load("source: [data sheet, measured]\nnotes: by hand\nchain: [hinge]\n")
    assert robot.notes[:3] == ("source: data sheet", "source: measured", "by hand")


def test_what_is_said_of_a_scenario_reaches_the_robot(load):
    robot = load(
        "chain: [hinge]\n"
        "scenarios: {plain: {set: {}}, told: {set: {}, notes: [nominal, all of it]}}\n"
    )
    assert dict(robot.scenario_notes) == {"told": "nominal all of it"}


@pytest.mark.parametrize("name", ["", " "])
def test_no_name_at_all_is_refused(name):
    with pytest.raises(ValueRangeError) as caught:
        load_robot(name)
    assert str(caught.value) == (
        "robot: an empty text; the name of a built-in robot or the path of a file is expected"
    )


def test_a_line_break_in_a_name_stays_one_line_of_message():
    with pytest.raises(FileError) as caught:
        load_robot("a\nb\x1b.yaml")
    assert str(caught.value) == "a\\nb\\x1b.yaml: no such file; check the path"
