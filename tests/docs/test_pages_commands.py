"""Every command of the manual runs, and prints what its page shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.pages import DOCS, Step, blocks, difference, outputs, page_steps

PAGES = [page for page in sorted(DOCS.rglob("*.md")) if page_steps(page)]
COMMANDS = [
    pytest.param(page, k, step, id=f"{page.stem}-{k + 1}")
    for page in PAGES
    for k, step in enumerate(page_steps(page))
]


@pytest.mark.parametrize(("page", "k", "step"), COMMANDS)
def test_a_command_runs_and_prints_what_is_shown(page: Path, k: int, step: Step) -> None:
    code, output = outputs(page)[k]
    assert code == 0, output
    assert difference(step.shown, output) is None, "make docs-outputs writes them again"


def test_the_tutorial_and_each_how_to_page_run_commands() -> None:
    expected = {*(DOCS / "howto").glob("*.md"), *(DOCS / "tutorial").glob("*.md")}
    assert expected <= set(PAGES)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_python_and_yaml_of_these_pages_are_files_that_a_command_uses(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    used = " ".join(step.command for step in page_steps(page)) + "".join(
        block.text for block in blocks(text, "yaml", "python")
    )
    for block in blocks(text, "python", "yaml", "xml"):
        assert block.file is not None, block.text
        assert Path(block.file).stem in used, block.file


@pytest.mark.parametrize(
    ("shown", "output", "found"),
    [
        (["a", "b"], "a\n\nb\n", None),
        (["a", "..."], "a\nb\n", None),
        (["...", "b", "..."], "a\nb\nc\n", None),
        (["t 3.2 us"], "t   1.4 ms\n", None),
        ([], "a\n", None),
        (["a"], "a\nb\n", "not shown: 'b'"),
        (["b"], "a\nb\n", "shown: 'b'; the output has 'a' there"),
        (["a", "b"], "a\n", "shown: 'b'; the output has the end there"),
        (["t 3.2 us"], "s 3.2 us\n", "shown: 't 3.2 us'; the output has 's 3.2 us' there"),
    ],
)
def test_a_difference_is_found(shown: list[str], output: str, found: str | None) -> None:
    assert difference(shown, output) == found
