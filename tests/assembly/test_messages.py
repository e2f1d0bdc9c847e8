"""The library speaks of arguments and keys; options are words of the command line alone."""

from __future__ import annotations

import ast
import re

import pytest

from modrobust.cli.wording import as_options, named_as_options
from modrobust.errors import DescriptionError, ModrobustError, ValueRangeError
from support.paths import ROOT

PACKAGE = ROOT / "src" / "modrobust"
OPTION = re.compile(r"(?<![\w-])--[a-z]")
OTHER_PROGRAMS = {"bench/peers/compile.py"}  # what it says to a compiler and pkg-config


def messages(text: str) -> list[str]:
    """The texts of a module that are not docstrings; pip's own options are left out."""
    tree = ast.parse(text)
    plain = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in plain
        if "pip install" not in node.value
    ]


def test_no_message_of_the_library_names_an_option() -> None:
    found = [
        f"{path.relative_to(PACKAGE)}: {text}"
        for path in PACKAGE.rglob("*.py")
        if "cli" not in path.relative_to(PACKAGE).parts
        and str(path.relative_to(PACKAGE)) not in OTHER_PROGRAMS
        for text in messages(path.read_text(encoding="utf-8"))
        if OPTION.search(text)
    ]
    assert found == []


def test_the_check_finds_an_option_in_a_message_and_leaves_docstrings() -> None:
    source = '"""Takes --lock."""\nraise ValueError(f"use --lock {name}")\nx = "pip install --x"\n'
    assert [text for text in messages(source) if OPTION.search(text)] == ["use --lock "]


@pytest.mark.parametrize(
    ("said", "option"),
    [
        ("freeze it (lock: {turn: 0})", "freeze it (--lock turn=0)"),
        (
            "freeze one of them (lock: {a.b: VALUE} or lock: {c: VALUE})",
            "freeze one of them (--lock a.b=VALUE or --lock c=VALUE)",
        ),
        ("take the part behind it with base_link: arm", "take the part behind it with --base arm"),
        ('inertia_about "com" or "frame" overrides it', "--inertia-about com|frame overrides it"),
        ('import it with inertia_about "com"', "import it with --inertia-about com"),
        ('give a tolerance such as "mass=5%"', 'give --tolerance "mass=5%"'),
        ("or save a video of it", "or make a video with --video run.mp4"),
        ("nothing of that", "nothing of that"),
    ],
)
def test_the_command_line_says_options(said: str, option: str) -> None:
    assert as_options(said) == option


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (DescriptionError("lock", None, "lock.a", "no joint"), "--lock: a: no joint"),
        (DescriptionError("tip", None, "tip_link", "no link"), "--tip: no link"),
        (DescriptionError("lock", 3, "x", "y"), "lock:3: x: y"),  # a file of that name
        (DescriptionError("a.urdf", 3, "x", "with base_link: b"), "a.urdf:3: x: with --base b"),
        (ValueRangeError("lock: so"), "--lock: so"),
        (ValueRangeError("lock.a[0]: so"), "--lock.a[0]: so"),
        (ValueRangeError("other: so"), "other: so"),
    ],
)
def test_errors_name_options(error: ModrobustError, message: str) -> None:
    with (
        pytest.raises(type(error), match=f"^{re.escape(message)}$"),
        named_as_options("lock", "tip", remedies=True),
    ):
        raise error
