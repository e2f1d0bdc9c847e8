"""Chains of modules: names, connectors, compound modules, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from modrobust.assembly import load_robot
from modrobust.assembly.modules.catalogue import builtin_robots, catalogue, mounts
from modrobust.errors import DescriptionError, FileError
from modrobust.formats.reader import read_description
from support.small_modules import message


def test_instances_are_named_after_their_module_or_as_they_are_told(load):
    robot = load("chain: [hinge, hinge, {module: hinge, as: wrist}, hinge, oblique]\n")
    assert robot.joint_names == ("hinge.axis", "hinge-2.axis", "wrist.axis", "hinge-3.axis")
    assert (
        " ".join(node.instance for node in robot.modules) == "hinge hinge-2 wrist hinge-3 oblique"
    )
    assert robot.modules[0].joints == ("hinge.axis",)
    assert robot.modules[0].bodies == ("hinge.stator", "hinge.rotor")


ELBOW = """
modrobust: 1
module: elbow
name: A compound of two
source: generic, not a product
product: false
connectors: {in: {type: t}, out: {type: t}}
chain:
  - hinge
  - {module: oblique, mount: 0.3}
  - {module: hinge, as: second, set: {rotor.mass: 2 kg}}
""".replace("  - hinge\n", "  - {module: hinge}\n")


def test_a_compound_module_is_its_parts_under_its_name(load):
    flat = load(
        "chain: [hinge, hinge, {module: oblique, mount: 0.3},"
        " {module: hinge, set: {rotor.mass: 2 kg}}, tool]\n",
        name="flat",
    )
    nested = load("chain: [hinge, elbow, tool]\n", {"elbow": ELBOW}, name="nested")
    assert nested.joint_names == ("hinge.axis", "elbow.hinge.axis", "elbow.second.axis")
    assert "elbow.oblique.tube" in nested.body_names
    np.testing.assert_array_equal(nested.nominal.packed, flat.nominal.packed)
    np.testing.assert_array_equal(nested.after, flat.after)
    np.testing.assert_array_equal(nested.placement, flat.placement)
    assert [child.instance for child in nested.modules[1].children] == [
        "elbow.hinge",
        "elbow.oblique",
        "elbow.second",
    ]


def test_a_set_value_reaches_into_a_compound_module(load):
    robot = load(
        "chain: [{module: elbow, as: e, set: {second.stator.mass: 4 kg}}]\n", {"elbow": ELBOW}
    )
    masses = dict(zip(robot.body_names, robot.nominal.mass, strict=True))
    assert masses["e.second.stator"] == 4.0
    assert masses["e.second.rotor"] == 2.0
    assert masses["e.hinge.stator"] == 1.0


def test_a_payload_can_be_inside_a_compound_module(load):
    text = "chain: [elbow, tool]\npayload: {at: elbow.oblique, mass: 1 kg, com: [0, 0, 0]}\n"
    assert load(text, {"elbow": ELBOW}).body_joints[-1] == 0


def test_an_unknown_module_is_refused_with_those_known(load, monkeypatch, tmp_path):
    monkeypatch.setattr(
        "modrobust.assembly.modules.catalogue.data_directory", lambda kind: tmp_path / "none"
    )
    assert message(load, "chain:\n  - hinge\n  - obligue\n") == (
        'arm.yaml:6: chain[1]: no module named "obligue"; did you mean "oblique"? '
        "known: hinge, oblique, slide, tool (looked in modules/ and the built-in catalogue)"
    )


def test_a_missing_module_directory_is_refused(load, tmp_path):
    (tmp_path / "other.yaml").write_text("modrobust: 1\nrobot: other\nmodules: parts\nchain: [a]\n")
    with pytest.raises(DescriptionError) as caught:
        load_robot("other.yaml")
    assert str(caught.value) == (
        'other.yaml:3: modules: no directory "parts"; directories are relative to this file; '
        "make it or name another"
    )


def test_remarks_of_a_module_are_told_once_with_who_says_them(load):
    noted = TOOL_WITH_NOTE
    robot = load("chain: [hinge, plate, {module: plate, as: other}]\n", {"plate": noted})
    assert robot.notes == (
        "plate: made of cardboard",
        "plate: tolerance without a parameter it applies to: viscous",
    )
    bounds = "set: {sheet.inertia.xx: 0.001 kg m^2 ± 0.0009 kg m^2}"
    robot = load(f"chain: [hinge, plate, {{module: plate, as: other, {bounds}}}]\n")
    assert robot.notes[-1] == (
        "other: body sheet: the bounds of its inertia also hold tensors that no rigid body has"
    )


TOOL_WITH_NOTE = """
modrobust: 1
module: plate
name: A plate
source: generic, not a product
product: false
notes: made of cardboard
tolerance: {viscous: 10%}
connectors: {in: {type: t}, out: {type: t}}
chain:
  - body: sheet
    mass: 1 kg
    com: [0, 0, 0]
    inertia: {xx: 0.001, yy: 0.001, zz: 0.0015}
"""


def compound(name, *inside):
    entries = "".join(f"  - {{module: {module}}}\n" for module in inside)
    return (
        f"modrobust: 1\nmodule: {name}\nname: Test compound\nsource: generic\nproduct: false\n"
        f"connectors: {{in: {{type: t}}, out: {{type: t}}}}\nchain:\n{entries}"
    )


def test_a_module_that_contains_itself_is_refused(load):
    assert message(load, "chain: [loop]\n", {"loop": compound("loop", "hinge", "loop")}) == (
        "modules/loop.yaml:9: chain[1]: module cycle loop -> loop; a module cannot contain itself; "
        "remove this entry"
    )


def test_a_cycle_through_other_modules_is_written_out(load):
    modules = {"a": compound("a", "b"), "b": compound("b", "hinge", "c"), "c": compound("c", "b")}
    assert message(load, "chain: [a]\n", modules) == (
        "modules/c.yaml:8: chain[0]: module cycle b -> c -> b; a module cannot contain itself; "
        "remove this entry"
    )


def test_a_bomb_of_compound_modules_is_refused(load):
    modules = {f"m{k}": compound(f"m{k}", *[f"m{k + 1}"] * 10) for k in range(6)}
    modules["m6"] = compound("m6", "hinge")
    assert "more than 10000 modules in all" in message(load, "chain: [m0]\n", modules)


def plug(name, into, out="{type: t}"):
    return (
        f"modrobust: 1\nmodule: {name}\nname: Test plug\nsource: generic\nproduct: false\n"
        f"connectors: {{in: {into}, out: {out}}}\nchain:\n"
        "  - {frame: f, span: {xyz: [0, 0, 0]}}\n"
    )


RULE = "compatible connectors have the same type, the same size, and genders m and f or n and n"
SEE = 'see "modrobust modules" for what fits'


@pytest.mark.parametrize(
    ("into", "found", "why"),
    [
        ("{type: u}", "u, gender n", "the types differ"),
        ("{type: t, size: 2}", "t, size 2, gender n", "the sizes differ"),
        ("{type: t, gender: f}", "t, gender f", "the genders do not fit"),
    ],
)
def test_modules_that_do_not_mate_are_refused_with_both_connectors(load, into, found, why):
    chain = "chain:\n  - hinge\n  - plug\n"
    assert message(load, chain, {"plug": plug("plug", into)}) == (
        f'arm.yaml:6: chain[1]: "plug" (in: {found}) does not mount on "hinge" (out: t, gender n)'
        f": {why}; {RULE}; {SEE}"
    )


@pytest.mark.parametrize(("out", "into"), [("m", "f"), ("f", "m"), ("n", "n")])
def test_opposite_genders_and_genderless_ones_mount(load, out, into):
    modules = {
        "one": plug("one", "{type: t}", f"{{type: v, size: 60, gender: {out}}}"),
        "two": plug("two", f"{{type: v, size: 60, gender: {into}}}"),
    }
    assert load("chain: [hinge, one, two]\n", modules).n == 1


def test_nothing_can_be_mounted_on_a_tool(load):
    assert message(load, "chain: [hinge, tool, hinge]\n") == (
        'arm.yaml:4: chain[2]: "hinge" cannot be mounted on "tool": "tool" has no out connector; '
        f"{RULE}; {SEE}"
    )


@pytest.mark.parametrize("side", ["in", "out"])
def test_a_mount_between_the_steps_of_a_clocking_is_refused(load, side):
    one = plug("one", "{type: t}", "{type: v, clocking: 90 deg}" if side == "out" else "{type: v}")
    two = plug("two", "{type: v, clocking: 90 deg}" if side == "in" else "{type: v}")
    modules = {"one": one, "two": two}
    for good in ("0", "90 deg", "-pi/2", "540 deg"):
        assert load(f"chain: [hinge, one, {{module: two, mount: {good}}}]\n", modules).n == 1
    text = "chain: [hinge, one, {module: two, mount: 45 deg}]\n"
    assert message(load, text, modules) == (
        'arm.yaml:4: chain[2].mount: "two" (in: v, gender n) on "one" (out: v, gender n): 45 deg '
        f"is not a multiple of 90 deg, the clocking of the {side} connector; give one of its "
        "multiples"
    )


def test_two_instances_of_one_name_are_refused(load):
    text = "chain:\n  - {module: hinge, as: a}\n  - oblique\n  - {module: hinge, as: a}\n"
    assert message(load, text) == (
        'arm.yaml:7: chain[2]: the instance name "a" is taken (line 5); names in a chain differ; '
        'give this one another with "as:"'
    )


def test_a_module_beside_the_robot_comes_before_a_built_in_one_of_its_name(load):
    own = TOOL_WITH_NOTE.replace("module: plate", "module: schunk-gripper")
    robot = load("chain: [hinge, schunk-gripper]\n", {"schunk-gripper": own})
    assert robot.body_names[-1] == "schunk-gripper.sheet"


def test_the_catalogue_of_a_directory_is_sorted_and_says_what_mounts(load):
    load("chain: [hinge]\n", {"plug": plug("plug", "{type: t}", "{type: v, gender: m}")})
    found = catalogue(["modules"])
    assert [module.id for module in found] == ["hinge", "oblique", "plug", "slide", "tool"]
    everything = ("hinge", "oblique", "plug", "slide", "tool")
    assert mounts(found) == {
        "hinge": everything,
        "oblique": everything,
        "plug": (),
        "slide": everything,
        "tool": (),
    }


def test_the_catalogue_of_no_directory_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FileError) as caught:
        catalogue(["none"])
    assert str(caught.value) == "none: no such directory; give a directory with module files"


def test_built_in_robots_are_found_by_name():
    robots = builtin_robots()
    assert "lwa4p-paper" in robots
    assert all(path.is_file() for path in robots.values())


def test_a_module_file_is_read_once_however_often_it_is_mounted(load, monkeypatch):
    read = []

    def counting(path):
        read.append(Path(path).stem)
        return read_description(path)

    monkeypatch.setattr("modrobust.formats.module.read_description", counting)
    robot = load(
        "chain: [hinge, {module: hinge, set: {rotor.mass: 2 kg}}, hinge, "
        "{module: hinge, set: {rotor.mass: 3 kg}}]\n"
    )
    assert robot.nominal.mass.tolist() == [1.0, 0.7, 1.0, 2.0, 1.0, 0.7, 1.0, 3.0]
    assert read == ["hinge"]
