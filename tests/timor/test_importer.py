"""Import of Timor's module database: the same robot, with the reading of each tensor said."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import modrobust as mr
from modrobust.errors import FileError, InputError, ValueRangeError
from modrobust.formats import load_module
from modrobust.formats.items import BodyItem, JointItem
from modrobust.timor import import_timor, write_modules
from modrobust.timor.importer import Import, inertia_reading, rpy_of
from support.float_transforms import from_xyz_rpy, rotation_x
from support.timor_databases import (
    EYE,
    IN,
    TURN,
    base,
    bent_link,
    body,
    database,
    end,
    inertia,
    powerball,
)

Array = NDArray[np.float64]
SEED = 20261123


def mounted(folder: Path, result: Import) -> mr.Robot:
    write_modules(result, folder / "modules")
    assembly = folder / "arm.yaml"
    chain = "[ground, bent-link, {module: 21, as: wrist}]"
    assembly.write_text(f"modrobust: 1\nrobot: arm\nmodules: modules\nchain: {chain}\n")
    return mr.load_robot(assembly)


def test_a_chain_of_imported_modules_stands_where_timor_puts_it(tmp_path: Path) -> None:
    arm = mounted(tmp_path, import_timor(database(tmp_path, powerball(), bent_link(), base())))
    assert arm.joint_names == ("wrist.axis-1", "wrist.axis-2")
    part = bent_link()["bodies"][0]
    into, out = (np.array(part["connectors"][k]["pose"]) for k in (1, 0))
    q = np.array([0.3, -0.7])
    # Timor: connectors face each other, turned by Rx(pi); so does the base and the world.
    face = rotation_x(math.pi)
    link = face @ np.array(IN) @ np.linalg.inv(into @ face) @ out
    one = from_xyz_rpy((0, 0, 0), (0, 0, q[0]))
    two = from_xyz_rpy((0, 0, 0), (0, 0, q[1]))
    tip = link @ one @ TURN @ two
    np.testing.assert_allclose(mr.forward_kinematics(arm, q)[-1], tip, atol=1e-12)
    k = arm.body_names.index("wrist.elbow")
    at = link @ one @ TURN
    frame = mr.forward_kinematics(arm, q)[0] @ arm.placement[k]
    np.testing.assert_allclose(frame, at, atol=1e-12)


def test_limits_drive_and_friction_are_kept_and_noise_is_not(tmp_path: Path) -> None:
    result = import_timor(database(tmp_path, powerball()))
    assert "rpy: [-pi/2, 0, 0]" in result.modules[0].text
    assert "xyz: [0, 0.1013, 0.1013]" in result.modules[0].text
    module = load_module(write_modules(result, tmp_path / "out")[0])
    joint = module.items[0]
    assert isinstance(joint, JointItem)
    assert (joint.position, joint.velocity, joint.effort) == ((-2.9671, 2.9671), 1.2566, 75.504)
    assert joint.gear_ratio == 160.0
    figures = (joint.rotor_inertia, joint.viscous, joint.coulomb)
    assert [x and x.nominal for x in figures] == [5.23e-5, 15.68, 7.14]
    assert module.name == 'PB "21"'


SPELT = {
    "gearRatio": "gear_ratio", "motorInertia": "MOTOR_inertia",
    "frictionCoulomb": "friction_coulomb",
    "frictionViscous": "FRICTIONVISCOUS", "poseParent": "parent2joint", "poseChild": "Joint2Child",
    "positionLower": "Lower", "positionUpper": "upper", "peakTorque": "torque_limit",
    "velocity": "Velocity_Limit", "acceleration": "Acceleration",
}  # fmt: skip


def respelt(joint: dict[str, Any]) -> dict[str, Any]:
    limits = {SPELT[key]: value for key, value in joint["limits"].items()}
    return {SPELT.get(key, key): value for key, value in joint.items()} | {"limits": limits}


def test_every_spelling_that_timor_reads_is_read(tmp_path: Path) -> None:
    module = powerball()
    other = module | {"joints": [respelt(joint) for joint in module["joints"]]}
    moved = module | {"joints": [flat(joint) for joint in module["joints"]]}
    expected = import_timor(database(tmp_path, module)).modules[0].text
    assert "limits: {position: [-2.9671, 2.9671], velocity: 1.2566, torque: 75.504" in expected
    for same in (other, moved):
        result = import_timor(database(tmp_path, same))
        assert result.left_out == ()
        assert result.modules[0].text == expected


def flat(joint: dict[str, Any]) -> dict[str, Any]:
    """Timor looks for the limits but those of position in the joint itself too."""
    limits = joint["limits"]
    ends = {key: value for key, value in limits.items() if key.startswith("position")}
    rest = {key: value for key, value in limits.items() if key not in ends}
    return joint | rest | {"limits": ends}


def test_the_figures_are_those_that_timor_computes_with(tmp_path: Path) -> None:
    """Timor: k^2 I_m, and friction F_v dq + F_c sin(atan(100 dq))."""
    module = powerball()
    for joint in module["joints"]:
        joint["gearRatio"] = -160.0
    arm = mounted(tmp_path, import_timor(database(tmp_path, module, bent_link(), base())))
    assert arm.coulomb_speed.tolist() == [0.01, 0.01]
    for dq in (0.003, -0.02, 1.5):
        state = (np.zeros(2), np.full(2, dq), np.zeros(2), np.ones(2))
        drives = mr.inverse_dynamics(arm, *state) - mr.inverse_dynamics(arm, *state, drives=False)
        friction = 15.68 * dq + 7.14 * math.sin(math.atan(100.0 * dq))
        np.testing.assert_allclose(drives, 160.0**2 * 5.23e-5 + friction, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "note"),
    [
        (
            {"gearRatio": -160.0},
            "joint axis-1: gear ratio -160.0 taken as 160.0: its sign is the direction of the "
            "motor, and inertia goes with its square",
        ),
        (
            {"gearRatio": 0.0},
            "joint axis-1: a gear ratio of 0 reflects no rotor inertia; no drive taken",
        ),
        (
            {"limits": {"positionLower": -1.5, "positionUpper": math.inf}},
            "joint axis-1: a position limit on one side only, -1.5: left out, since a joint has "
            "two limits or none; complete it",
        ),
        ({"limits": {"velocity": 0}}, "joint axis-1: velocity limit of 0 taken as not given"),
    ],
)
def test_what_is_taken_otherwise_is_said(tmp_path: Path, change: Any, note: str) -> None:
    module = powerball()
    module["joints"][0] |= change
    imported = import_timor(database(tmp_path, module)).modules[0]
    assert note in imported.notes
    assert load_module(write_modules(import_timor(tmp_path / "modules.json"), tmp_path / "out")[0])


JOINT_FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "a slip": (
        {"gearRatoi": 160.0},
        'modules[0].joints[0]: unknown key "gearRatoi"; did you mean "gearRatio"? Timor does not '
        "read it, and it could be a drive, friction or a limit; correct or remove it",
    ),
    "another case of a key that Timor takes as written": (
        {"Limits": {}},
        'modules[0].joints[0]: unknown key "Limits"; did you mean "limits"? Timor does not read '
        "it, and it could be a drive, friction or a limit; correct or remove it",
    ),
    "what Timor has no word for": (
        {"springStiffness": 3.0},
        'modules[0].joints[0]: unknown key "springStiffness"; Timor does not read it, and it could '
        "be a drive, friction or a limit; correct or remove it",
    ),
    "a limit of another name": (
        {"limits": {"maxVelocity": 3.0}},
        'modules[0].joints[0].limits: unknown key "maxVelocity"; did you mean "velocity"? Timor '
        "does not read it, and it could be a drive, friction or a limit; correct or remove it",
    ),
    "twice": (
        {"gear_ratio": 100.0},
        'modules[0].joints[0]: "gear_ratio" says gearRatio a second time; it is said once; remove '
        "one",
    ),
    "passive in words": (
        {"passive": "True"},
        "modules[0].joints[0]: a passive revolute joint; joints are driven and one of revolute, "
        "continuous, prismatic",
    ),
    "endless friction": (
        {"frictionCoulomb": math.inf},
        'joint axis 1.frictionCoulomb: "null" is not a finite number; write one in decimal digits',
    ),
    "negative friction": (
        {"frictionViscous": -1.0},
        "modules[0]: no module of ours: joint axis-1, friction.viscous: -1 is negative; it is at "
        "least 0; write 0 or more",
    ),
    "reversed limits": (
        {"limits": {"lower": 1.0, "upper": -1.0}},
        "modules[0]: no module of ours: joint axis-1, limits.position: ",
    ),
}


@pytest.mark.parametrize("fault", JOINT_FAULTS)
def test_a_joint_that_is_not_understood_is_left_out_with_its_reason(
    tmp_path: Path, fault: str
) -> None:
    change, reason = JOINT_FAULTS[fault]
    module = powerball()
    module["joints"][0] |= change
    path = database(tmp_path, module, bent_link())
    result = import_timor(path)
    assert [module.id for module in result.modules] == ["bent-link"]
    ((_, said),) = result.left_out
    assert said.startswith(f"{path}:1: {reason}"), said


def test_a_body_with_a_key_that_timor_refuses_is_left_out(tmp_path: Path) -> None:
    link = bent_link()
    link["bodies"][0]["com"] = [0.0, 0.0, 0.0]
    result = import_timor(database(tmp_path, link))
    assert 'unknown key "com"; did you mean "r_com"? Timor refuses it too' in result.left_out[0][1]


@pytest.mark.parametrize("kind", ["revolute_active", "JointModelRZ"])
def test_other_names_of_a_kind_of_joint_are_known(tmp_path: Path, kind: str) -> None:
    module = powerball()
    module["joints"][0]["type"] = kind
    assert "type: revolute" in import_timor(database(tmp_path, module)).modules[0].text


def test_infinite_limits_and_a_direct_drive_are_read(tmp_path: Path) -> None:
    module = powerball()
    module["joints"][0] |= {"gearRatio": 1.0, "motorInertia": 0.0}
    module["joints"][0]["limits"] |= {"peakTorque": math.inf, "positionUpper": math.inf}
    result = import_timor(database(tmp_path, module))
    first = load_module(write_modules(result, tmp_path / "out")[0]).items[0]
    assert isinstance(first, JointItem)
    assert (first.position, first.effort, first.gear_ratio) == (None, None, None)


def test_the_reading_that_a_rigid_body_can_have_is_taken_and_said(tmp_path: Path) -> None:
    third, zero = Fraction(1, 3), Fraction(0)
    tensor = [third, zero, zero, third, zero, third]
    assert inertia_reading(Fraction(1), [zero] * 3, tensor) == (
        "com",
        "frame",
    )
    thin = [Fraction(2), Fraction(0), Fraction(0), Fraction(2), Fraction(0), Fraction(1, 100)]
    far = [Fraction(0), Fraction(0), Fraction(3, 2)]
    assert inertia_reading(Fraction(1), far, thin) == ("com",)
    # About the COM it breaks the triangle inequality; moved there from the frame it is a rod.
    moved = [Fraction(5, 4), Fraction(0), Fraction(0), Fraction(1, 4), Fraction(0), Fraction(1)]
    off = [Fraction(0), Fraction(-19, 20), Fraction(0)]
    assert inertia_reading(Fraction(1), off, moved) == ("com", "frame")
    off = [Fraction(0), Fraction(0), Fraction(0)]
    moved[0] = Fraction(2)
    assert inertia_reading(Fraction(1), off, moved) == ()
    result = import_timor(database(tmp_path, powerball()))
    assert result.modules[0].notes == (
        "body elbow: inertia taken as about the com (both readings are physical)",
    )
    told = import_timor(database(tmp_path, powerball()), "frame")
    assert told.modules[0].notes == ("body elbow: inertia taken as about the frame (as told)",)
    read = load_module(write_modules(told, tmp_path / "frame")[0])
    elbow = read.items[2]
    assert isinstance(elbow, BodyItem)
    assert (elbow.inertia_about, elbow.inertia[0].nominal) == ("frame", 0.042799)


FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "three connectors": (
        {"bodies": [body("b", ends=[end(str(k), EYE, "f") for k in range(3)])], "joints": []},
        "modules[0]: 3 connectors; a module here has two, in and out; import it by hand",
    ),
    "passive": (
        {"joints": [powerball()["joints"][0] | {"passive": True}]},
        "modules[0].joints[0]: a passive revolute joint; joints are driven and one of revolute, "
        "continuous, prismatic",
    ),
    "no body of that name": (
        {"joints": [powerball()["joints"][0] | {"child": "x"}]},
        'modules[0].joints[0]: no body with the ID "x"; known: p, elbow, d',
    ),
    "reflected": (
        {"bodies": [body("b", ends=[end("1", np.diag([1, 1, -1, 1]).tolist(), "f")])]},
        "modules[0].bodies[0].connectors[0].pose: not a rigid transform; it is [R p; 0 0 0 1] "
        "with a right-handed, orthonormal R; write R with seven digits or more",
    ),
    "impossible tensor": (
        {
            "bodies": [
                body("b", 1.0, tensor=inertia(1, 1, 3),
                     ends=[end("in", IN, "f"), end("out", EYE, "m")])
            ],
            "joints": [],
        },
        "body b: the inertia tensor belongs to no rigid body, neither about the COM nor about the "
        "frame; correct the figures",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_module_that_cannot_be_imported_is_left_out_with_its_reason(
    tmp_path: Path, fault: str
) -> None:
    change, reason = FAULTS[fault]
    path = database(tmp_path, powerball() | change, bent_link())
    result = import_timor(path)
    assert [module.id for module in result.modules] == ["bent-link"]
    assert result.left_out == (("modules[0]", f"{path}:1: {reason}"),)


def test_a_reading_that_no_body_has_is_refused(tmp_path: Path) -> None:
    part = body("b", 1.0, (0, 0, 1.5), inertia(2, 2, 0.01),
                [end("in", IN, "f"), end("out", EYE, "m")])  # fmt: skip
    rod = {"header": {"ID": "rod", "name": "Rod"}, "bodies": [part], "joints": []}
    result = import_timor(database(tmp_path, rod), "frame")
    assert 'import it with inertia_about "com"' in result.left_out[0][1]
    assert import_timor(database(tmp_path, rod)).modules[0].notes == (
        "body b: inertia taken as about the com (the only physical reading)",
    )


def test_roll_pitch_and_yaw_give_the_rotation_back_also_where_the_pitch_is_right() -> None:
    rng = np.random.default_rng(SEED)
    for pitch in (*rng.uniform(-1.5, 1.5, 20), math.pi / 2, -math.pi / 2):
        roll, yaw = rng.uniform(-3.0, 3.0, 2)
        turned = from_xyz_rpy((0, 0, 0), (roll, pitch, yaw))
        again = from_xyz_rpy((0, 0, 0), rpy_of(turned[:3, :3]))
        np.testing.assert_allclose(again, turned, atol=1e-14)


def test_nothing_is_overwritten_and_what_is_no_database_is_refused(tmp_path: Path) -> None:
    result = import_timor(database(tmp_path, powerball()))
    write_modules(result, tmp_path / "out")
    with pytest.raises(FileError, match="exists; an import overwrites nothing"):
        write_modules(result, tmp_path / "out")
    for text in ("", "[]", "{}", '{"modules": 3}', '{"modules": [', "\x00"):
        (tmp_path / "bad.json").write_text(text)
        with pytest.raises(InputError):
            import_timor(tmp_path / "bad.json")
    with pytest.raises(FileError, match="cannot be read: no such file"):
        import_timor(tmp_path / "none.json")
    with pytest.raises(ValueRangeError, match='inertia_about: "tip" is none of com, frame'):
        import_timor(tmp_path / "bad.json", "tip")
