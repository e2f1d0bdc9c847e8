"""Drive and friction of all joints of a URDF, given as one option."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import modrobust as mr
from support.urdf_texts import LIMIT, joint, link, robot, two_links, written

AXIS = '<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>'
FIGURES = "rotor_inertia=1e-5 ± 20%, gear_ratio=100, viscous=[0.5, 1.5], coulomb=2"


def two_joints(folder: Path, dynamics: str = "", mimic: str = "") -> Path:
    """A joint that turns and one that slides behind it."""
    text = robot(
        link("base", ""),
        joint("turn", "base", "arm", inside=f"{AXIS}{LIMIT}{dynamics}"),
        link("arm"),
        joint("slide", "arm", "hand", "prismatic", f"{AXIS}{LIMIT}{mimic}"),
        link("hand"),
    )
    return written(folder, text)


def figures(loaded: mr.Robot, name: str) -> tuple[list[float], ...]:
    points = (loaded.nominal, loaded.lower, loaded.upper)
    return tuple(getattr(point, name).tolist() for point in points)


def test_every_joint_gets_the_figures_with_their_bounds(tmp_path: Path) -> None:
    loaded = mr.load_robot(two_joints(tmp_path, '<dynamics damping="7"/>'), drive=FIGURES)
    assert loaded.gear_ratio.tolist() == [100.0, 100.0]
    nominal, lower, upper = figures(loaded, "rotor_inertia")
    assert nominal == [1e-5, 1e-5]
    assert lower == pytest.approx([8e-6, 8e-6])
    assert upper == pytest.approx([1.2e-5, 1.2e-5])
    assert figures(loaded, "viscous") == ([1.0, 1.0], [0.5, 0.5], [1.5, 1.5])
    assert figures(loaded, "coulomb") == ([2.0, 2.0],) * 3


def test_a_mapping_is_read_as_the_text_and_tolerances_apply(tmp_path: Path) -> None:
    path = two_joints(tmp_path)
    drive = {"rotor_inertia": 1e-5, "gear_ratio": 100}
    loaded = mr.load_robot(path, drive=drive, tolerance={"rotor_inertia": "50%"})
    text = mr.load_robot(path, drive="rotor_inertia=1e-5 ± 50%, gear_ratio=100")
    assert loaded.to_dict()["joints"] == text.to_dict()["joints"]


def test_what_is_not_given_stays_the_file_s(tmp_path: Path) -> None:
    path = two_joints(tmp_path, '<dynamics damping="7" friction="3"/>')
    loaded = mr.load_robot(path, drive="coulomb=1")
    assert figures(loaded, "viscous")[0] == [7.0, 0.0]
    assert figures(loaded, "coulomb")[0] == [1.0, 1.0]
    assert loaded.gear_ratio.tolist() == [0.0, 0.0]


def test_it_counts_more_than_an_assembly_file(tmp_path: Path) -> None:
    two_joints(tmp_path)
    path = tmp_path / "arm.yaml"
    text = "modrobust: 1\nrobot: arm\nurdf: small.urdf\njoints: {turn: {friction: {coulomb: 9}}}\n"
    path.write_text(text, encoding="utf-8")
    assert figures(mr.load_robot(path), "coulomb")[0] == [9.0, 0.0]
    assert figures(mr.load_robot(path, drive="coulomb=1"), "coulomb")[0] == [1.0, 1.0]


def test_a_mimic_joint_is_driven_by_its_leader(tmp_path: Path) -> None:
    path = two_joints(tmp_path, mimic='<mimic joint="turn" multiplier="0.1"/>')
    loaded = mr.load_robot(path, drive=FIGURES)
    assert loaded.gear_ratio.tolist() == [100.0, 0.0]
    assert figures(loaded, "coulomb")[0] == [2.0, 0.0]


def test_an_armature_gives_way_to_it_with_a_remark(tmp_path: Path) -> None:
    path = written(tmp_path, two_links(f'{AXIS}{LIMIT}<dynamics armature="0.05"/>'))
    loaded = mr.load_robot(path, drive=FIGURES)
    assert loaded.gear_ratio.tolist() == [100.0]
    told = "joint turn: armature of 0.05 left out, since it is given for all joints"
    assert told in loaded.notes
    assert mr.load_robot(path, drive="viscous=1").gear_ratio.tolist() == [1.0]


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (
            "rotor_inerta=1",
            'drive: unknown key "rotor_inerta"; did you mean "rotor_inertia"? known: rotor_in',
        ),
        (
            "rotor_inertia=1e-5",
            "drive: rotor_inertia without gear_ratio; the joint feels the rotor through the gear; "
            "add gear_ratio (1 for a direct drive)",
        ),
        (
            "gear_ratio=0",
            "drive.gear_ratio: 0 is not positive; it must be above 0; write a positive number",
        ),
        ("gear_ratio=100 ± 1%", 'drive.gear_ratio: "100 ± 1%" has bounds; this field takes none'),
        ("viscous=1 ± 2", "drive.viscous: lower bound -1 is negative; it is at least 0; write"),
        ("coulomb=-1", "drive.coulomb: -1 is negative; it is at least 0; write 0 or more"),
        ("coulomb=1 kg", 'drive.coulomb: "1 kg" has the unit "kg"; a torque [N m] or a force [N]'),
        (
            "viscous=1 N s/m",
            'drive: joint turn, friction.viscous: "1 N s/m" has the unit "N s/m"; an angular ',
        ),
        (5, "drive: 5; must be a text or a mapping; such as "),
    ],
)
def test_a_drive_is_refused_for(tmp_path: Path, drive: Any, message: str) -> None:
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(two_joints(tmp_path), drive=drive)
    assert str(caught.value).startswith(message)


def test_a_robot_of_modules_has_its_drives_in_its_files() -> None:
    with pytest.raises(mr.ModrobustError, match=r"drive: a robot of modules; .* module files"):
        mr.load_robot("lwa4p-paper", drive=FIGURES)
