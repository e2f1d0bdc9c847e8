"""Several payloads of one robot: the figures of each, and the box that holds them all."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modrobust import build_robot, load_robot
from modrobust.dynamics import inverse_dynamics_bounds
from modrobust.errors import DescriptionError, ModrobustError
from modrobust.formats import load_assembly
from support.formats.format_samples import ASSEMBLY, MODULE

OWN = "payload: {mass: [0 kg, 2 kg], com: [0, 0, [20 mm, 80 mm]]}"
BOX = "{mass: 2 kg ± 0.5 kg, com: [0, 0, [40 mm, 80 mm]], size: [0.1, 0.1, 0.2]}"
TOOL = "{mass: 0.5 kg, com: [0, 10 mm, 20 mm], inertia: {xx: 1e-3, yy: 1e-3, zz: 5e-4}}"


@pytest.fixture(autouse=True)
def _in_a_directory_of_modules(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the messages name the file as it was given
    (tmp_path / "arm.yaml").write_text(MODULE, encoding="utf-8")


def at(place):
    return TOOL.replace("{", f"{{at: {place}, ", 1)


def load(text, line="payloads: ", loader=load_assembly):
    assert OWN in ASSEMBLY
    with open("r.yaml", "w", encoding="utf-8") as file:
        file.write(ASSEMBLY.replace(OWN, f"{line}{text}"))
    return loader("r.yaml")


def test_the_box_is_the_hull_of_the_payloads():
    assembly = load(f"{{box: {BOX}, tool: {TOOL}}}")
    box, tool = assembly.payloads["box"], assembly.payloads["tool"]
    hull = assembly.payload
    assert (hull.mass.lo, hull.mass.hi) == (tool.mass.lo, box.mass.hi) == (0.5, 2.5)
    assert (hull.com[1].lo, hull.com[1].hi) == (0.0, 0.01)
    assert (hull.com[2].lo, hull.com[2].hi) == (tool.com[2].lo, box.com[2].hi)
    for k in range(6):
        assert hull.inertia[k].lo == min(box.inertia[k].lo, tool.inertia[k].lo)
        assert hull.inertia[k].hi == max(box.inertia[k].hi, tool.inertia[k].hi)


def test_the_nominal_payload_is_half_the_lightest_and_half_the_heaviest():
    hull = load(f"{{box: {BOX}, tool: {TOOL}, mid: {TOOL.replace('0.5', '1', 1)}}}").payload
    assert hull.mass.nominal == pytest.approx((2 + 0.5) / 2)
    assert hull.com[2].nominal == pytest.approx((2 * 0.06 + 0.5 * 0.02) / 2.5)
    # Of the box xx = m (b^2 + c^2) / 12 = 2 (0.01 + 0.04) / 12.
    assert hull.inertia[0].nominal == pytest.approx((2 * 0.05 / 12 + 1e-3) / 2)


@pytest.mark.parametrize("nothing", ["none", "{mass: 0 kg, com: [1, 1, 1]}"])
def test_no_body_has_no_mass_and_widens_no_centre_of_mass(nothing):
    assembly = load(f"{{empty: {nothing}, box: {BOX}}}")
    empty, hull = assembly.payloads["empty"], assembly.payload
    assert (empty.mass.lo, empty.mass.hi, hull.mass.lo) == (0.0, 0.0, 0.0)
    assert hull.com == assembly.payloads["box"].com
    assert empty.com[2].lo == empty.com[2].hi == 0.06
    assert not empty.assumed_point
    assert hull.inertia[0].lo == 0.0
    assert hull.mass.nominal == 1.0


def test_one_payload_of_all_may_say_where_they_are_carried():
    assembly = load(f"{{empty: none, box: {BOX}, tool: {at('arm')}}}")
    assert {body.at for body in (assembly.payload, *assembly.payloads.values())} == {"arm"}


def test_a_robot_has_the_figures_of_each_payload_inside_its_own_box():
    robot = load(f"{{empty: none, box: {BOX}}}", loader=load_robot)
    assert list(robot.payloads) == ["empty", "box"]
    assert robot.body_names[-1] == "payload"
    for nominal, lower, upper in robot.payloads.values():
        assert (robot.lower.packed <= lower.packed).all()
        assert (lower.packed <= nominal.packed).all()
        assert (nominal.packed <= upper.packed).all()
        assert (upper.packed <= robot.upper.packed).all()
    (empty, *_), (box, lower, upper) = robot.payloads["empty"], robot.payloads["box"]
    assert (empty.mass[-1], box.mass[-1], lower.mass[-1], upper.mass[-1]) == (0.0, 2.0, 1.5, 2.5)
    assert (empty.mass[:-1] == box.mass[:-1]).all()
    copy = pickle.loads(pickle.dumps(robot))
    assert (copy.payloads["box"][2].packed == upper.packed).all()


def test_the_bounds_of_the_robot_hold_those_with_each_payload():
    robot = load(f"{{empty: none, box: {BOX}, tool: {TOOL}}}", loader=load_robot)
    q, dq, ddq = np.array([0.3, -0.7]), np.array([1.0, 2.0]), np.array([3.0, -1.0])
    lo, hi = inverse_dynamics_bounds(robot, q, dq, dq, ddq)
    for nominal, lower, upper in robot.payloads.values():
        one = replace(robot, nominal=nominal, lower=lower, upper=upper, payloads={})
        part_lo, part_hi = inverse_dynamics_bounds(one, q, dq, dq, ddq)
        assert (lo <= part_lo).all()
        assert (part_hi <= hi).all()
        assert (part_hi - part_lo < hi - lo).any()


def test_an_option_stands_over_the_payloads_of_a_file():
    load(f"{{empty: none, box: {BOX}}}")
    robot = load_robot("r.yaml", payload="mass=1, com=[0, 0, 0]")
    assert robot.payloads == {}
    assert robot.upper.mass[-1] == 1.0


def test_a_robot_in_python_takes_payloads():
    payloads: dict[str, Any] = {
        "empty": "none",
        "box": {"mass": 2, "com": [0, 0, 0.05], "size": [0.1, 0.1, 0.1]},
    }
    robot = build_robot("two", ["arm"], modules=".", payloads=payloads)
    assert robot.payloads["box"][0].mass[-1] == 2.0


def test_a_point_mass_among_payloads_is_remarked_by_name():
    robot = load("{empty: none, ball: {mass: 1, com: [0, 0, 0]}}", loader=load_robot)
    assert [note for note in robot.notes if "point mass" in note] == [
        "payload ball: taken as a point mass, since neither its inertia nor its size is given"
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{}", "payloads: nothing; payloads have names; write name: {mass, com}"),
        ("[none]", "payloads: a list; a mapping is expected; write key: value"),
        (
            "{box: nothing}",
            'payloads.box: "nothing"; a payload is none or a mapping with mass and com; write one',
        ),
        ("{box: {mass: 1}}", 'payloads.box: no "com"; this key is required; add com'),
        ("{box: {mass: -1, com: [0, 0, 0]}}", "payloads.box.mass: -1 "),
        (
            f"{{a: {at('arm')}, b: {at('tool')}}}",
            'payloads.b.at: "tool" where payload a has "arm"; payloads are figures of one body at '
            "one place; write the same in all",
        ),
        (
            f"{{a: {TOOL}, b: {TOOL.replace('xx', 'about: frame, xx')}}}",
            'payloads.b.inertia.about: "frame" where payload a has "com"; payloads are figures of ',
        ),
        (
            f"{{a: {TOOL}}}\npayload: {TOOL}",
            "payloads: beside payload; a robot has one or several; remove one of the two",
        ),
    ],
)
def test_payloads_are_refused_for(text, message):
    with pytest.raises(DescriptionError) as caught:
        load(text)
    assert str(caught.value).startswith(f"r.yaml:8: {message}")


def test_a_robot_that_carries_nothing_must_still_have_inertia():
    light = {"xx": 0, "yy": 0, "zz": 0, "physical": "as-written"}
    chain: list[Any] = [
        {"joint": "axis", "type": "revolute"},
        {"body": "rod", "mass": 1, "com": [0, 0, 0], "inertia": light},
    ]
    box = {"mass": 1, "com": [0.1, 0, 0]}
    assert build_robot("one", chain, payloads={"a": box, "b": {**box, "mass": 2}}).n == 1
    with pytest.raises(DescriptionError, match="nominal parameters of payload empty, drives"):
        build_robot("one", chain, payloads={"box": box, "empty": "none"})


def test_figures_outside_the_box_of_a_robot_are_refused():
    robot = load(f"{{empty: none, box: {BOX}}}", loader=load_robot)
    with pytest.raises(ModrobustError, match=r'payloads: figures of "box" are not in order or not'):
        replace(robot, upper=robot.payloads["empty"][2], nominal=robot.lower)
