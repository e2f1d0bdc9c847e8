"""Streams that fail, and Ctrl-C while the command still loads."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from support.command_line import COMMAND, environment

FULL = Path("/dev/full")


def with_stdout(folder: Path, stdout: object, *arguments: str) -> tuple[int, str]:
    """Exit code and stderr of a command whose stdout is a given file."""
    done = subprocess.run(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(),
        stdin=subprocess.DEVNULL,
        stdout=stdout,  # type: ignore[call-overload]
        stderr=subprocess.PIPE,
        text=True,
        timeout=120,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full")
@pytest.mark.parametrize("arguments", [["schema", "module"], ["--help"], ["--version"]])
def test_results_that_cannot_be_written_are_an_error(tmp_path: Path, arguments: list[str]) -> None:
    with FULL.open("w") as full:
        code, said = with_stdout(tmp_path, full, *arguments)
    assert (code, said) == (2, "stdout: cannot be written: No space left on device\n")


@pytest.mark.parametrize("arguments", [["schema", "module"], ["modules"], ["--help"]])
def test_a_reader_that_has_seen_enough_hears_nothing(tmp_path: Path, arguments: list[str]) -> None:
    reader = subprocess.Popen(["true"], stdin=subprocess.PIPE)
    reader.wait()
    assert reader.stdin is not None
    code, said = with_stdout(tmp_path, reader.stdin, *arguments)
    reader.stdin.close()
    assert (code, said) == (141, "")


def test_ctrl_c_while_the_command_loads_leaves_no_traceback() -> None:
    pytest.importorskip("modrobust")
    loads = """
import sys, modrobust.cli

class Finder:
    @staticmethod
    def find_spec(name, *_):
        if name == "modrobust.cli.app":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Finder)
modrobust.cli.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", loads], capture_output=True, text=True, check=False, timeout=60
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
