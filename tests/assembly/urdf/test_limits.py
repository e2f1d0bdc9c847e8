"""Limits of a URDF as real files write them: placeholders, halves, none at all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import modrobust as mr
from support.urdf_texts import LIMIT, joint, link, robot, two_links, written

AXIS = '<axis xyz="0 0 1"/>'
NONE = "position limits beyond 100000 taken as none: turn"


def limited(folder: Path, limit: str, kind: str = "revolute") -> mr.Robot:
    return mr.load_robot(written(folder, two_links(AXIS + limit, kind=kind)))


@pytest.mark.parametrize("far", ["1e16", "1e9", "999999", "3.4028235e+38", "1.8e308", "inf"])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_both_ends_beyond_1e5_are_no_limits(tmp_path: Path, far: str, kind: str) -> None:
    limit = f'<limit lower="-{far}" upper="{far}" effort="1" velocity="1"/>'
    loaded = limited(tmp_path, limit, kind)
    assert loaded.position_limits.tolist() == [[-np.inf, np.inf]]
    assert NONE in loaded.notes


def test_an_end_at_1e5_is_kept(tmp_path: Path) -> None:
    loaded = limited(tmp_path, '<limit lower="-1e5" upper="1e5" effort="1" velocity="1"/>')
    assert loaded.position_limits.tolist() == [[-1e5, 1e5]]
    assert NONE not in loaded.notes


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_joint_without_limits_has_none_and_that_is_said_once(tmp_path: Path, kind: str) -> None:
    text = robot(
        link("base", ""), link("a"), link("b"),
        joint("one", "base", "a", kind, AXIS), joint("two", "a", "b", kind, AXIS),
    )  # fmt: skip
    loaded = mr.load_robot(written(tmp_path, text))
    assert np.isinf(loaded.position_limits).all()
    assert np.isinf(loaded.velocity_limits).all()
    assert np.isinf(loaded.effort_limits).all()
    assert loaded.notes[1:] == (
        "no position limits are written, so there are none: one, two",
        "no velocity limit is written, so there is none: one, two",
        "no effort limit is written, so there is none: one, two",
    )
    assert mr.simulate(loaded, duration=0.02).t[-1] == pytest.approx(0.02)


def test_a_joint_with_a_limit_of_neither_end_has_none(tmp_path: Path) -> None:
    loaded = limited(tmp_path, '<limit effort="7" velocity="3"/>')
    assert np.isinf(loaded.position_limits).all()
    assert (loaded.effort_limits[0], loaded.velocity_limits[0]) == (7.0, 3.0)
    assert "no position limits are written, so there are none: turn" in loaded.notes


def test_an_end_that_is_missing_is_0(tmp_path: Path) -> None:
    loaded = limited(tmp_path, '<limit upper="2" effort="7" velocity="3"/>')
    assert loaded.position_limits.tolist() == [[0.0, 2.0]]


def test_figures_beyond_1e5_are_no_limits_of_speed_effort_and_acceleration(tmp_path: Path) -> None:
    limit = '<limit lower="-1" upper="1" effort="1e16" velocity="inf" acceleration="1e300"/>'
    loaded = limited(tmp_path, limit)
    for limits in (loaded.effort_limits, loaded.velocity_limits, loaded.acceleration_limits):
        assert np.isinf(limits).all()
    for word in ("effort", "velocity", "acceleration"):
        assert f"{word} limits beyond 100000 taken as none: turn" in loaded.notes


def test_an_overlay_gives_limits_that_the_file_has_wrong(tmp_path: Path) -> None:
    written(tmp_path, two_links(AXIS + LIMIT.replace("-2", "0").replace("2.5", "0")))
    overlay = (
        "modrobust: 1\nrobot: over\nurdf: small.urdf\n"
        "joints: {turn: {limits: {position: [-1, 1]}}}\n"
    )
    loaded = mr.load_robot(written(tmp_path, overlay, "over.yaml"))
    assert loaded.position_limits.tolist() == [[-1.0, 1.0]]
    assert loaded.effort_limits.tolist() == [30.0]


def test_a_slide_of_two_equal_ends_is_not_told_to_turn(tmp_path: Path) -> None:
    limit = '<limit lower="0" upper="0" effort="1" velocity="1"/>'
    with pytest.raises(mr.ModrobustError) as caught:
        limited(tmp_path, limit, "prismatic")
    assert "continuous" not in str(caught.value)
