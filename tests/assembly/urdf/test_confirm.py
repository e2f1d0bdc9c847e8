"""The second reader: what yourdfpy understands differently is refused."""

from __future__ import annotations

import pytest

from modrobust.assembly.urdf.confirm import confirm
from modrobust.assembly.urdf.reader import read_description
from modrobust.assembly.urdf.xml import parse_xml
from modrobust.errors import DescriptionError
from support.urdf_texts import INERTIAL, joint, link, robot, two_links

ORIGINAL = two_links()
CHANGES = {
    "mass": (('value="2"', 'value="2.0000001"'), "link arm"),
    "tensor": (('iyz="0"', 'iyz="1e-9"'), "link arm"),
    "place of the inertial": (('xyz="0 0 0.1"', 'xyz="0 0 0.1001"'), "link arm"),
    "no inertial": ((INERTIAL, ""), "link arm"),
    "axis": (('axis xyz="0 0 1"', 'axis xyz="0 0 -1"'), "joint turn"),
    "origin": (('origin xyz="0 0 0.3"', 'origin xyz="0 0 0.3" rpy="0 1e-6 0"'), "joint turn"),
    "limit": (('upper="2.5"', 'upper="2.6"'), "joint turn"),
    "type": (('"revolute"', '"continuous"'), "joint turn"),
}


def test_the_same_text_is_the_same_robot() -> None:
    tree = parse_xml(ORIGINAL.encode(), "a.urdf")
    confirm(read_description(tree), tree)


@pytest.mark.parametrize("what", CHANGES)
def test_a_difference_is_refused_with_its_place(what: str) -> None:
    (old, new), owner = CHANGES[what]
    assert old in ORIGINAL
    ours = read_description(parse_xml(ORIGINAL.encode(), "a.urdf"))
    with pytest.raises(DescriptionError) as caught:
        confirm(ours, parse_xml(ORIGINAL.replace(old, new).encode(), "a.urdf"))
    assert caught.value.field == owner
    assert "yourdfpy, a second reader, understands this differently" in str(caught.value)


def test_a_robot_with_fewer_parts_is_refused() -> None:
    more = robot(link("base", ""), joint("turn", "base", "arm"), link("arm"), link("tip"),
                 joint("end", "arm", "tip", "fixed", ""))  # fmt: skip
    ours = read_description(parse_xml(more.encode(), "a.urdf"))
    with pytest.raises(DescriptionError, match="link tip"):
        confirm(ours, parse_xml(ORIGINAL.encode(), "a.urdf"))
