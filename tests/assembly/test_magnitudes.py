"""Magnitudes that nobody means get a remark, and what is usual gets none."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.assembly.summary import report
from support.urdf_texts import joint, link, robot, written

LIMIT = '<limit lower="-2" upper="2.5" effort="30" velocity="1.5"/>'
TURN = '<origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>'
FIRST = (
    '<inertial><origin xyz="0 0 0.1"/><mass value="2"/>'
    '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"/></inertial>'
)
SECOND = FIRST.replace('value="2"', 'value="1"')
ARM = robot(
    link("base", ""),
    joint("one", "base", "a", inside=TURN + LIMIT),
    link("a", FIRST),
    joint("two", "a", "b", inside=TURN + LIMIT),
    link("b", SECOND),
)
STARTS = ("joint ", "body ", "masses ", "reach:")


def said(folder: Path, text: str, **options: Any) -> list[str]:
    found = report(mr.load_robot(written(folder, text), **options), poses=200).notes
    return [note for note in found if note.startswith(STARTS)]


def changed(old: str, new: str) -> str:
    assert old in ARM
    return ARM.replace(old, new, 1)


def test_an_arm_of_usual_magnitudes_has_no_remark(tmp_path: Path) -> None:
    assert said(tmp_path, ARM) == []


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        (
            changed('effort="30"', 'effort="3"'),
            r"joint one: static torque of ",
        ),
        (
            changed('lower="-2" upper="2.5"', 'lower="-180" upper="180"'),
            "joint one: position limits -180 to 180 rad, up to 28.6 turns: degrees that were read "
            "as radians?",
        ),
        (
            changed('ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"',
                    'ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.2"'),
            # sqrt(0.7 / 2 / 2); the joint above is 0.2 m from the centre of mass
            "body a: 2 kg with a radius of gyration of 0.418 m, but its link reaches no farther "
            "than 0.2 m from its centre of mass",
        ),
        (
            changed('<mass value="1"/>', '<mass value="1e-4"/>').replace(
                'ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.01"/></inertial></link>\n<',
                'ixx="2e-8" ixy="0" ixz="0" iyy="2e-8" iyz="0" izz="2e-8"/></inertial></link>\n<'),
            "masses from 0.0001 kg (body b) to 2 kg (body a), a ratio of 2e+04",
        ),
        (
            ARM.replace('xyz="0 0 0.3"', 'xyz="0 0 300"').replace('effort="30"', 'effort="1e9"'),
            "reach: ",
        ),
    ],
)  # fmt: skip
def test_a_magnitude_that_nobody_means_is_remarked(tmp_path: Path, text: str, remark: str) -> None:
    (found,) = said(tmp_path, text)
    assert found.startswith(remark)


def test_the_share_of_the_static_torque_counts_what_the_bounds_allow(tmp_path: Path) -> None:
    """2 kg at 0.1 m and 1 kg at 0.4 m: 5.89 N m at nominal, 8.83 with half as much more mass."""
    text = changed('effort="30"', 'effort="8"')
    assert said(tmp_path, text) == []
    (found,) = said(tmp_path, text, tolerance="mass=50%")
    torque = re.match(r"joint one: static torque of (8\.\d+) N m, 1[01]\d% of its limit", found)
    assert torque is not None
    assert 8.5 < float(torque[1]) <= 8.83


def test_degrees_on_a_slide_are_lengths(tmp_path: Path) -> None:
    slide = changed('name="one" type="revolute"', 'name="one" type="prismatic"')
    assert said(tmp_path, slide.replace('lower="-2" upper="2.5"', 'lower="-8" upper="8"')) == []
    far = said(tmp_path, slide.replace('lower="-2" upper="2.5"', 'lower="-50" upper="50"', 1))
    assert [note[:6] for note in far] == ["reach:"]


def test_a_long_thin_link_is_spread_as_far_as_it_reaches(tmp_path: Path) -> None:
    """A rod of 2 m and 2 kg: 0.667 kg m^2 about its middle; about its end by mistake it is told."""
    rod = ARM.replace('<origin xyz="0 0 0.1"/>', '<origin xyz="0 0 1"/>', 1)
    for moment, remarks in (("0.667", 0), ("2.667", 1)):
        text = rod.replace('iyy="0.03"', f'iyy="{moment}"', 1).replace("0.02", moment, 1)
        notes = mr.load_robot(written(tmp_path, text)).notes
        found = [note for note in [*notes, *said(tmp_path, text)] if "gyration" in note]
        assert len(set(found)) == remarks


def test_a_link_reaches_from_its_own_joint_to_its_end(tmp_path: Path) -> None:
    """The last link is 1.5 m long, its mass at its end and spread by 0.42 m."""
    text = ARM.replace("0.02", "0.2").replace("0.03", "0.3").replace("0.01", "0.2")
    arm = mr.load_robot(written(tmp_path, text))
    after, placement = np.array(arm.after), np.array(arm.placement)
    after[1, 2, 3], placement[1, 2, 3] = 1.5, -0.2
    long = replace(arm, after=after, placement=placement)
    told = [[n for n in report(r, poses=10).notes if n.startswith("body b")] for r in (arm, long)]
    assert [len(notes) for notes in told] == [1, 0]
