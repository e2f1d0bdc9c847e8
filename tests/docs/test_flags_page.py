"""The tables of the page on compiler flags, tried with each compiler."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

import modrobust.kernel
from support.pages import DOCS

KERNEL = Path(modrobust.kernel.__path__[0])
OWN = [line for line in (KERNEL / "flags.txt").read_text().splitlines() if line.startswith("-")]
SELF_TEST = ("mr_self_test", "mr_environment", "mr_sincos", "mr_entries")
PROGRAM = '#include "mr_kernel.h"\nint main(void) { return mr_self_test() != MR_OK; }\n'


def table(heading: str) -> list[str]:
    part = (DOCS / "reference" / "flags.md").read_text(encoding="utf-8")
    part = part.split(f"## {heading}\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `(-[^`]+)` \|", part, re.MULTILINE)


def accepts(compiler: str, flags: str, folder: Path) -> bool:
    """Whether the self-test compiles with the flags after the kernel's own, and passes."""
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    (folder / "main.c").write_text(PROGRAM)
    sections = ["-ffunction-sections", "-Wl,--gc-sections"]  # of the entries only one is linked
    sources = [str(KERNEL / f"{name}.c") for name in SELF_TEST]
    command = [compiler, *OWN, "-w", f"-I{KERNEL}", *sections, *flags.split(), "main.c", *sources]
    built = subprocess.run(
        [*command, "-lm", "-o", "run"], cwd=folder, capture_output=True, text=True, check=False
    )
    if built.returncode:
        assert "modrobust: " in built.stderr, built.stderr  # our own message and no other fault
        return False
    return subprocess.run([folder / "run"], check=False).returncode == 0


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("flags", table("Allowed"))
def test_an_allowed_flag_passes(compiler: str, flags: str, tmp_path: Path) -> None:
    assert accepts(compiler, flags, tmp_path)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("flags", table("Refused"))
def test_a_refused_flag_is_refused(compiler: str, flags: str, tmp_path: Path) -> None:
    assert not accepts(compiler, flags, tmp_path)


def test_the_tables_are_read() -> None:
    assert len(table("Allowed")) >= 10
    assert "-ffast-math" in table("Refused")
