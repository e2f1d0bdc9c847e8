"""Reading files: what is no readable description, and what the tree of one holds."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from modrobust.errors import DescriptionError, FileError
from modrobust.formats import load_module
from modrobust.formats.items import BodyItem, JointItem
from modrobust.formats.json_reader import parse_json
from modrobust.formats.nodes import ListNode, MapNode, ScalarNode
from modrobust.formats.reader import _parse_yaml, read_description
from support.formats.format_samples import MODULE

TOP = 'a description is a mapping that starts with "modrobust: 1"; see docs/reference/formats.md'


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def _message(name):
    with pytest.raises((FileError, DescriptionError)) as caught:
        read_description(name)
    return str(caught.value)


def test_a_missing_file():
    assert _message("arm.yaml") == "arm.yaml: no such file; check the path"


def test_a_missing_directory():
    expected = 'parts/arm.yaml: no such file; there is no directory "parts"; check the path'
    assert _message("parts/arm.yaml") == expected


def test_a_file_name_that_is_none():
    assert _message("a\0.yaml") == "a\\0.yaml: not a file name; check the path"


def test_a_directory(tmp_path):
    (tmp_path / "arm.yaml").mkdir()
    assert _message("arm.yaml") == (
        "arm.yaml: is a directory; a description is one file; name the file in it"
    )


def test_a_wrong_suffix(tmp_path):
    (tmp_path / "arm.urdf").write_text(MODULE, encoding="utf-8")
    assert _message("arm.urdf") == (
        'arm.urdf: suffix ".urdf"; a description ends in .yaml, .yml or .json; rename or convert it'
    )
    (tmp_path / "arm").write_text(MODULE, encoding="utf-8")
    assert _message("arm") == (
        "arm: no suffix; a description ends in .yaml, .yml or .json; rename or convert it"
    )


def test_a_binary_file(tmp_path):
    (tmp_path / "arm.yaml").write_bytes(b"a: \0\1\2")
    assert _message("arm.yaml") == (
        "arm.yaml: a binary file (it holds NUL bytes); a description is UTF-8 text"
    )
    (tmp_path / "arm.yaml").write_bytes(b"name: \xff\xfe")
    assert _message("arm.yaml") == (
        "arm.yaml: not UTF-8 text (byte 6); save the description as UTF-8 text"
    )


@pytest.mark.parametrize("content", ["", " \n\n"])
def test_an_empty_file(tmp_path, content):
    (tmp_path / "arm.yaml").write_text(content, encoding="utf-8")
    assert _message("arm.yaml") == (
        'arm.yaml: empty; a description starts with "modrobust: 1"; see docs/reference/formats.md'
    )


def test_a_file_that_is_too_large(tmp_path):
    (tmp_path / "arm.yaml").write_text("# x\n" * (1 << 18) + "a: 1\n", encoding="utf-8")
    assert _message("arm.yaml") == (
        "arm.yaml: more than 1 MiB; a description has at most 1 MiB; split it"
    )


def test_a_yaml_bomb_does_not_expand(tmp_path):
    levels = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    levels += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 30)]
    (tmp_path / "arm.yaml").write_text("\n".join(levels), encoding="utf-8")
    assert _message("arm.yaml") == (
        'arm.yaml:1: a0: anchor "&a0"; aliases and anchors are not allowed, because they can '
        "expand without end; write the value out where it is needed"
    )


JSON_CASES = [
    ('{"a": NaN}', "1: not JSON: NaN is not a number; write a finite number"),
    ('{"a":\n -Infinity}', "2: not JSON: -Infinity is not a number; write a finite number"),
    (
        '{"a": 1,\n}',
        "1: not JSON: Illegal trailing comma before end of object (column 8); "
        "correct the text there",
    ),
    (
        '{"a": 1,\n "a": 2}',
        '2: a: duplicate key "a" (first on line 1); a key stands once; remove one of them',
    ),
    ("{} {}", "1: not JSON: Extra data (column 4); correct the text there"),
    ("[1]", f"1: a list at the top level; {TOP}"),
    (
        "{" + '"a":{' * 50_000,
        "1: nested more than 32 levels deep; a description has at most 32 levels; "
        "check the brackets",
    ),
    (
        "{" + ",".join(f'"k{i}":1' for i in range(20_000)) + "}",
        "1: more than 20000 keys and values; a description has at most 20000; split it",
    ),
]


@pytest.mark.parametrize(("text", "message"), JSON_CASES, ids=range(len(JSON_CASES)))
def test_json_that_is_refused(tmp_path, text, message):
    (tmp_path / "arm.json").write_text(text, encoding="utf-8")
    if "trailing comma" in message:  # worded differently before Python 3.13
        older = "Expecting property name enclosed in double quotes (column 1)"
        assert _message("arm.json") in (
            f"arm.json:{message}",
            f"arm.json:2: not JSON: {older}; correct the text there",
        )
    else:
        assert _message("arm.json") == f"arm.json:{message}"


def test_scalars_stay_the_text_that_was_written():
    text = "a: 5e-5\nb: 160:1\nc: no\nd: 0x10\ne: 'x: y'\nf: 1_000\ng: 2001-01-01\nh: ~\n"
    tree = _parse_yaml(text, "x.yaml")
    assert [node.text for node in tree.entries.values() if isinstance(node, ScalarNode)] == [
        "5e-5", "160:1", "no", "0x10", "x: y", "1_000", "2001-01-01", "~",
    ]  # fmt: skip
    assert [node.where.line for node in tree.entries.values()] == [*range(1, 9)]


def test_an_empty_value_stands_on_the_line_of_its_key():
    tree = _parse_yaml("a:\n\n\nb: 1\n", "x.yaml")
    assert tree.entries["a"].where.line == 1


def test_json_gives_the_same_tree_as_yaml(tmp_path):
    data = {"a": [1, 2.5e-3, True, None], "b": {"c": '± \u00e9 \\/ " \n'}, "d": []}
    text = json.dumps(data, indent="\t")
    assert _shape(parse_json(text, "x.json")) == {
        "a": ["1", "0.0025", "true", "null"],
        "b": {"c": '± \u00e9 \\/ " \n'},
        "d": [],
    }
    assert parse_json(text, "x.json").entries["b"].where.line == 8


def test_a_module_in_json_says_what_it_says_in_yaml(tmp_path):
    (tmp_path / "arm.yaml").write_text(MODULE, encoding="utf-8")
    tree = _shape(read_description("arm.yaml"))
    (tmp_path / "json").mkdir()
    (tmp_path / "json" / "arm.json").write_text(json.dumps(tree, indent="\t"), encoding="utf-8")
    joint, body = load_module("arm.yaml").items[:2]
    same_joint, same_body = load_module("json/arm.json").items[:2]
    assert isinstance(joint, JointItem)
    assert isinstance(same_joint, JointItem)
    assert joint.rotor_inertia == same_joint.rotor_inertia
    assert isinstance(body, BodyItem)
    assert isinstance(same_body, BodyItem)
    assert body.inertia == same_body.inertia
    assert body.span == same_body.span
    assert same_body.where.line is not None
    assert same_body.where.line > 20


@given(st.text(alphabet="ab:-[]{},&*!|>'\"%#\n \t0?", max_size=60))
@settings(max_examples=150, deadline=None, database=None, derandomize=True)
def test_any_text_is_read_or_refused_in_one_line(text):
    for parse in (_parse_yaml, parse_json):
        try:
            tree = parse(text, "x")
        except DescriptionError as error:
            assert "\n" not in str(error)  # noqa: PT017 - both outcomes are fine
        else:
            assert isinstance(tree, MapNode)


def _shape(node):
    if isinstance(node, ScalarNode):
        return node.text
    if isinstance(node, ListNode):
        return [_shape(item) for item in node.items]
    return {key: _shape(value) for key, value in node.entries.items()}
