"""All faults of a URDF in one reading, and the overlay that mends its figures."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import modrobust as mr
from modrobust.cli.wording import as_options
from modrobust.errors import DescriptionError, SeveralFaultsError
from support.urdf_texts import INERTIA, INERTIAL, LIMIT, joint, link, robot, written

AXIS = '<axis xyz="0 0 1"/>'
TURNED = INERTIAL.replace('xyz="0 0 0.1"', 'rpy="0.1 0 0"').replace('"0.03"', '"-0.09"')


def sick() -> str:
    return robot(
        link("base", ""),
        joint("j1", "base", "no-mass"),
        link("no-mass", f"<inertial>{INERTIA}</inertial>"),
        joint("j2", "no-mass", "a b"),
        link("a b", INERTIAL.replace('ixx="0.02"', 'ixx="nan"').replace('"2"', '"-2"')),
        joint("j3", "a b", "turned", inside=AXIS + LIMIT.replace("-2", "0").replace("2.5", "0")),
        link("turned", TURNED),
        joint("j4", "turned", "good"),
        link("good"),
    )


TOLD = """\
small.urdf:4: link no-mass: <inertial> has no <mass>; nothing is guessed; add it, or remove \
<inertial> from a frame without mass
small.urdf:6: link a b, ixx: "nan" is not finite; numbers in a URDF are decimal, in SI units \
without the unit; write it so, such as "0.25"
small.urdf:6: link a b, mass: -2 kg is negative; a body's mass is at least 0; write 0 or more
small.urdf:7: joint j3, limits: lower and upper limit are both 0; such a joint cannot move; \
correct them, write type="continuous" if it turns without end, or freeze it (lock: {j3: 0})
small.urdf:8: link turned, inertia.yy: -0.09 kg m^2 is negative; a moment of inertia is at \
least 0; check the figures and the reference point ("about")
An assembly file over this URDF can give what is open:
links:
  no-mass: {mass: ... kg}
  "a b": {mass: ... kg, inertia: {xx: ... kg m^2, yy: ... kg m^2, zz: ... kg m^2, xy: ... kg m^2, \
xz: ... kg m^2, yz: ... kg m^2}}
  turned: {com: [... m, ... m, ... m], inertia: {xx: ... kg m^2, yy: ... kg m^2, zz: ... kg m^2, \
xy: ... kg m^2, xz: ... kg m^2, yz: ... kg m^2}}
joints:
  j3: {limits: {position: [..., ...]}}"""


def test_all_faults_are_told_with_their_lines_and_an_overlay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path, sick())
    with pytest.raises(SeveralFaultsError) as caught:
        mr.load_robot("small.urdf")
    assert str(caught.value) == TOLD
    assert [fault.line for fault in caught.value.faults] == [4, 6, 6, 7, 8]
    assert caught.value.line == 4
    done = subprocess.run(
        [sys.executable, "-m", "modrobust", "assemble", "small.urdf"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (2, "", as_options(TOLD) + "\n")


def test_the_overlay_filled_in_and_pasted_mends_the_robot(tmp_path: Path) -> None:
    path = written(tmp_path, sick())
    with pytest.raises(SeveralFaultsError) as caught:
        mr.load_robot(path)
    head = "modrobust: 1\nrobot: over\nurdf: small.urdf\n"
    paste = caught.value.overlay.split("\n", 1)[1]
    over = tmp_path / "over.yaml"
    over.write_text(head + paste + "\n", encoding="utf-8")
    with pytest.raises(mr.ModrobustError, match=r'over.yaml:5: .*"\.\.\. kg"'):
        mr.load_robot(over)
    filled = (
        paste.replace("mass: ... kg", "mass: 3 kg")
        .replace("[..., ...]", "[-1, 1]")
        .replace("... m,", "0 m,")
        .replace("... m]", "0 m]")
        .replace("xx: ...", "xx: 0.02")
        .replace("yy: ...", "yy: 0.03")
        .replace("zz: ...", "zz: 0.04")
        .replace("...", "0")
    )  # fmt: skip
    over.write_text(head + filled + "\n", encoding="utf-8")
    mended = mr.load_robot(over)
    at = mended.body_names.index
    assert mended.nominal.mass[at("no-mass")] == 3.0
    assert mended.nominal.inertia[at("a b")].diagonal().tolist() == [0.02, 0.03, 0.04]
    assert mended.position_limits[2].tolist() == [-1.0, 1.0]


def test_one_fault_is_told_as_it_always_was(tmp_path: Path) -> None:
    text = robot(
        link("base", ""), joint("j", "base", "a"), link("a", INERTIAL.replace('"2"', '"-2"'))
    )
    with pytest.raises(DescriptionError) as caught:
        mr.load_robot(written(tmp_path, text))
    assert not isinstance(caught.value, SeveralFaultsError)
    assert "\n" not in str(caught.value)


def test_faults_of_joints_and_of_figures_are_told_together(tmp_path: Path) -> None:
    """Where a joint is at fault it is not known what moves; figures are checked all the same."""
    text = robot(
        link("base", ""),
        joint("j1", "base", "a", inside='<origin xyz="0 0"/><axis xyz="0 0 0"/>' + LIMIT),
        link("a"),
        joint("j2", "a", "b", "hinge"),
        link("b", INERTIAL.replace('"2"', '"-2"')),
        joint("j3", "a", "nobody"),
        joint("j4", "a", "c"),
        link("c", INERTIAL.replace('"2"', '"-3"')),
        '<transmission name="t"><joint name="j1"/><actuator name="m">'
        "<mechanicalReduction>0</mechanicalReduction></actuator></transmission>",
    )
    with pytest.raises(SeveralFaultsError) as caught:
        mr.load_robot(written(tmp_path, text))
    assert [(fault.line, fault.field) for fault in caught.value.faults] == [
        (3, "joint j1, xyz"),
        (3, "joint j1, axis"),
        (5, "joint j2"),
        (7, "joint j3"),
        (9, "link c, mass"),
        (10, "transmission t"),
    ]


def test_a_link_that_cannot_be_read_is_not_missed_by_its_joints(tmp_path: Path) -> None:
    slip = INERTIAL.replace("inertial", "inertail")
    text = robot(link("base", ""), joint("j", "base", "a"), link("a", slip))
    with pytest.raises(DescriptionError) as caught:
        mr.load_robot(written(tmp_path, text))
    assert "<inertail>" in str(caught.value)
    assert "does not exist" not in str(caught.value)


def test_every_joint_behind_which_nothing_has_mass_is_told(tmp_path: Path) -> None:
    text = robot(
        link("base", ""), link("a"), link("b", ""), link("c", ""), link("d", ""),
        joint("j1", "base", "a"), joint("j2", "a", "b"), joint("j3", "b", "c"),
        joint("j4", "a", "d"),
    )  # fmt: skip
    with pytest.raises(SeveralFaultsError) as caught:
        mr.load_robot(written(tmp_path, text))
    assert {fault.field for fault in caught.value.faults} == {"joint j3", "joint j4"}
    assert "  c: {mass: ... kg, com: [" in caught.value.overlay


def test_what_does_not_move_needs_no_figures_that_are_right(tmp_path: Path) -> None:
    text = robot(link("base", INERTIAL.replace('"2"', '"?"')), joint("j", "base", "a"), link("a"))
    loaded = mr.load_robot(written(tmp_path, text))
    assert loaded.body_names == ("a",)
    assert any(note.startswith("link base, value: left out") for note in loaded.notes)


def test_no_more_than_fifty_faults_are_shown(tmp_path: Path) -> None:
    links = [link(f"l{k}", INERTIAL.replace('"2"', '"x"')) for k in range(60)]
    joints = [joint(f"j{k}", "base", f"l{k}") for k in range(60)]
    with pytest.raises(SeveralFaultsError) as caught:
        mr.load_robot(written(tmp_path, robot(link("base", ""), *links, *joints)))
    assert len(caught.value.faults) == 60
    assert "\nand 10 more faults\n" in str(caught.value)


def test_faults_of_a_urdf_are_told_from_the_assembly_file_over_it(tmp_path: Path) -> None:
    written(tmp_path, sick())
    over = "modrobust: 1\nrobot: over\nurdf: small.urdf\nlinks: {no-mass: {mass: 3 kg}}\n"
    with pytest.raises(SeveralFaultsError) as caught:
        mr.load_robot(written(tmp_path, over, "over.yaml"))
    assert [fault.line for fault in caught.value.faults] == [6, 6, 7, 8]
