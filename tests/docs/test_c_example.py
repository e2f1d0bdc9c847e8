"""The C example is the robot that its comment says: Python's controller gives the same command."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import modrobust as mr
from support.pages import DOCS, outputs, page_steps

ARM = """\
modrobust: 1
robot: arm
modules: .
gravity: [0, -9.81, 0]
chain: [upper, lower]
disturbance: [-0.2 N m, 0.2 N m]
controller: {K_r: 10, kappa_P: 0.1, kappa_I: 1, phi_P: 40, phi_I: 100, epsilon: 0.01 rad}
"""
MODULE = """\
modrobust: 1
module: NAME
name: Link of the example
source: examples/kernel_command.c
product: false
connectors: {in: {type: flange}, out: {type: flange}}
chain:
  - joint: axis
    type: revolute
    drive: {gear_ratio: 100, rotor_inertia: ROTOR}
    friction: {viscous: VISCOUS, coulomb: 0}
  - body: link
    span: {xyz: [0.35, 0, 0]}
    mass: MASS
    com: COM
    inertia: {xx: XX, yy: YY, zz: YY}
"""
UPPER = {"NAME": "upper", "ROTOR": "3e-5", "VISCOUS": "2", "MASS": "3", "COM": "[0.17, 0, 0]"}
LOWER = {
    "NAME": "lower",
    "ROTOR": "2e-5",
    "VISCOUS": "1",
    "MASS": "{nominal: 1.5, lo: 1.0, hi: 2.0}",
    "COM": "{nominal: [0.2, 0, 0], lo: [0.15, 0, 0], hi: [0.25, 0, 0]}",
}
PAGE = DOCS / "reference" / "c.md"


@pytest.fixture
def robot(tmp_path: Path) -> mr.Robot:
    for values in ({**UPPER, "XX": "0.002", "YY": "0.02"}, {**LOWER, "XX": "0.001", "YY": "0.01"}):
        text = MODULE
        for key, value in values.items():
            text = text.replace(key, value)
        (tmp_path / f"{values['NAME']}.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    return mr.load_robot(tmp_path / "arm.yaml")


def test_the_command_of_the_example_is_that_of_python(robot: mr.Robot) -> None:
    code, output = outputs(PAGE)[len(page_steps(PAGE)) - 1]
    assert code == 0, output
    rows = re.findall(
        r"t = (\S+) s, joint (\d): tau (\S+) = (\S+) \+ (\S+), \[Phi\] = \[(\S+), (\S+)\]", output
    )
    assert len(rows) == 4
    controller, rest = mr.RobustController(robot), [0.0, 0.0]
    commands = [
        controller.command(t, [0.3, -0.6], rest, [0.31, -0.6], rest, rest) for t in (0.0, 1e-3)
    ]
    for t, joint, *figures in rows:
        command, i = commands[round(float(t) * 1e3)], int(joint) - 1
        expected = (command.tau, command.nominal, command.v, command.phi_lo, command.phi_hi)
        assert figures == [f"{array[i]:.6f}" for array in expected]
