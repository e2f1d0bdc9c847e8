"""Torques that underflow, or many small shares, once took out of the bounds.

Exact torques are worked out by hand, in fractions; without gravity nothing else hides them.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import modrobust as mr

BODY = "mass: {mass} kg\n    com: [0, 0, 0]\n    inertia: {{xx: 1, yy: 1, zz: 1}}\n"
TURNED = (
    "  - joint: a\n    type: revolute\n"
    "  - frame: f\n    span: {xyz: [0, 0, 0], rpy: [90 deg, 0, 0]}\n"
    "  - joint: b\n    type: prismatic\n"
    "  - body: c\n    span: {xyz: [0, 0, 0], rpy: [10 deg, 20 deg, 45 deg]}\n"
    "    expressed_in: end\n    "
)
LINK = (
    '<inertial><mass value="{mass}"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def arm(folder: Path, chain: str) -> mr.Robot:
    """A robot of one module, weightless."""
    (folder / "m.yaml").write_text(f"modrobust: 1\nmodule: m\nname: m\nsource: x\nchain:\n{chain}")
    robot = folder / "r.yaml"
    robot.write_text("modrobust: 1\nrobot: r\nmodules: .\ngravity: [0, 0, 0]\nchain: [m]\n")
    return mr.load_robot(robot)


def holds(bounds: Any, i: int, exact: Fraction) -> bool:
    lo, hi = bounds
    return Fraction(float(lo[i])) <= exact <= Fraction(float(hi[i]))


@pytest.mark.parametrize("bound", ["hull", "ianea"])
@pytest.mark.parametrize("mass", [1, 10**12])
def test_underflow_times_great_speeds_and_masses(tmp_path: Path, bound: str, mass: int) -> None:
    robot = arm(tmp_path, TURNED + BODY.format(mass=mass))
    fast, slow = 1e100, 7.4e-323  # the moment of the sliding body about the first joint
    bounds = mr.inverse_dynamics_bounds(robot, [0, 1], [0, fast], [slow, 0], [0, 0], bound=bound)
    assert holds(bounds, 0, mass * Fraction(fast) * Fraction(slow))
    way = 3.5e-323  # and its centrifugal force
    bounds = mr.inverse_dynamics_bounds(robot, [0, way], [fast, 0], [fast, 0], [0, 0], bound=bound)
    assert holds(bounds, 1, -mass * Fraction(fast) ** 2 * Fraction(way))


def mimic_joint(folder: Path, multipliers: list[float], overlay: str = "") -> mr.Robot:
    """Prismatic joints beside each other that mimic the first."""
    axis = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    joints, links = [], ['<link name="base"/>']
    for k, multiplier in enumerate([None, *multipliers]):
        mimic = "" if multiplier is None else f'<mimic joint="j0" multiplier="{multiplier!r}"/>'
        links.append(f'<link name="l{k}">{LINK.format(mass=1)}</link>')
        joints.append(
            f'<joint name="j{k}" type="prismatic"><parent link="base"/><child link="l{k}"/>'
            f"{axis}{mimic}</joint>"
        )
    (folder / "r.urdf").write_text(f'<robot name="r">{"".join(links + joints)}</robot>')
    robot = folder / "r.yaml"
    robot.write_text(f"modrobust: 1\nrobot: r\nurdf: r.urdf\ngravity: [0, 0, 0]\n{overlay}")
    return mr.load_robot(robot)


@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_underflow_of_the_law_times_a_great_multiplier(tmp_path: Path, bound: str) -> None:
    robot = mimic_joint(tmp_path, [1e40], "controller: {K_r: 0.25}\n")
    controller = mr.RobustController(robot, bound=bound)
    command = controller.command(0.0, [0], [5e-324], [0], [0], [0])
    needed = (1 + Fraction(10) ** 80) * (-Fraction(5e-324) / 4)
    w = needed - Fraction(float(command.nominal[0]))
    assert holds((command.phi_lo, command.phi_hi), 0, w)


@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_the_friction_of_a_hundred_mimic_joints(tmp_path: Path, bound: str) -> None:
    """Each share is less than half a unit in the last place of the leader's."""
    share = 0.99 * 2.0**-53
    names = {f"j{k}": share for k in range(1, 101)}
    frictions = "".join(
        f"  {name}: {{friction: {{viscous: {x!r}}}}}\n" for name, x in names.items()
    )
    overlay = f"joints:\n  j0: {{friction: {{viscous: 1}}}}\n{frictions}"
    robot = mimic_joint(tmp_path, [1.0] * 100, overlay)
    bounds = mr.inverse_dynamics_bounds(robot, [0], [1], [1], [0], bound=bound)
    assert holds(bounds, 0, 1 + 100 * Fraction(share))


@pytest.mark.parametrize("bound", ["hull", "ianea"])
def test_a_coulomb_speed_below_the_normal_numbers(tmp_path: Path, bound: str) -> None:
    written = "0." + "0" * 323 + "7"  # its nearest double is 5e-324
    chain = (
        "  - joint: a\n    type: revolute\n    friction: {viscous: 0, coulomb: 1 N m, "
        f"coulomb_speed: {written} rad/s}}\n  - body: b\n    " + BODY.format(mass=1)
    )
    robot = arm(tmp_path, chain)
    speed = 1e-323
    ratio = Fraction(written) / Fraction(speed)
    smooth = Fraction(1 / (1 + float(ratio) ** 2) ** 0.5)
    bounds = mr.inverse_dynamics_bounds(robot, [0], [speed], [0], [0], bound=bound)
    assert holds(bounds, 0, smooth)
