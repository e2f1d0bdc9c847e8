"""What --duration does to a run, and what is said before it."""

from __future__ import annotations

import json
import signal
import subprocess
from pathlib import Path

import pytest

from support.command_line import COMMAND, environment


def test_a_short_run_is_the_first_part_of_the_motion_and_says_so(run) -> None:
    """Not all of it squeezed: the drives of a UR5 hold 150 N m."""
    result = run("simulate", "lwa4p", "--trajectory", "quintic", "--duration", "0.1s")
    text = " ".join(result.stdout.split())
    assert result.returncode == 0, text
    assert "PASS: bound kept, torques within limits" in text
    assert "error within epsilon" not in text
    assert (
        "Cut short: 0.1 s of a motion of 10 s; whether the error stays below epsilon is not judged"
    ) in text
    assert "not judged, cut short" in text


def test_the_time_of_the_default_motion_stands_in_the_file(run, tmp_path: Path) -> None:
    (tmp_path / "slow.yaml").write_text(
        "modrobust: 1\nrobot: slow\nchain: [lwa4p-paper-link-1]\n"
        "trajectory: {kind: quintic, duration: 0.5 s}\n"
    )
    result = run("simulate", "slow.yaml", "--json")
    figures = json.loads(result.stdout)
    assert (figures["settings"]["duration"], figures["cut_short"]) == (0.5, False)
    assert figures["settings"]["motion_time"] == 0.5
    shown = run("simulate", "slow.yaml").stdout.splitlines()
    assert shown[0].startswith("slow, parameters random, seed 0: 0.5 s, law auto, bound hull")
    assert shown[1].startswith("Motion: the default, quintic through seeded waypoints, seed 0")


def started(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(),
    )


@pytest.mark.parametrize("json_too", [False, True])
def test_a_long_run_is_announced_and_its_heading_comes_at_once(
    tmp_path: Path, json_too: bool
) -> None:
    (tmp_path / "ms.csv").write_text("0,0,0,0,0,0,0\n1000,0,0,0,0,0,0\n")  # written in ms, it seems
    options = ("--trajectory", "ms.csv", *(["--json"] if json_too else []))
    process = started(tmp_path, "simulate", "lwa4p-paper", *options)
    assert process.stdout is not None
    assert process.stderr is not None
    try:
        if not json_too:  # into a pipe, with the run still on
            assert process.stdout.readline().startswith(
                "lwa4p-paper, parameters random, seed 0: 1000 s"
            )
        assert process.stderr.readline() == (
            "1000 s of motion, 50,000,000 commands; Ctrl-C ends the run early and keeps what was "
            "computed\n"
        )
        about = process.stderr.readline()
        assert about.startswith("about ")
        assert about.endswith(" to go\n")
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 130
    if json_too:
        assert json.loads(out)["interrupted"]
