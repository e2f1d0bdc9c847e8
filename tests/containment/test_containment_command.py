"""The command for millions of cases: it goes on where it stopped and says what it found."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

COMMAND = Path(__file__).with_name("run.py")


def run(*options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(COMMAND), *options], capture_output=True, text=True, check=False
    )


def entries(state: Path) -> list[dict[str, Any]]:
    """The blocks of a state file, without a line that was cut off."""
    return [json.loads(line) for line in state.read_text().splitlines() if line.endswith("}")]


def test_a_run_goes_on_where_it_stopped(tmp_path: Path) -> None:
    state = tmp_path / "state.jsonl"
    first = run("--cases", "1", "--jobs", "1", "--state", str(state))
    assert first.returncode == 0, first.stderr
    with state.open("a") as file:
        file.write('{"of": "cut o')  # as a machine that went down leaves it
    done = json.loads(state.read_text().splitlines()[0])["cases"]
    second = run("--cases", str(done + 1), "--jobs", "2", "--state", str(state))
    assert second.returncode == 0, second.stderr
    assert [entry["block"] for entry in entries(state)] == [0, 1]
    total = sum(entry["cases"] for entry in entries(state))
    assert f"{total:,} of {done + 1:,} cases" in second.stdout
    assert "0 violations" in second.stdout
    third = run("--cases", "1", "--state", str(state))
    assert f"{total:,} of 1 cases" in third.stdout


def test_ctrl_c_leaves_what_is_done(tmp_path: Path) -> None:
    state = tmp_path / "state.jsonl"
    options = [sys.executable, str(COMMAND), "--jobs", "2", "--state", str(state)]
    with subprocess.Popen(options, stdout=subprocess.PIPE, text=True) as process:
        while not (state.exists() and state.read_text().count("\n")):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert f"stopped; the same command goes on from {state}" in output
    for line in state.read_text().splitlines():
        assert json.loads(line)["violations"] == []


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL], ids=lambda how: how.name)
def test_a_killed_run_goes_on_and_counts_right(how: signal.Signals, tmp_path: Path) -> None:
    """Else a block could be lost or counted twice where a machine goes down, and nobody would know.

    The resumed run has the blocks, cases and kinds of one that was never stopped.
    """
    state, whole = tmp_path / "state.jsonl", tmp_path / "whole.jsonl"
    options = [sys.executable, str(COMMAND), "--jobs", "1", "--state", str(state)]
    with subprocess.Popen(options, stdout=subprocess.DEVNULL) as process:
        while not (state.exists() and state.read_text().count("\n")):
            assert process.poll() is None
            time.sleep(0.02)
        process.send_signal(how)
        process.wait(timeout=60)
    assert process.returncode == -how
    goal = sum(entry["cases"] for entry in entries(state)) + 1000
    resumed = run("--cases", str(goal), "--jobs", "1", "--state", str(state))
    assert resumed.returncode == 0, resumed.stderr
    assert run("--cases", str(goal), "--jobs", "1", "--state", str(whole)).returncode == 0
    assert entries(state) == entries(whole)
    total = sum(entry["cases"] for entry in entries(state))
    assert f"{total:,} of {goal:,} cases" in resumed.stdout


def test_a_state_of_other_sources_is_refused(tmp_path: Path) -> None:
    state = tmp_path / "state.jsonl"
    state.write_text('{"of": "other", "block": 0}\n')
    answer = run("--cases", "1", "--state", str(state))
    assert answer.returncode == 1
    assert "made with other sources" in answer.stderr
