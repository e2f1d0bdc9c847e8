"""The tables of docs/architecture.md name functions and tests that are there."""

from __future__ import annotations

import re

from support.pages import DOCS
from support.paths import ROOT

PAGE = (DOCS / "architecture.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "src" / "modrobust"


def test_functions_of_algorithm_1_are_in_the_kernel_and_in_the_reference() -> None:
    section = PAGE.split("### Where is line 29")[1].split("\n### ")[0]
    lines, tests = section.split("| what is tested | test |")
    kernel = "".join(path.read_text(encoding="utf-8") for path in PACKAGE.glob("kernel/*.c"))
    reference = (PACKAGE / "reference.py").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \**\d.*\|$", lines, re.MULTILINE)
    assert len(rows) >= 10
    for row in rows:
        *_, nominal, intervals, readable = (cell.strip() for cell in row.strip("|").split("|"))
        for name in re.findall(r"`(\w+)`", nominal + intervals):
            assert re.search(rf"\b{name}\(", kernel), name
        assert f"def {readable.strip('`')}(" in reference
    found = re.findall(r"`(tests/[\w/]+\.py)`(?:, `(\w+)`)?", tests)
    assert found
    for path, name in found:
        text = (ROOT / path).read_text(encoding="utf-8")
        assert not name or f"def {name}(" in text, name


def test_line_29_is_marked_in_the_code() -> None:
    for name in ("kernel/mr_newton_euler.c", "kernel/mr_ianea.c", "reference.py"):
        text = (PACKAGE / name).read_text(encoding="utf-8")
        assert re.search(r"(?:/\*|#) A1:29\b", text), name


def test_the_example_of_a_joint_field_is_in_every_file_of_the_recipe() -> None:
    section = PAGE.split("### How do I add a field")[1].split("\n### ")[0]
    for path in re.findall(r"`((?:[a-z]+/)+\w+\.(?:py|cpp))`", section):
        if path == "assembly/urdf/items.py":  # a URDF has no Coulomb speed
            continue
        home = next(home for home in (ROOT, PACKAGE) if (home / path).is_file())
        assert "coulomb_speed" in (home / path).read_text(encoding="utf-8"), path
