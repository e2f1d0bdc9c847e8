"""Mappings on one line."""

from __future__ import annotations

import pytest

from modrobust.errors import ValueRangeError
from modrobust.formats.inline import parse_inline
from modrobust.formats.nodes import ListNode, MapNode, Node


def plain(node: Node) -> object:
    if isinstance(node, MapNode):
        return {key: plain(value) for key, value in node.entries.items()}
    if isinstance(node, ListNode):
        return [plain(item) for item in node.items]
    return node.text


def test_a_payload_on_one_line_reads_as_in_a_file() -> None:
    text = "mass=[0 kg, 2 kg], com=[0, 0, [20 mm, 80 mm]], inertia={xx: 1 ± 2%, yy=2}, at=tool0"
    assert plain(parse_inline(text, "payload")) == {
        "mass": ["0 kg", "2 kg"],
        "com": ["0", "0", ["20 mm", "80 mm"]],
        "inertia": {"xx": "1 ± 2%", "yy": "2"},
        "at": "tool0",
    }


def test_tolerances_need_no_blanks() -> None:
    assert plain(parse_inline("mass=5%,com=5mm", "tolerance")) == {"mass": "5%", "com": "5mm"}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("", "nothing is written"),
        ("mass", '"mass" is no key=value'),
        ("mass=1,", '"" is no key=value'),
        ("mass=1,mass=2", '"mass" is given twice'),
        ("com=[1, 2", 'no "]" where it is expected'),
        ("com=1]", '"]" without its other half'),
        ("a=" + "[" * 12, "more than 8 brackets deep"),
        ("a=" + "1" * 5000, "5002 characters; it has at most 4096"),
    ],
)
def test_what_is_no_mapping_is_refused(text: str, found: str) -> None:
    with pytest.raises(ValueRangeError) as caught:
        parse_inline(text, "--x")
    assert found in str(caught.value)
    assert str(caught.value).startswith("--x: ")
