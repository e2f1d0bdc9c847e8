"""Assembly files resolved, and values per joint."""

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from modrobust.errors import DescriptionError
from modrobust.formats import (
    CsvEntry,
    PerJoint,
    QuinticEntry,
    SinesEntry,
    instance_names,
    load_assembly,
)
from modrobust.formats.exact import above
from modrobust.formats.naming import instance_names_of
from modrobust.formats.reader import _parse_yaml
from support.float_transforms import from_xyz_rpy
from support.formats.format_samples import ASSEMBLY

JOINTS = ("arm.axis", "slide.axis")
TYPES = ("revolute", "prismatic")


@pytest.fixture
def load(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def load_changed(*changes):
        text = ASSEMBLY
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / "r.yaml").write_text(text, encoding="utf-8")
        return load_assembly("r.yaml")

    return load_changed


def per_joint(text, kind, **options):
    return PerJoint(_parse_yaml(f"x: {text}", "r.yaml").entries["x"], "x", kind, **options)


def test_an_assembly_is_resolved_to_si(load):
    assembly = load()
    assert (assembly.name, assembly.file, assembly.modules) == ("r", Path("r.yaml"), (Path("."),))
    assert assembly.gravity == (0.0, 0.0, -9.81)
    assert (assembly.base.rounded() == np.eye(4)).all()
    first, second = assembly.chain
    assert (first.module, first.as_name, first.mount) == ("arm", None, 0.0)
    assert (second.module, second.as_name, float(second.mount)) == ("arm", "tool", math.pi / 2)
    assert second.overrides["link.mass"].text == "3 kg"
    assert second.where.line == 7
    assert instance_names(assembly.chain) == ["arm", "tool"]
    assert (assembly.controller.law, assembly.controller.bound) == ("norm", None)
    assert (assembly.controller.kappa_P, assembly.controller.epsilon) == (2.0, 0.01)
    assert assembly.scenarios["heavy"]["arm.link.mass"].text == "2.01 kg"


def test_defaults_are_gravity_downwards_and_the_base_at_the_world(load):
    assembly = load(("gravity: [0, 0, -9.81 m/s^2]\n", ""), ("modules: .\n", ""))
    assert assembly.gravity == (0.0, 0.0, -9.81)
    assert assembly.modules == ()


def test_a_base_on_the_wall(load):
    assembly = load(("modules: .", "modules: .\nbase: {xyz: [0, 0, 1 m], rpy: [0, pi/2, 0]}"))
    assert (assembly.base.rounded() == from_xyz_rpy((0, 0, 1), (0, math.pi / 2, 0))).all()


def test_a_payload_without_extent_is_a_point_and_says_so(load):
    payload = load().payload
    assert payload.assumed_point
    assert payload.at is None
    assert (payload.mass.lo, payload.mass.nominal, payload.mass.hi) == (0.0, 1.0, 2.0)
    assert all((i.lo, i.nominal, i.hi) == (0.0, 0.0, 0.0) for i in payload.inertia)
    assert payload.com[2].hi == above(Fraction("0.08"))


def test_a_payload_with_a_size_is_a_box(load):
    # xx = m (b^2 + c^2) / 12 with m in [0, 2], b = 2, c in [1, 3]: 0 to 2 (4 + 9) / 12.
    payload = load(("com: [0, 0", "size: [1, 2, [1, 3]], com: [0, 0")).payload
    xx, xy, *_, zz = payload.inertia
    assert not payload.assumed_point
    assert (xx.lo, xx.nominal) == (0.0, 8 / 12)
    assert xx.hi == above(Fraction("26/12"))
    assert (xy.lo, xy.hi, xy.bounded) == (0.0, 0.0, False)
    assert zz.hi == above(Fraction("10/12"))


def test_trajectories_of_each_kind(load):
    sines = load().trajectory
    assert isinstance(sines, SinesEntry)
    assert (sines.omega, sines.duration) == ((math.pi / 5,), 10.0)
    sample = "kind: sines, amplitude: pi/2, omega: [pi/5 rad/s]"
    quintic = load((sample, "kind: quintic, points: [{at: 0, q: 0}, {at: 2 s, q: 1}]")).trajectory
    assert isinstance(quintic, QuinticEntry)
    assert [at for at, _ in quintic.points] == [0.0, 2.0]
    csv = load((sample, "kind: csv, file: motion.csv")).trajectory
    assert csv == CsvEntry(Path("motion.csv"), 10.0)


def test_one_quantity_holds_for_all_joints():
    values = per_joint("0.5", "position").resolve(JOINTS, TYPES)
    assert [value.nominal for value in values] == [0.5, 0.5]


def test_a_mapping_gives_each_joint_its_own_in_its_own_unit():
    values = per_joint("{slide.axis: 5 mm, arm.axis: 90 deg}", "position").resolve(JOINTS, TYPES)
    assert [value.nominal for value in values] == [math.pi / 2, 0.005]


def test_a_disturbance_may_be_a_pair_of_bounds():
    value = per_joint("[-1, 3]", "effort", bounds=True).resolve(JOINTS, TYPES)[0]
    assert (value.lo, value.nominal, value.hi) == (-1.0, 1.0, 3.0)


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        (
            "{arm.axes: 1, slide.axis: 1}",
            "position",
            'r.yaml:1: x: no joint named "arm.axes"; did you mean "arm.axis"? '
            "known: arm.axis, slide.axis",
        ),
        (
            "{arm.axis: 1}",
            "position",
            'r.yaml:1: x: no value for joint "slide.axis"; a mapping names every joint; '
            "add slide.axis",
        ),
        (
            "{arm.axis: 1 mm, slide.axis: 1 mm}",
            "position",
            'r.yaml:1: x.arm.axis: "1 mm" has the unit "mm"; an angle [rad] is expected; '
            "write it in rad",
        ),
        (
            "1 N m",
            "effort",
            'r.yaml:1: x (joint slide.axis): "1 N m" has the unit "N m"; a force [N] is '
            "expected; write it in N",
        ),
    ],
)
def test_values_per_joint_that_are_refused(text, kind, message):
    with pytest.raises(DescriptionError) as caught:
        per_joint(text, kind).resolve(JOINTS, TYPES)
    assert str(caught.value) == message


def test_instances_are_numbered_on_repeats_and_never_share_a_name():
    mounted = [("a", None), ("a", None), ("a", "a-2"), ("a", None), ("b", "a")]
    assert instance_names_of(mounted) == ["a", "a-3", "a-2", "a-4", "a-5"]
