"""Continuous joints of files: kept, remarked upon where they do not wrap, and written back."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import modrobust as mr
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.model import Robot
from support.urdf_texts import LIMIT, joint, link, robot, two_links, written

AXIS = '<origin xyz="0 0 0.3"/><axis xyz="1 0 0"/>'


def mimicking(folder: Path, mimic_joint: str, multiplier: str, limit: str = "") -> Robot:
    """A continuous joint "turn" that another one mimics."""
    inside = f'{AXIS}{limit}<mimic joint="turn" multiplier="{multiplier}" offset="0.1"/>'
    text = robot(
        link("base", ""),
        joint("turn", "base", "arm", "continuous", AXIS),
        link("arm"),
        joint("mate", "arm", "hand", mimic_joint, inside),
        link("hand"),
    )
    return mr.load_robot(written(folder, text))


@pytest.mark.parametrize(
    ("mimic_joint", "multiplier", "limit", "said"),
    [
        ("continuous", "-1", "", None),
        ("continuous", "3", "", None),
        ("continuous", "0.5", "", "mate, which mimics it, turns 0.5 times as far"),
        ("prismatic", "1", '<limit lower="-1" upper="1" effort="9" velocity="1"/>', None),
    ],
)
def test_where_a_turn_leads_to_another_pose_a_remark_says_that_nothing_wraps(
    tmp_path: Path, mimic_joint: str, multiplier: str, limit: str, said: str | None
) -> None:
    arm = mimicking(tmp_path, mimic_joint, multiplier, limit)
    found = [note for note in arm.notes if "continuous, but" in note]
    assert found == (
        []
        if said is None
        else [
            "joint turn: continuous, but its error is not taken less whole turns, since joint "
            f"{said}: a turn leads to another pose"
        ]
    )
    assert arm.wraps.tolist() == [said is None and mimic_joint == "continuous"]


def test_a_joint_that_its_follower_limits_turns_no_longer_endlessly(tmp_path: Path) -> None:
    arm = mimicking(tmp_path, "revolute", "2", LIMIT)
    assert arm.joint_types == ("revolute", "revolute")
    np.testing.assert_allclose(arm.position_limits, [[-1.05, 1.2]])
    assert not arm.wraps.any()
    assert (
        "joint turn: position limits [-1.05, 1.2], so that joint mate, which mimics it, keeps its "
        "own; written as continuous, it is revolute so, and its error not less whole turns"
    ) in arm.notes


def types(text: str) -> dict[str | None, str | None]:
    return {item.get("name"): item.get("type") for item in ET.fromstring(text).iter("joint")}


def test_a_continuous_joint_is_written_and_read_again_as_one(tmp_path: Path) -> None:
    arm = mr.load_robot(written(tmp_path, two_links(AXIS, kind="continuous")))
    assert arm.wraps.tolist() == [True]
    exported = urdf_text(arm)
    assert types(exported.text)["turn"] == "continuous"
    assert not any("no position limit" in line for line in exported.lost)
    again = mr.load_robot(written(tmp_path, exported.text, "again.urdf"))
    assert again.joint_types == ("continuous",)
    assert 'type="hinge"' in mjcf_text(arm).text


def test_a_joint_without_limits_that_does_not_wrap_is_not_written_as_one_that_does() -> None:
    """A cable that is not torn off here shall not be torn off by the reader of the file."""
    gripper = mr.load_robot("lwa4p-paper")
    assert not np.isfinite(gripper.position_limits).any()
    exported = urdf_text(gripper)
    assert {types(exported.text)[name] for name in gripper.joint_names} == {"revolute"}
    limits = [item.find("limit") for item in ET.fromstring(exported.text).iter("joint")]
    ends = [(x.get("lower"), x.get("upper")) for x in limits if x is not None]
    assert set(ends) == {("-1000000000.0", "1000000000.0")}
    assert "that every joint has no position limit; 1e+09 is written" in exported.lost


def test_modules_keep_their_continuous_joints() -> None:
    scara = mr.load_robot("scara")
    kinds = [item["type"] for item in scara.to_dict()["joints"]]
    assert kinds == ["revolute", "revolute", "prismatic", "continuous"]
    assert scara.wraps.tolist() == [False, False, False, True]
