"""The README is true: every command runs, what it shows is what comes, every link leads somewhere.

See `support.pages` for how a block is read, and what is compared.
"""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from support.command_line import environment, run_in
from support.pages import PYTHON, blocks, difference, page_steps
from support.paths import ROOT

README = ROOT / "README.md"
TEXT = README.read_text(encoding="utf-8")


def output_of(command: str) -> str:
    with TemporaryDirectory() as folder:
        result = run_in(Path(folder), *shlex.split(command)[1:])
    assert (result.returncode, result.stderr) == (0, ""), result.stderr + result.stdout
    return result.stdout


COMMANDS = [(step.command, step.shown) for step in page_steps(README)]


@pytest.mark.parametrize(("command", "shown"), COMMANDS, ids=[c for c, _ in COMMANDS])
def test_every_command_of_the_readme_runs_and_prints_what_is_shown(
    command: str, shown: list[str]
) -> None:
    program, *arguments = shlex.split(command)
    if program == "make":
        targets = re.findall(r"^(\w+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
        assert set(arguments) <= set(targets)
        return
    assert program == "modrobust"
    assert difference(shown, output_of(command)) is None


@pytest.mark.parametrize(
    "block",
    [block.text for block in blocks(TEXT, "python")],
    ids=lambda block: block.partition("\n")[0],
)
def test_every_python_block_of_the_readme_runs(block: str, tmp_path: Path) -> None:
    result = subprocess.run(
        [PYTHON, "-W", "error", "-c", block],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (result.returncode, result.stderr) == (0, "")


def test_every_link_of_the_readme_leads_to_a_file_or_a_heading() -> None:
    headings = re.findall(r"^#+ (.+)$", TEXT, re.MULTILINE)
    anchors = {re.sub(r"[^\w\- ]", "", h).lower().replace(" ", "-") for h in headings}
    for target in re.findall(r"\]\(([^)]+)\)", TEXT):
        if target.startswith("#"):
            assert target[1:] in anchors
        else:
            assert (ROOT / target).is_file(), target
