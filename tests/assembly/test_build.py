"""Robots that are described in Python are those of files, and are checked in the same way."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ruamel.yaml import YAML

import modrobust as mr
from modrobust.assembly import builtin_robots

PARTS = """\
modrobust: 1
module: arm
name: Arm
source: made up
tolerance: {mass: 5%, com: 2 mm}
chain:
  - {body: foot, span: {xyz: [0, 0, 100 mm]}, mass: 3 kg, com: [0, 0, 50 mm],
     inertia: {xx: 0.01, yy: 0.01, zz: 0.005}}
  - joint: axis
    type: revolute
    limits: {position: [-170 deg, 170 deg], velocity: 2, torque: 50}
    drive: {gear_ratio: 100, rotor_inertia: 1e-5 ± 20%}
    friction: {viscous: 0.1 ± 10%, coulomb: [0.2, 0.5], coulomb_speed: 0.01}
  - {body: link, span: {xyz: [0.3, 0, 0], rpy: [pi/2, 0, 0]}, mass: 2.5, com: [0.1, 0, 1e-3],
     inertia: {xx: 0.004, yy: [0.01, 0.02], zz: 0.012}}
  - {frame: bend, span: {rpy: [0, 30 deg, 0]}}
  - {joint: slide, type: prismatic}
  - {body: tool, mass: 0.5, com: [0, 0, 0.02], inertia: {xx: 1e-4, yy: 1e-4, zz: 1e-4}}
"""
REST: dict[str, Any] = {
    "base": {"xyz": [0, 0, 0.5], "rpy": [0, "90 deg", 0]},
    "gravity": [0, 0, -9.8],
    "payload": {"mass": ["0 kg", "1 kg"], "com": [0, 0, "20 mm"]},
    "disturbance": "0.5 ± 0.25",
    "controller": {"K_r": 12, "kappa_P": 3, "epsilon": "0.02 rad"},
}


def from_yaml(text: str) -> Any:
    return YAML(typ="safe", pure=True).load(text)


def arrays(robot: mr.Robot) -> dict[str, Any]:
    """Everything but names, which tell where a part stands."""
    points = ("nominal", "lower", "upper")
    fields = ("before", "after", "placement", "base", "gravity", "position_limits", "gear_ratio",
              "velocity_limits", "effort_limits", "coulomb_speed", "parents",
              "body_joints")  # fmt: skip
    return {
        **{name: getattr(robot, name).tobytes() for name in fields},
        **{name: getattr(robot, name).packed.tobytes() for name in points},
        "disturbance": [x.tobytes() for x in vars(robot.disturbance).values()],
        "controller": robot.controller,
        "about": robot.inertia_about,
    }


def pendulum(**changed: Any) -> mr.Robot:
    body = {"body": "bob", "mass": "2 kg ± 5%", "com": [0, 0, 1], "span": {"xyz": [0, 0, 1]}}
    body["inertia"] = {"xx": 0.1, "yy": 0.1, "zz": 0.1}
    chain = [{"joint": "pivot", "type": "revolute"}, body]
    return mr.build_robot(**{"robot": "pendulum", "chain": chain, **changed})


def test_a_chain_of_joints_and_bodies_is_the_robot_of_a_file_bit_for_bit(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PARTS)
    (tmp_path / "robot.yaml").write_text("modrobust: 1\nrobot: robot\nmodules: .\nchain: [arm]\n")
    parts = from_yaml(PARTS)
    of_file = mr.load_robot(tmp_path / "robot.yaml")
    built = mr.build_robot("robot", parts["chain"], tolerance=parts["tolerance"])
    assert arrays(built) == arrays(of_file)
    assert built.joint_names == ("axis", "slide")
    assert built.body_names == ("foot", "link", "tool")
    assert of_file.joint_names == ("arm.axis", "arm.slide")


def test_the_rest_of_a_file_are_arguments_too(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PARTS)
    text = json.dumps({"modrobust": 1, "robot": "robot", "modules": ".", "chain": ["arm"], **REST})
    (tmp_path / "robot.json").write_text(text)
    parts = from_yaml(PARTS)
    built = mr.build_robot("robot", parts["chain"], tolerance=parts["tolerance"], **REST)
    assert arrays(built) == arrays(mr.load_robot(tmp_path / "robot.json"))
    assert built.body_names[-1] == "payload"


OF_MODULES = sorted(
    name for name, path in builtin_robots().items() if "\nurdf:" not in path.read_text()
)


@pytest.mark.parametrize("name", OF_MODULES)
def test_a_built_in_robot_can_be_built_from_its_description(name: str) -> None:
    path = builtin_robots()[name]
    description = from_yaml(path.read_text())
    del description["modrobust"]
    description["modules"] = path.parent / description["modules"]
    scenarios = description.get("scenarios", {})
    description["scenarios"] = {str(key): value for key, value in scenarios.items()}  # 1 is a text
    built, of_file = mr.build_robot(**description), mr.load_robot(name)
    assert built.to_dict() == of_file.to_dict()
    assert arrays(built) == arrays(of_file)
    assert built.notes == of_file.notes
    assert built.trajectory == of_file.trajectory
    assert {k: p.packed.tobytes() for k, p in built.scenarios.items()} == {
        k: p.packed.tobytes() for k, p in of_file.scenarios.items()
    }


def test_a_number_is_in_si_units_and_an_array_is_a_list() -> None:
    robot = pendulum(gravity=np.array([0.0, 1.0, -9.0]))
    assert robot.gravity.tolist() == [0.0, 1.0, -9.0]
    assert robot.lower.mass[0] == np.nextafter(1.9, 2.0) or robot.lower.mass[0] == 1.9
    torque = mr.inverse_dynamics(pendulum(base={"rpy": ["90 deg", 0, 0]}), [0.0], [0], [0], [0])
    assert abs(torque[0]) < 1e-12  # the axis is level, gravity pulls along the hanging bob


def test_modules_and_parts_can_stand_in_one_chain() -> None:
    hand = {"body": "hand", "mass": 1, "com": [0, 0, 0], "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    robot = mr.build_robot("mixed", ["schunk-pb-large-1", {"frame": "plate"}, hand])
    assert robot.n == 2
    assert robot.body_names[-1] == "hand"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"chain": [{"joint": "pivot", "type": "revolut"}]},
            'chain: joint pivot, type: "revolut" is not allowed here; did you mean "revolute"? ',
        ),
        (
            {"chain": [{"body": "bob", "mass": -1}]},
            "chain: body bob",
        ),
        ({"chain": [{"frame": "f"}]}, "chain: no joint in the chain"),
        ({"chain": []}, "chain: an empty list"),
        ({"chain": [{1, 2}]}, "chain[0]: {1, 2}; must be a number"),
        ({"chain": ["no-such-module"]}, 'chain[0]: no module named "no-such-module"'),
        ({"chain": [{"link": "x"}]}, 'chain[0]: none of joint, body, frame, module'),
        ({"robot": "two words"}, 'robot: "two words" is not a name'),
        ({"controller": {"K_p": 1}}, 'controller: unknown key "K_p"; did you mean "K_r"?'),
        ({"controller": {"K_r": {"pivott": 1}}}, 'controller.K_r: no joint named "pivott"'),
        ({"gravity": [0, 0]}, "gravity"),
        ({"payload": 3}, "payload: 3; must be a text or a mapping"),
        ({"modules": "no/such/folder"}, 'modules: no directory "no/such/folder"'),
        ({"scenarios": {"1": {"set": {"bob.mas": 1}}}}, "scenarios.1.set.bob.mas: no parameter"),
    ],
)  # fmt: skip
def test_messages_name_the_argument(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(mr.InputError) as caught:
        pendulum(**changed)
    assert message in str(caught.value)
    assert str(caught.value).startswith(message.split(":")[0].split("[")[0])


def test_a_body_that_no_rigid_body_is_is_refused() -> None:
    bob = {"mass": 1, "com": [0, 0, 0], "inertia": {"xx": 1, "yy": 0.1, "zz": 0.1}}
    chain: list[dict[str, object]] = [
        {"joint": "pivot", "type": "revolute"},
        {"body": "bob", **bob},
    ]
    with pytest.raises(mr.DescriptionError, match="triangle inequality"):
        mr.build_robot("r", chain)
