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


TURNED = "\u202e\u2066\u061c"  # right to left from here on
TURNED_MODULE = f"""\
modrobust: 1
module: link
name: A link {TURNED}dleiw
source: made up {TURNED}
notes: a remark {TURNED}
connectors: {{in: {{type: "t{TURNED}"}}, out: {{type: "t{TURNED}"}}}}
chain:
  - joint: axis
    type: revolute
  - body: rod
    mass: MASS
    com: [0, 0, 0.1 m]
    inertia: {{xx: 0.01, yy: 0.01, zz: 0.01}}
"""


@pytest.mark.parametrize("mass", ["1 kg", f"'1 k{TURNED}g'"])
def test_no_text_of_a_file_turns_the_direction_of_what_is_printed(
    run, tmp_path: Path, mass: str
) -> None:
    text = f"modrobust: 1\nrobot: arm\nsource: by {TURNED} me\nmodules: only\nchain: [link]\n"
    (tmp_path / "link.yaml").write_text(TURNED_MODULE.replace("MASS", mass), encoding="utf-8")
    (tmp_path / "arm.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "only").mkdir()
    (tmp_path / "link.yaml").rename(tmp_path / "only" / "link.yaml")
    for command in (
        ("assemble", "arm.yaml"),
        ("assemble", "arm.yaml", "--json"),
        ("simulate", "arm.yaml", "--duration", "1ms"),
        ("modules", "only"),
    ):
        result = run(*command)
        said = result.stdout + result.stderr
        assert said
        assert "Traceback" not in said
        assert not any(letter in said for letter in TURNED), command
