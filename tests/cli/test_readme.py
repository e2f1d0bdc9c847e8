"""The README is true: every command runs, what it shows is what comes, every link leads somewhere.

A ``yaml`` block that begins with ``# NAME`` is the file NAME for all commands. Output lines that
hold a time depend on the machine and are not compared; ``...`` stands for what is left out.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from support.command_line import EXECUTABLE, environment, run_in
from support.paths import ROOT

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
PYTHON = str(Path(EXECUTABLE).with_name("python")) if EXECUTABLE else sys.executable
A_TIME = re.compile(r"\d (us|ms)\b")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


def shown_commands() -> list[tuple[str, list[str]]]:
    """Each command of the console blocks, with the output that is shown for it."""
    found: list[tuple[str, list[str]]] = []
    for block in blocks("console"):
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line.removeprefix("$ "), []))
            else:
                found[-1][1].append(line)
    return found


def write_files(folder: Path) -> None:
    for block in blocks("yaml"):
        first = block.partition("\n")[0]
        (folder / first.removeprefix("# ")).write_text(block, encoding="utf-8")


@cache
def output_of(command: str) -> str:
    with TemporaryDirectory() as folder:
        write_files(Path(folder))
        result = run_in(Path(folder), *shlex.split(command)[1:])
    assert (result.returncode, result.stderr) == (0, ""), result.stderr + result.stdout
    return result.stdout


COMMANDS = shown_commands()


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
    lines = iter(output_of(command).splitlines())
    for line in shown:
        if line and line != "..." and not A_TIME.search(line):
            assert line in lines, f"not in the output, or not in this order: {line}"


def test_the_table_of_the_paper_s_robot_is_what_the_runs_give() -> None:
    rows = re.findall(r"^\| `(\w+)` \| (\d) \| (.+) \|$", TEXT, re.MULTILINE)
    assert [row[:2] for row in rows] == [(b, s) for s in "12" for b in ("ianea", "hull")]
    for bound, scenario, figures in rows:
        command = f"modrobust simulate lwa4p-paper --scenario {scenario}"
        text = output_of(command if bound == "hull" else f"{command} --bound ianea")
        found = [
            re.search(pattern, text)
            for pattern in (
                r"violations +(\d+) of",
                r"epsilon entered at +(\S+ s) for good",
                r"rho mean +(\S+),",
                r"rho max +(\S+)\n",
            )
        ]
        assert [match and match[1] for match in found] == figures.split(" | ")


@pytest.mark.parametrize("block", blocks("python"), ids=lambda block: block.partition("\n")[0])
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
