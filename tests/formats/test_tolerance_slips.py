"""A tolerance without a unit where a per cent is likely: remarked, or named in the refusal."""

from __future__ import annotations

from pathlib import Path

import pytest

import modrobust as mr
from support.urdf_texts import two_links, written


@pytest.mark.parametrize(
    ("tolerance", "remark"),
    [
        ("mass=0.02", "tolerance.mass: 0.02 is 0.02 kg, not a per cent; 2 % is written 2%"),
        ("mass=1", "tolerance.mass: 1 is 1 kg, not a per cent; 1 % is written 1%"),
        (
            "inertia=0.1",
            "tolerance.inertia: 0.1 is 0.1 kg m^2, not a per cent; 10 % is written 10%",
        ),
        ("com=5", "tolerance.com: 5 is 5 m, not a per cent; 5 mm is written 5 mm"),
        ("com=0.005", None),
        ("mass=2%", None),
        ("mass=0.02 kg", None),
        ("mass=0", None),
        ("viscous=0.02", None),  # the file has no friction: that is another remark
    ],
)
def test_a_bare_number_is_remarked(tmp_path: Path, tolerance: str, remark: str | None) -> None:
    notes = mr.load_robot(written(tmp_path, two_links()), tolerance=tolerance).notes
    said = [note for note in notes if note.startswith("tolerance.")]
    assert said == ([] if remark is None else [remark])


@pytest.mark.parametrize(
    ("tolerance", "remedy"),
    [
        ("mass=5", "the tolerance 5 is no per cent; 5 % is written 5%"),
        ({"mass": 5}, "the tolerance 5 is no per cent; 5 % is written 5%"),
        ("mass=5 kg", "narrow the tolerance"),
        ("mass=200%", "narrow the tolerance"),
    ],
)
def test_a_bound_below_0_says_how_a_per_cent_is_written(tmp_path: Path, tolerance, remedy) -> None:
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(written(tmp_path, two_links()), tolerance=tolerance)
    assert str(caught.value).endswith(f"is negative; a mass is at least 0; {remedy}")


def test_the_rotor_and_the_friction_of_a_module_say_the_same(tmp_path: Path) -> None:
    text = (
        "modrobust: 1\nmodule: link\nname: A link\nsource: test\n"
        "connectors: {in: {type: t}, out: {type: t}}\ntolerance: {coulomb: 5}\nchain:\n"
        "  - {joint: axis, type: revolute, friction: {coulomb: 1}}\n"
        "  - {body: rod, mass: 1, com: [0, 0, 0], inertia: {xx: 1, yy: 1, zz: 1}}\n"
    )
    written(tmp_path, text, "link.yaml")
    arm = written(tmp_path, "modrobust: 1\nrobot: arm\nmodules: .\nchain: [link]\n", "arm.yaml")
    with pytest.raises(mr.ModrobustError, match=r"lower bound -4 is negative; .* 5 % is written"):
        mr.load_robot(arm)
    written(tmp_path, text.replace("coulomb: 5}", "coulomb: 0.02}"), "link.yaml")
    assert any("2 % is written 2%" in note for note in mr.load_robot(arm).notes)
