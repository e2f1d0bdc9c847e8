"""Module files resolved: numbers in SI, tolerances, tensors moved to the COM, overrides."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from modrobust.errors import DescriptionError
from modrobust.formats import FrameItem, instance_names, load_module
from modrobust.formats.exact import above, below
from modrobust.formats.inertia import box_is_physical, largest_principal_moment
from modrobust.formats.quantity import Quantity
from modrobust.formats.reader import _parse_yaml
from support.float_transforms import (
    dh_modified,
    dh_standard,
    from_xyz_rpy,
    giusti2015,
    giusti2015_iit,
)
from support.formats.format_samples import MODULE


@pytest.fixture
def load(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def load_changed(*changes, overrides=None):
        text = MODULE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / "arm.yaml").write_text(text, encoding="utf-8")
        nodes = _parse_yaml(overrides, "robot.yaml").entries if overrides else None
        return load_module("arm.yaml", nodes)

    return load_changed


def test_a_module_is_resolved_to_si(load):
    module = load()
    joint, body = module.items
    assert (module.id, module.name, module.source) == ("arm", "Arm", ("made up for the tests",))
    assert module.product
    assert (joint.name, joint.type, joint.position) == ("axis", "revolute", (-1.0, 1.0))
    assert (joint.velocity, joint.effort, joint.gear_ratio) == (1.0, 5.0, 100.0)
    assert joint.rotor_inertia == Quantity(1e-5, 1e-5, 1e-5, bounded=False)
    assert joint.coulomb_speed == 1e-3
    assert body.mass == Quantity(2.0, 1.96, 2.04, bounded=True)
    assert [c.nominal for c in body.com] == [0.1, 0.0, 0.0]
    assert [i.nominal for i in body.inertia] == [0.02, 0.0, 0.0, 0.03, 0.0, 0.03]
    assert not body.at_end
    assert (body.span.rounded() == dh_standard(0.3, np.pi / 2, 0.0, 0.0)).all()
    assert module.connector_in.clocking is None
    assert module.connector_out.clocking == np.pi / 2
    assert (module.connector_in.gender, module.connector_in.size) == ("n", None)


@pytest.mark.parametrize(
    ("span", "matrix"),
    [
        ("dh: {convention: modified, a: 1, alpha: 30 deg, d: 2, theta: 40 deg}",
         dh_modified(1, np.deg2rad(30), 2, np.deg2rad(40))),
        ("xyz: [1, 2, 3], rpy: [10 deg, 20 deg, 30 deg]",
         from_xyz_rpy((1, 2, 3), np.deg2rad((10, 20, 30)))),
        ("giusti2015: {convention: giusti, p: 1, delta_in: 2, a: 3, alpha: 4, n: 5, delta_out: 6}",
         giusti2015(1, 2, 3, 4, 5, 6)),
        ("giusti2015: {convention: iit, p: 1, delta_in: 2, a: 3, alpha: 4, n: 5, delta_out: 6}",
         giusti2015_iit(1, 2, 3, 4, 5, 6)),
    ],
    ids=["modified", "pose", "giusti", "iit"],
)  # fmt: skip
def test_each_way_of_writing_a_span_gives_its_transform(load, span, matrix):
    apart = "  - frame: apart\n    span: {xyz: [0, 0, 1 mm]}\n  - body: link"  # from the joint
    old = "dh: {convention: standard, a: 0.3 m, alpha: pi/2}"
    body = load((old, span), ("  - body: link", apart)).items[2]
    assert body.span.rounded() == pytest.approx(matrix, abs=1e-15)


def test_a_continuous_joint_is_one_without_position_limits(load):
    joint = load(("type: revolute", "type: continuous"), ("position: [-1 rad, 1 rad], ", "")).items[
        0
    ]
    assert (joint.type, joint.position) == ("continuous", None)


def test_an_own_bound_wins_over_the_tolerance_and_the_tolerance_is_reported_unused(load):
    module = load(("mass: 2 kg", "mass: 2 kg ± 1 kg"))
    assert (module.items[1].mass.lo, module.items[1].mass.hi) == (1.0, 3.0)
    assert module.unused_tolerances == ("mass",)
    assert load().unused_tolerances == ()


def test_a_tolerance_on_an_absent_parameter_does_nothing_and_is_reported(load):
    module = load(
        ("{mass: 2%}", "{mass: 2%, viscous: 10%, coulomb: 1 N m}"),
        ("    friction: {viscous: 1 N m s/rad, coulomb: 1 N m}\n", ""),
    )
    assert module.unused_tolerances == ("viscous", "coulomb")


def test_absolute_tolerances_apply_to_each_entry(load):
    body = load(("{mass: 2%}", "{com: 2 mm, inertia: 1e-3 kg m^2}")).items[1]
    assert body.com[1] == Quantity(0.0, below(Fraction(-2, 1000)), above(Fraction(2, 1000)), True)
    assert body.inertia[1].hi == above(Fraction(1, 1000))
    assert body.inertia[0].lo == below(Fraction(19, 1000))


def test_inertia_per_cent_is_of_the_largest_principal_moment_on_all_six(load):
    body = load(("{mass: 2%}", "{inertia: 10%}")).items[1]
    for entry, nominal in zip(body.inertia, (20, 0, 0, 30, 0, 30), strict=True):
        assert entry.lo == below(Fraction(nominal - 3, 1000))
        assert entry.hi == above(Fraction(nominal + 3, 1000))


def test_per_cent_on_one_inertia_entry_is_of_that_entry(load):
    body = load(("{mass: 2%}", "{inertia: 10%}"), ("xx: 0.02", "xx: 0.02 ± 10%")).items[1]
    assert body.inertia[0].hi == above(Fraction(22, 1000))


ABOUT_FRAME = (
    ("[0.1 m, 0, 0]", "[0.1 m, -0.2 m, 0.3 m]"),
    (
        "{xx: 0.02, yy: 0.03, zz: 0.03}",
        "{about: frame, xx: 1.26 ± 0.1, yy: 1.2 ± 10%, zz: [1.05, 1.15], xy: 0 ± 0.02}",
    ),
)


def test_a_tensor_about_the_frame_keeps_its_point_and_its_box_as_written(load):
    body = load(*ABOUT_FRAME).items[1]
    assert body.inertia_about == "frame"
    assert [entry.nominal for entry in body.inertia] == [1.26, 0.0, 0.0, 1.2, 0.0, 1.1]
    assert (body.inertia[0].lo, body.inertia[0].hi) == (1.16, above(Fraction(136, 100)))
    assert (body.inertia[3].lo, body.inertia[3].hi) == (
        below(Fraction(108, 100)),
        above(Fraction(132, 100)),
    )
    assert (body.inertia[5].lo, body.inertia[5].hi) == (
        below(Fraction(105, 100)),
        above(Fraction(115, 100)),
    )
    assert body.inertia[1].lo == -0.02
    assert load().items[1].inertia_about == "com"


def test_tolerance_per_cent_is_of_the_tensor_as_written_about_the_frame(load):
    # About the COM, 2 kg at 0.1 m away, the largest moment would be 0.05, not 0.07.
    about = "{about: frame, xx: 0.05, yy: 0.07, zz: 0.07}"
    body = load(("{mass: 2%}", "{inertia: 10%}"), ("{xx: 0.02, yy: 0.03, zz: 0.03}", about)).items[
        1
    ]
    for entry, nominal in zip(body.inertia, (50, 0, 0, 70, 0, 70), strict=True):
        assert entry.lo == below(Fraction(nominal - 7, 1000))
        assert entry.hi == above(Fraction(nominal + 7, 1000))


def test_a_tensor_about_the_frame_is_judged_where_it_is_moved_to_the_com(load):
    # 2 kg at 0.1 m add 0.02 to yy and zz: 0.02 is a rod along x, a little less is none.
    rod = "{about: frame, xx: 1e-3, yy: 0.021, zz: 0.021}"
    assert load(("{xx: 0.02, yy: 0.03, zz: 0.03}", rod)).items[1].inertia[3].nominal == 0.021
    with pytest.raises(DescriptionError, match="after the move to the COM is negative"):
        load(("{xx: 0.02, yy: 0.03, zz: 0.03}", rod.replace("yy: 0.021", "yy: 0.019")))


def test_a_box_of_mass_or_com_may_hold_bodies_that_do_not_exist_with_a_tensor_about_the_frame(load):
    about = ("{xx: 0.02, yy: 0.03, zz: 0.03}", "{about: frame, xx: 0.01, yy: 0.03, zz: 0.03}")
    exact, other = ("{mass: 2%}", "{com: 0}"), "the bounds of its inertia also hold tensors"
    assert not any(other in note for note in load(exact, about).notes)
    # moved by 0.02 at nominal, by 0.03 at 3 kg: nothing would be left of yy
    heavy = load(exact, ("mass: 2 kg", "mass: 2 kg ± 1 kg"), about)
    assert any(other in note for note in heavy.notes)
    far = load(exact, ("[0.1 m, 0, 0]", "[0.1 m ± 30 mm, 0, 0]"), about)
    assert any(other in note for note in far.notes)


def test_a_box_with_tensors_that_no_body_has_is_noted(load):
    assert load().notes == ("none",)
    assert load(("xx: 0.02", "xx: 0.02 ± 0.05")).notes == (
        "none",
        "body link: the bounds of its inertia also hold tensors that no rigid body has",
    )


def test_a_thin_plate_on_the_boundary_of_the_triangle_inequality_is_a_body(load):
    body = load(("xx: 0.02, yy: 0.03, zz: 0.03", "xx: 0.1, yy: 0.2, zz: 0.3")).items[1]
    assert box_is_physical(body.inertia)


@given(st.lists(st.integers(-(10**6), 10**6), min_size=9, max_size=9))
@settings(max_examples=150, deadline=None, database=None, derandomize=True)
def test_the_largest_principal_moment_is_never_understated(numbers):
    a = [[Fraction(x, 10**6) for x in numbers[i : i + 3]] for i in (0, 3, 6)]
    gram = [
        [sum((x * y for x, y in zip(p, q, strict=True)), Fraction(i == j)) for j, q in enumerate(a)]
        for i, p in enumerate(a)
    ]
    tensor = [gram[i][j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]
    bound = largest_principal_moment(tensor)
    computed = np.linalg.eigvalsh(np.array(gram, dtype=float))[-1]
    assert computed * (1 - 1e-14) <= float(bound) <= computed * (1 + 1e-14)


def test_overrides_replace_values_before_tolerances_apply(load):
    module = load(overrides="link.mass: 4 kg\nlink.inertia.xx: 0.025\naxis.limits.torque: 7 N m")
    assert module.items[1].mass.nominal == 4.0
    assert module.items[1].mass.hi == above(Fraction(408, 100))
    assert module.items[1].inertia[0].nominal == 0.025
    assert module.items[0].effort == 7.0


def test_overrides_add_optional_values_and_may_bring_their_own_bound(load):
    module = load(
        ("    friction: {viscous: 1 N m s/rad, coulomb: 1 N m}\n", ""),
        overrides="axis.friction.viscous: 3 ± 1\nlink.inertia.xy: 1e-3\nlink.span.dh.d: 10 mm",
    )
    assert module.items[0].viscous == Quantity(3.0, 2.0, 4.0, bounded=True)
    assert module.items[1].inertia[1].nominal == 1e-3
    assert module.items[1].span.rounded()[2, 3] == 0.01


def test_a_body_set_to_none_leaves_its_span_behind(load):
    module, whole = load(overrides="link: none"), load()
    assert isinstance(module.items[1], FrameItem)
    assert module.items[1].name == "link"
    assert module.items[1].span == whole.items[1].span
    assert len(module.items) == len(whole.items)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        (
            "lnk.mass: 1",
            'robot.yaml:1: set.lnk.mass: no part "lnk" in module "arm"; did you mean "link"? '
            "known: axis, link",
        ),
        (
            "axis: 1",
            'robot.yaml:1: set.axis: "axis" is a part of module "arm"; a path names a field of a '
            "part; write one such as axis.limits",
        ),
        (
            "link: 1",
            'robot.yaml:1: set.link: "1" for a whole body; a body is set by its fields or taken '
            "off; write link.mass, or link: none",
        ),
        (
            "link: none\nlink.mass: 1",
            'robot.yaml:2: frame link: unknown key "mass"; known: frame, span',
        ),
        (
            "link.mas: 1",
            'robot.yaml:1: set.link.mas: "mas" cannot be set; did you mean "mass"? '
            "known: mass, com, inertia, span, expressed_in",
        ),
        (
            "link.inertia.xxx: 1",
            'robot.yaml:1: body link, inertia: unknown key "xxx"; did you mean "xx"? '
            "known: about, xx, yy, zz, xy, xz, yz, physical",
        ),
        (
            "link.mass.x: 1",
            'robot.yaml:1: set.link.mass.x: "2 kg" has no "x"; a path names keys of mappings; '
            "shorten it",
        ),
        (
            "link.mass: 1 m",
            'robot.yaml:1: body link, mass: "1 m" has the unit "m"; a mass [kg] is expected; '
            "write it in kg",
        ),
    ],
)
def test_an_override_at_fault_is_told_at_the_place_of_the_override(load, override, message):
    with pytest.raises(DescriptionError) as caught:
        load(overrides=override)
    assert str(caught.value) == message


def test_overrides_of_nested_modules_are_handed_down_and_outer_ones_win(load):
    nested = "  - {module: hand, set: {palm.mass: 1 kg, palm.com: [0, 0, 0]}}\n  - module: hand\n"
    module = load(("  - body: link", f"{nested}  - body: link"), overrides="hand.palm.mass: 2 kg")
    first, second = module.items[1:3]
    assert {path: getattr(node, "text", None) for path, node in first.overrides.items()} == {
        "palm.mass": "2 kg",
        "palm.com": None,
    }
    assert second.overrides == {}
    assert instance_names(module.items) == ["hand", "hand-2"]
