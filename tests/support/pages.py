"""Pages whose commands are run: what a ``console`` block shows is what comes.

A block may name the file that it is, by ``title="NAME"`` on its fence or by a first line
``# NAME``; files are written before the first command runs. A line ``$ COMMAND`` is run, all those
of a page one after the other in one folder; what follows it is the output, both streams, as a
terminal shows it. ``...`` stands for lines that are left out. Lines that hold a time depend on the
machine: only that such a line is there is compared.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from support.command_line import COMMAND, EXECUTABLE, environment
from support.paths import ROOT

DOCS = ROOT / "docs"
PYTHON = str(Path(EXECUTABLE).with_name("python")) if EXECUTABLE else sys.executable

_FENCE = re.compile(r"^```(\w+)([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_TITLE = re.compile(r'title="([^"]+)"')
_FIRST_LINE = re.compile(r"# (\S+\.\w+)\n")
_A_TIME = re.compile(r"\d (us|ms)\b")
_SNIPPET = re.compile(r'^--8<-- "([^"]+)"$', re.MULTILINE)
_LEFT_OUT = "..."


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, the file that it is (or None), its text and where that is."""

    language: str
    file: str | None
    text: str
    span: tuple[int, int]


@dataclass
class Step:
    """A command of a page with the lines that the page shows for it."""

    command: str
    shown: list[str] = field(default_factory=list)


def blocks(text: str, *languages: str) -> list[Block]:
    """Fenced blocks of a page, in its order; of all languages, or of some."""
    found = []
    for match in _FENCE.finditer(text):
        language, options, body = match.groups()
        title = _TITLE.search(options)
        first = _FIRST_LINE.match(body) if language == "yaml" else None
        file = title[1] if title else first[1] if first else None
        if not languages or language in languages:
            found.append(Block(language, file, _SNIPPET.sub(_included, body), match.span(3)))
    return found


def _included(snippet: re.Match[str]) -> str:
    """The file that a page includes."""
    return (ROOT / snippet[1]).read_text(encoding="utf-8").rstrip("\n")


def steps(block: Block) -> list[Step]:
    """The commands of one ``console`` block; a command goes on after a backslash."""
    found: list[Step] = []
    open_ended = False
    for line in block.text.splitlines():
        if open_ended:
            found[-1].command += f"\n{line}"
        elif line.startswith("$ "):
            found.append(Step(line.removeprefix("$ ")))
        else:
            found[-1].shown.append(line)
        open_ended = (open_ended or line.startswith("$ ")) and line.endswith("\\")
    return found


def page_steps(path: Path) -> list[Step]:
    """All commands of a page."""
    text = path.read_text(encoding="utf-8")
    return [step for block in blocks(text, "console") for step in steps(block)]


def write_files(text: str, folder: Path) -> None:
    """Writes the blocks that are files."""
    for block in blocks(text):
        if block.file is not None:
            (folder / block.file).parent.mkdir(parents=True, exist_ok=True)
            (folder / block.file).write_text(block.text, encoding="utf-8")


@cache
def outputs(path: Path) -> tuple[tuple[int, str], ...]:
    """Exit code and output of each command of a page; one after ``make`` is not run."""
    text = path.read_text(encoding="utf-8")
    with TemporaryDirectory() as place:
        folder, programs = Path(place) / "work", Path(place) / "bin"
        folder.mkdir()
        programs.mkdir()
        for name, command in (("modrobust", COMMAND), ("python", [PYTHON])):
            script = programs / name
            script.write_text(f'#!/bin/sh\nexec {shlex.join(command)} "$@"\n', encoding="utf-8")
            script.chmod(0o755)
        write_files(text, folder)
        return tuple(_run(step.command, folder, programs) for step in page_steps(path))


def _run(command: str, folder: Path, programs: Path) -> tuple[int, str]:
    if command.startswith("make "):
        return 0, ""
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env=environment(PATH=f"{programs}{os.pathsep}{os.environ['PATH']}", PYTHONUNBUFFERED="1"),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=300,
        check=False,
    )
    return done.returncode, done.stdout


def difference(shown: list[str], output: str) -> str | None:
    """What a page shows and the output does not have, in words; None where they agree.

    Lines that the page leaves out without saying so by ``...`` are a difference, too, unless it
    shows nothing at all. Empty lines are not compared.
    """
    if not any(shown):
        return None
    lines = [line.rstrip() for line in output.splitlines() if line.strip()]
    at, free = 0, False
    for line in (line.rstrip() for line in shown if line.strip()):
        if line == _LEFT_OUT:
            free = True
            continue
        ends = range(at, len(lines)) if free else range(at, min(at + 1, len(lines)))
        place = next((k for k in ends if _same(line, lines[k])), None)
        if place is None:
            have = "the end" if at >= len(lines) else repr(lines[at])
            return f"shown: {line!r}; the output has {have} there"
        at, free = place + 1, False
    if at < len(lines) and not free:
        return f"not shown: {lines[at]!r}"
    return None


def _same(shown: str, line: str) -> bool:
    if shown == line:
        return True
    if not (_A_TIME.search(shown) and _A_TIME.search(line)):
        return False
    return _timeless(shown) == _timeless(line)


def _timeless(line: str) -> list[str]:
    """Words of a line without its times, whose unit depends on their size."""
    return re.sub(r"[\d.]+(e[+-]?\d+)? (us|ms|s)\b", "TIME", line).split()


def rewritten(path: Path) -> str:
    """The page with the outputs as they are now; those that agree are left as they stand.

    Where lines are left out, as many are kept before the first ``...`` and after the last; what
    stands between two is found by its first line. A line ``?`` asks for the whole output.
    """
    text = path.read_text(encoding="utf-8")
    run = iter(outputs(path))
    made = text
    shift = 0
    for block in blocks(text, "console"):
        body = "".join(_block_lines(steps(block), run))
        start, end = block.span
        made = made[: start + shift] + body + made[end + shift :]
        shift += len(body) - (end - start)
    return made


def _block_lines(found: list[Step], run: Iterator[tuple[int, str]]) -> Iterator[str]:
    for step in found:
        _, output = next(run)
        yield f"$ {step.command}\n"
        shown = step.shown
        if difference(shown, output) is not None:
            shown = _shortened(shown, [line.rstrip() for line in output.strip("\n").splitlines()])
        yield from (f"{line}\n" for line in shown)


def _shortened(shown: list[str], lines: list[str]) -> list[str]:
    """The output with as much left out as before."""
    parts: list[list[str]] = [[]]
    for line in shown:
        if line == _LEFT_OUT:
            parts.append([])
        else:
            parts[-1].append(line)
    if len(parts) == 1:
        return lines
    head, *middle, tail = parts
    made = lines[: len(head)]
    for part in middle:
        start = lines.index(part[0]) if part and part[0] in lines else 0
        made += [_LEFT_OUT, *lines[start : start + len(part)]]
    return [*made, _LEFT_OUT, *lines[len(lines) - len(tail) :]]
