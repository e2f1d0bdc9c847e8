"""Each fault of a URDF, with the message that names file, line, what was found and the remedy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import modrobust as mr
from modrobust.errors import InputError
from support.urdf_texts import INERTIA, INERTIAL, LIMIT, joint, link, robot, two_links, written

AXIS = '<axis xyz="0 0 1"/>'
GOOD = two_links()


def refusal(path: Path, **options: object) -> str:
    with pytest.raises(InputError) as caught:
        mr.load_robot(path, **options)  # type: ignore[arg-type]
    return str(caught.value).removeprefix(str(path))


LINKS = {
    "no mass": (
        f"<inertial>{INERTIA}</inertial>",
        ":4: link arm: <inertial> has no <mass>; nothing is guessed; add it, or remove <inertial> "
        "from a frame without mass",
    ),
    "no value": (
        f"<inertial><mass/>{INERTIA}</inertial>",
        ':4: link arm: <mass> has no "value"; nothing is guessed; add value="..."',
    ),
    "no ixx": (
        INERTIAL.replace('ixx="0.02" ', ""),
        ':4: link arm: <inertia> has no "ixx"; nothing is guessed; add ixx="..."',
    ),
    "negative mass": (
        INERTIAL.replace('"2"', '"-2"'),
        ":4: link arm, mass: -2 kg is negative; a body's mass is at least 0; write 0 or more",
    ),
    "negative moment": (
        INERTIAL.replace('"0.03"', '"-0.03"'),
        ":4: link arm, inertia.yy: -0.03 kg m^2 is negative; a moment of inertia is at least 0; "
        'check the figures and the reference point ("about")',
    ),
    "not positive definite": (
        INERTIAL.replace('ixy="0"', 'ixy="0.1"'),
        ":4: link arm, inertia: principal moments -0.0751249, 0.01, 0.125125 kg m^2; no "
        "principal moment of the nominal tensor is negative; check the figures and the reference "
        'point ("about")',
    ),
    "a moment that is negative by a millionth": (
        INERTIAL.replace('"0.03"', '"-1e-8"'),
        ":4: link arm, inertia.yy: -1e-08 kg m^2 is negative; a moment of inertia is at least 0; "
        'check the figures and the reference point ("about")',
    ),
    "not a number": (
        INERTIAL.replace('"2"', '"2 kg"'),
        ':4: link arm, value: "2 kg" is not a number; numbers in a URDF are decimal, in SI units '
        'without the unit; write it so, such as "0.25"',
    ),
    "nan": (
        INERTIAL.replace('"2"', '"nan"'),
        ':4: link arm, value: "nan" is not finite; numbers in a URDF are decimal, in SI units '
        'without the unit; write it so, such as "0.25"',
    ),
    "out of range": (
        INERTIAL.replace('"2"', '"1e200"'),
        ':4: link arm, value: "1e200" is out of range; correct the exponent',
    ),
    "an angle that no robot has": (
        INERTIAL.replace('xyz="0 0 0.1"', 'rpy="0 0 -2e5"'),
        ":4: link arm, rpy: -200000 rad; an angle lies within 100000 rad; reduce it by whole turns",
    ),
    "two inertials": (
        INERTIAL * 2,
        ":4: link arm: a second <inertial> (first on line 4); there is one; remove it",
    ),
    "slip in an element": (
        INERTIAL.replace("inertial", "inertail"),
        ':4: link arm: unknown element <inertail>; did you mean "inertial"? rename it',
    ),
    "slip in an attribute": (
        INERTIAL.replace('xyz="0 0 0.1"', 'rpyy="0 0 0.1"'),
        ':4: link arm: unknown attribute "rpyy" of <origin>; did you mean "rpy"? rename or '
        "remove it",
    ),
    "two entries": (
        INERTIAL.replace("0 0 0.1", "0 0.1"),
        ':4: link arm, xyz: "0 0.1" has 2 entries; a vector has three, with blanks between; '
        'write three, such as "0 0 0"',
    ),
    "nothing that moves has mass": (
        "",
        ":1: robot small: no link that moves has mass: a file for pictures, not for dynamics; use "
        "another description of this robot, or give mass, com and inertia in an assembly file "
        "(links:)",
    ),
}
JOINTS = {
    "zero axis": (
        '<axis xyz="0 0 0"/>' + LIMIT,
        ":3: joint turn, axis: the axis is 0 0 0; an axis has a direction; write e.g. 0 0 1",
    ),
    "slip in the origin": (
        '<origin xzy="0 0 0.3"/>' + AXIS + LIMIT,
        ':3: joint turn: unknown attribute "xzy" of <origin>; did you mean "xyz"? rename or '
        "remove it",
    ),
    "axis of another format": (
        '<axis value="0 0 1"/>' + LIMIT,
        ':3: joint turn: unknown attribute "value" of <axis>; did you mean "xyz"? rename or '
        "remove it",
    ),
    "axis turned besides": (
        '<axis xyz="0 0 1" rpy="0 0.5 0"/>' + LIMIT,
        ':3: joint turn: unknown attribute "rpy" of <axis>; known: xyz; rename or remove it',
    ),
    "limit of another format": (
        AXIS + '<limit min="-1" upper="1" effort="1" velocity="1"/>',
        ':3: joint turn: unknown attribute "min" of <limit>; did you mean "lower"? rename or '
        "remove it",
    ),
    "limit in degrees": (
        AXIS + '<limit lower="-90" upper="90" unit="deg" effort="1" velocity="1"/>',
        ':3: joint turn: unknown attribute "unit" of <limit>; known: lower, upper, effort, '
        "velocity, acceleration, drake:acceleration, deceleration, jerk; rename or remove it",
    ),
    "slip in the dynamics": (
        AXIS + LIMIT + '<dynamics dampng="1"/>',
        ':3: joint turn: unknown attribute "dampng" of <dynamics>; did you mean "damping"? rename '
        "or remove it",
    ),
    "dynamics as elements": (
        AXIS + LIMIT + "<dynamics><damping>1</damping></dynamics>",
        ':3: joint turn: an element <damping> inside <dynamics>; did you mean "damping"? its '
        "figures are attributes; write them so",
    ),
    "axis as text": (
        "<axis>0 0 1</axis>" + LIMIT,
        ':3: joint turn: the text "0 0 1" inside <axis>; its figures are attributes (xyz); write '
        "them so",
    ),
    "mimic of another format": (
        AXIS + LIMIT + '<mimic joint="turn" ratio="2"/>',
        ':3: joint turn: unknown attribute "ratio" of <mimic>; did you mean "multiplier"? rename '
        "or remove it",
    ),
    "quaternion before it was one": (
        '<origin quat_xyzw="0 0 0 1"/>' + AXIS + LIMIT,
        ":3: joint turn, quat_xyzw: in a URDF of version 1, whose readers pass over it; a "
        'quaternion belongs to version 1.1; write <robot ... version="1.1">, or rpy',
    ),
    "one end far away": (
        AXIS + '<limit lower="-1e16" upper="1" effort="1" velocity="1"/>',
        ':3: joint turn, limits: lower limit "-1e16" alone is beyond 100000; a joint has two '
        "limits or none; write both, neither for a joint without, or give them in an assembly file "
        "(joints: {turn: {limits: {position: [..., ...]}}})",
    ),
    "armature below 0": (
        AXIS + LIMIT + '<dynamics armature="-1"/>',
        ":3: joint turn, drive.rotor_inertia: -1 is negative; it is at least 0; write 0 or more",
    ),
    "reversed limits": (
        AXIS + '<limit lower="1" upper="-1" effort="1" velocity="1"/>',
        ":3: joint turn, limits.position: lower limit 1 not below upper limit -1; limits are "
        "[lo, hi]; exchange or correct them",
    ),
    "limits that leave no room": (
        AXIS + '<limit lower="0" upper="0" effort="1" velocity="1"/>',
        ":3: joint turn, limits: lower and upper limit are both 0; such a joint cannot move; "
        'correct them, write type="continuous" if it turns without end, or freeze it '
        "(lock: {turn: 0})",
    ),
    "negative effort": (
        AXIS + '<limit lower="-1" upper="1" effort="-1" velocity="1"/>',
        ":3: joint turn, limits.torque: -1 is not positive; it must be above 0; write a positive "
        "number or leave it out",
    ),
    "negative damping": (
        AXIS + LIMIT + '<dynamics damping="-1"/>',
        ":3: joint turn, friction.viscous: -1 is negative; it is at least 0; write 0 or more",
    ),
    "leader that is not there": (
        AXIS + LIMIT + '<mimic joint="tarn"/>',
        ':3: joint turn, mimic: joint "tarn" does not exist; did you mean "turn"? a joint mimics '
        "another of the file; correct the name",
    ),
    "mimics itself": (
        AXIS + LIMIT + '<mimic joint="turn"/>',
        ":3: joint turn, mimic: joints that mimic each other in a circle: turn -> turn; one of "
        "them is the leader; remove its <mimic>",
    ),
}
BASE, ARM, TURN = link("base", ""), link("arm"), joint("turn", "base", "arm")
ROBOTS = {
    "unknown parent": (
        robot(BASE, joint("turn", "bse", "arm"), ARM),
        ':3: joint turn: parent link "bse" does not exist; did you mean "base"? a joint connects '
        "two links of the file; correct the name or add the link",
    ),
    "no child": (
        robot(BASE, TURN.replace('<child link="arm"/>', ""), ARM),
        ":3: joint turn: no <child>; a joint connects two links; add it",
    ),
    "own parent": (
        robot(BASE, joint("turn", "arm", "arm"), ARM),
        ':3: joint turn: link "arm" is its own parent; a robot is a tree; name another '
        "link as parent or child",
    ),
    "two parents": (
        robot(BASE, TURN, joint("again", "base", "arm"), ARM),
        ':4: joint again: link "arm" is already the child of joint "turn" (line 3); a link has one '
        "parent, loops cannot be described; cut the loop",
    ),
    "a loop and nothing else": (
        robot(link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")),
        ":4: joint j: a loop of links: a -> b -> a; a robot is a tree with one root; cut the loop",
    ),
    "a loop beside the robot": (
        robot(BASE, ARM, TURN, link("a"), link("b"), joint("j", "a", "b"), joint("k", "b", "a")),
        ":7: joint j: a loop of links: a -> b -> a; a robot is a tree with one root; cut the loop",
    ),
    "two roots": (
        robot(BASE, TURN, ARM, link("table")),
        ':5: link table: 2 links without a parent: "base" (line 2), "table" (line 5); a robot is a '
        "tree with one root; connect them by joints or remove what is not the robot",
    ),
    "two links of one name": (
        robot(BASE, TURN, ARM, link("arm")),
        ":5: link arm: a second link of this name (first on line 4); names differ; rename one",
    ),
    "two joints of one name": (
        robot(BASE, TURN, ARM, link("hand"), joint("turn", "arm", "hand")),
        ":6: joint turn: a second joint of this name (first on line 3); names differ; rename one",
    ),
    "no name": (
        robot(BASE, TURN, ARM, "<link/>"),
        ':5: <link>: no "name"; it is required; add name="..."',
    ),
    "unknown type": (
        robot(BASE, joint("turn", "base", "arm", "revolut"), ARM),
        ':3: joint turn: type "revolut"; did you mean "revolute"? known: revolute, continuous, '
        "prismatic, fixed, floating, planar",
    ),
    "floating": (
        robot(BASE, joint("free", "base", "arm", "floating", ""), ARM),
        ":3: joint free: a floating joint; joints are revolute, continuous, prismatic or fixed; a "
        "robot with a base that moves freely is none here; take the part behind it with "
        "base_link: arm",
    ),
    "planar": (
        robot(BASE, joint("free", "base", "arm", "planar", AXIS), ARM),
        ":3: joint free: a planar joint; joints are revolute, continuous, prismatic or fixed; a "
        "robot with a base that moves freely is none here; take the part behind it with "
        "base_link: arm",
    ),
    "leader that does not move": (
        robot(
            BASE, joint("turn", "base", "arm", "fixed", ""), ARM, link("finger"),
            joint("follow", "arm", "finger", inside=AXIS + LIMIT + '<mimic joint="turn"/>'),
        ),
        ':6: joint follow, mimic: mimics joint "turn", which does not move here (fixed, or not '
        "chosen); a joint mimics one that moves; freeze it (lock: {follow: VALUE})",
    ),
    "mimic joint that turns too far": (
        robot(
            BASE, TURN, ARM, link("finger"), link("tip"),
            joint("slow", "arm", "finger", inside=AXIS + LIMIT + '<mimic joint="turn"/>'),
            joint(
                "fast", "arm", "tip",
                inside=AXIS + LIMIT + '<mimic joint="turn" multiplier="1e23" offset="0.5"/>',
            ),
        ),
        ":8: joint fast, mimic: mimics joint turn with multiplier 1e+23 and offset 0.5 rad, so "
        "that it passes 100000 rad while that one moves by 1 rad; no joint turns so far; correct "
        "the two",
    ),
    "nothing behind one joint has mass": (
        robot(BASE, TURN, ARM, link("tip", ""), joint("last", "arm", "tip")),
        ":6: joint last: no link behind it has mass (tip); what moves has mass and inertia; "
        "complete the <inertial>, give it in an assembly file (links: {tip: {mass: ..., com: ..., "
        "inertia: ...}}), or freeze the joint (lock: {last: VALUE})",
    ),
    "nothing moves": (
        robot(BASE, joint("weld", "base", "arm", "fixed", ""), ARM),
        ":1: robot small: no joint that moves; a robot has one; give a URDF of a robot, or lock "
        "less",
    ),
    "no links": (robot(), ":1: robot: no <link>; a robot has links; give a complete URDF"),
    "slip at the top": (
        robot(BASE, TURN, ARM, '<lnik name="x"/>'),
        ':5: robot: unknown element <lnik>; did you mean "link"? correct or remove it',
    ),
    "xacro not expanded": (
        GOOD.replace("0 0 0.3", "0 0 ${height}"),
        ":3: <origin>: xacro that was not expanded; a URDF holds plain numbers; name the file "
        '.xacro and install the package "xacro" (pip install "modrobust[xacro]"), or expand it '
        "first: xacro FILE > robot.urdf",
    ),
    "a prefix that is not declared": (
        robot(BASE, TURN, ARM, "<drake:linear_bushing_rpy/>"),
        ':5: the prefix "drake:" is not declared; XML declares a prefix before it is used; add '
        'xmlns:drake="http://drake.mit.edu" to <robot>',
    ),
    "a version to come": (
        GOOD.replace('name="small"', 'name="small" version="2.0"'),
        ':1: robot: version "2.0"; URDF 1.0, 1.1 and 1.2 are read, and another version may mean '
        'other things by the same words; save the file as one of these (version="1.0" where the '
        "number is the robot's own)",
    ),
    "HRDF in the clothes of a URDF": (
        '<robot version="1.6.0"><actuator type="X8-9"/><link type="X5" extension="0.3"/></robot>',
        ":1: a robot of HEBI's HRDF, which names products and whose figures stand in HEBI's "
        "library; it is not read; give a URDF of the robot, or an assembly file of its modules",
    ),
    "reduction of 0": (
        robot(
            BASE, TURN, ARM,
            '<transmission name="t"><joint name="turn"/><actuator name="m">'
            "<mechanicalReduction>0</mechanicalReduction></actuator></transmission>",
        ),
        ":5: transmission t: mechanicalReduction is 0; motor over joint is not 0; write that ratio",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", LINKS)
def test_a_fault_of_a_link_is_refused_at_its_line(tmp_path: Path, fault: str) -> None:
    inside, message = LINKS[fault]
    assert refusal(written(tmp_path, two_links(inside_link=inside))) == message


@pytest.mark.parametrize("fault", JOINTS)
def test_a_fault_of_a_joint_is_refused_at_its_line(tmp_path: Path, fault: str) -> None:
    inside, message = JOINTS[fault]
    assert refusal(written(tmp_path, two_links(inside))) == message


@pytest.mark.parametrize("fault", ROBOTS)
def test_a_fault_of_the_robot_is_refused_at_its_line(tmp_path: Path, fault: str) -> None:
    text, message = ROBOTS[fault]
    assert refusal(written(tmp_path, text)) == message


OPTIONS: dict[str, tuple[dict[str, Any], str]] = {
    "base that is not there": (
        {"base": "bas"},
        'base_link: no link named "bas"; did you mean "base"? known: base, arm',
    ),
    "tip that is not there": ({"tip": "hand"}, 'tip_link: no link named "hand"; known: base, arm'),
    "tip before the base": (
        {"base": "arm", "tip": "base"},
        'tip_link: link "base" is not behind the base link "arm"; a chain runs from the base away '
        "from the root; choose another base or tip",
    ),
    "lock that is not there": (
        {"lock": {"trun": "0"}},
        'lock.trun: no joint named "trun"; did you mean "turn"? known: turn',
    ),
    "lock outside the limits": (
        {"lock": {"turn": "3 rad"}},
        "lock.turn: 3 lies outside the joint's limits [-2, 2.5] (line 3); lock it at a position "
        "that it can have",
    ),
    "lock of another unit": (
        {"lock": {"turn": "3 m"}},
        'lock.turn: "3 m" has the unit "m"; an angle [rad] is expected; write it in rad',
    ),
    "tolerance that is none": (
        {"tolerance": "mas=5%"},
        'tolerance: unknown key "mas"; did you mean "mass"? known: mass, com, inertia, '
        "rotor_inertia, viscous, coulomb",
    ),
    "tolerance of 0": (
        {"tolerance": "com=5%"},
        "link arm, com[0]: tolerance.com is a per cent and this value is 0; a per cent of 0 leaves "
        "no width; give this value or the tolerance an absolute bound",
    ),
    "payload at nothing": (
        {"payload": "mass=1 kg, com=[0,0,0], at=hand"},
        'payload.at: no link named "hand"; known: arm, base',
    ),
    "payload at the base": (
        {"payload": "mass=1 kg, com=[0,0,0], at=base"},
        'payload.at: "base" is fixed to the base, where a payload moves with no joint; name a link '
        "behind a joint",
    ),
}


@pytest.mark.parametrize("fault", OPTIONS)
def test_a_fault_of_an_argument_names_the_argument(tmp_path: Path, fault: str) -> None:
    options, message = OPTIONS[fault]
    told = refusal(written(tmp_path, GOOD), **options)
    assert told.endswith(message)
    assert told.startswith((*options, ":4: link arm"))
    assert "--" not in told
