"""Which way gravity points: the way from the root to the base, `mount`, `gravity`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import modrobust as mr
from support.urdf_texts import LIMIT, joint, link, robot, written

Y = '<axis xyz="0 1 0"/>' + LIMIT
ON_THE_WALL = '<origin xyz="0 0.1 0.5" rpy="0 1.5707963267948966 0"/>'
STATE = (0.3, 0.4)


def arm(mount: str = joint("mount", "world", "base", "fixed", ON_THE_WALL)) -> str:
    body = (
        '<inertial><origin xyz="0.1 0 0"/><mass value="1"/>'
        '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>'
    )
    return robot(
        link("world", ""), link("base"), link("a", body), link("b", body), mount,
        joint("one", "base", "a", inside='<axis xyz="0 0 1"/>' + LIMIT),
        joint("two", "a", "b", inside='<origin xyz="0.3 0 0"/>' + Y),
    )  # fmt: skip


def gravity_torque(loaded: mr.Robot) -> list[float]:
    still = np.zeros(loaded.n)
    return [float(x) for x in mr.inverse_dynamics(loaded, STATE, still, still, still)]


def test_the_fixed_way_to_the_base_keeps_its_turn(tmp_path: Path) -> None:
    path = written(tmp_path, arm())
    right = gravity_torque(mr.load_robot(path))
    # By hand, gravity along -x of the base: both links about z, the second about its own y.
    c1, s1, c2, s2 = np.cos(0.3), np.sin(0.3), np.cos(0.4), np.sin(0.4)
    expected = [9.81 * (0.1 + 0.3 + 0.1 * c2) * s1, 9.81 * 0.1 * s2 * c1]
    assert right == pytest.approx(expected, rel=1e-12)
    loaded = mr.load_robot(path, base="base")
    assert gravity_torque(loaded) == right
    assert loaded.base[:3, 3].tolist() == [0.0, 0.1, 0.5]
    overlay = "modrobust: 1\nrobot: over\nurdf: small.urdf\nbase_link: base\n"
    assert gravity_torque(mr.load_robot(written(tmp_path, overlay, "over.yaml"))) == right


def test_a_way_that_moves_stands_still_and_that_is_said(tmp_path: Path) -> None:
    lift = joint("lift", "world", "base", inside=ON_THE_WALL + Y)
    path = written(tmp_path, arm(lift))
    loaded = mr.load_robot(path, base="base")
    assert gravity_torque(loaded) == gravity_torque(mr.load_robot(written(tmp_path, arm())))
    path = written(tmp_path, arm(lift))
    told = [note for note in loaded.notes if note.startswith("upright")]
    assert told == [
        "upright is the root world of the URDF; between it and the base base moves what is held "
        "still here: joint lift at 0 rad; where it stands elsewhere, gravity has another "
        "direction: lock it there (lock:), or turn the root (base: {rpy})"
    ]
    leaning = mr.load_robot(path, base="base", lock={"lift": "-0.5 rad"})
    whole = mr.load_robot(path, lock={"lift": "-0.5 rad"})
    np.testing.assert_allclose(gravity_torque(leaning), gravity_torque(whole), rtol=1e-14)
    floating = arm(joint("free", "world", "base", "floating", ON_THE_WALL))
    loaded = mr.load_robot(written(tmp_path, floating), base="base")
    assert any("floating joint free at its origin" in note for note in loaded.notes)
    assert gravity_torque(loaded) == gravity_torque(mr.load_robot(written(tmp_path, arm())))


def test_a_mimic_joint_on_the_way_stands_where_it_mimics(tmp_path: Path) -> None:
    lead = joint("lead", "world", "rail", inside=Y)
    follow = joint(
        "follow", "world", "base", inside=Y + '<mimic joint="lead" multiplier="2" offset="0.3"/>'
    )
    text = arm(follow + lead + link("rail"))
    loaded = mr.load_robot(written(tmp_path, text), base="base")
    assert any("joint follow at 0.3 rad" in note for note in loaded.notes)
    np.testing.assert_allclose(loaded.base[0, 2], np.sin(0.3), rtol=1e-15)


def test_mount_turns_the_root_and_stands_before_the_way(tmp_path: Path) -> None:
    path = written(tmp_path, arm())
    back = mr.load_robot(path, base="base", mount="0 -1.5707963267948966 0")
    np.testing.assert_array_equal(back.base[:3, :3], np.eye(3))
    listed: list[str | float] = ["0.1", 0.2, "0.3 rad"]
    for mount in ("0.1, 0.2 rad, 0.3", (0.1, 0.2, 0.3), "[0.1 0.2 0.3]", listed):
        turned = mr.load_robot(path, base="base", mount=mount)
        overlay = (
            "modrobust: 1\nrobot: over\nurdf: small.urdf\nbase_link: base\n"
            "base: {rpy: [0.1, 0.2, 0.3]}\n"
        )
        written_so = mr.load_robot(written(tmp_path, overlay, "over.yaml"))
        np.testing.assert_array_equal(turned.base, written_so.base)
    cx, sx, cy, sy, cz, sz = (f(x) for x in (0.1, 0.2, 0.3) for f in (np.cos, np.sin))
    roll = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    pitch = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    yaw = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    wall = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    np.testing.assert_allclose(turned.base[:3, :3], yaw @ pitch @ roll @ wall, atol=1e-15)


def test_mount_and_gravity_work_for_robots_of_modules_too() -> None:
    plain = mr.load_robot("lwa4p")
    hung = mr.load_robot("lwa4p", mount="180 deg, 0, 0")
    assert hung.base[:3, :3].tolist() == [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
    up = mr.load_robot("lwa4p", gravity=(0, 0, 9.81))
    q, still = np.linspace(0.1, 0.6, plain.n), np.zeros(plain.n)
    torque = [mr.inverse_dynamics(r, q, still, still, still) for r in (plain, hung, up)]
    np.testing.assert_allclose(torque[1], torque[2], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(torque[0], -torque[2], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"mount": "0 0"}, "mount: 2 entries in '0 0'; it is a vector of three"),
        ({"mount": "0, 1 m, 0"}, 'mount.rpy[1]: "1 m" has the unit "m"'),
        ({"gravity": "0 0 down"}, 'gravity[2]: "down" is not'),
        ({"gravity": (0.0, 0.0)}, "gravity: 2 entries in (0.0, 0.0)"),
    ],
)
def test_a_mount_or_gravity_that_is_none_is_refused(options: dict[str, object], told: str) -> None:
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot("lwa4p", **options)  # type: ignore[arg-type]
    assert told in str(caught.value)


def test_assemble_says_which_way_gravity_points(tmp_path: Path) -> None:
    path = written(tmp_path, arm())
    command = [sys.executable, "-m", "modrobust", "assemble", str(path), "--base", "base"]
    environment = {**os.environ, "COLUMNS": "80"}

    def shown(*options: str) -> str:
        done = subprocess.run(
            [*command, *options], capture_output=True, text=True, check=True, env=environment
        )
        return done.stdout

    assert "Gravity in base axes: [9.81 0 0] m/s^2, along +x.\n" in shown()
    text = shown("--mount", "0, -90 deg, 0", "--gravity", "0 0 -1.62")
    assert "Gravity in base axes: [0 0 -1.62] m/s^2, along -z.\n" in text
