"""Ctrl-C keeps what was computed; the progress bar appears on a terminal and nowhere else.

The command runs with a terminal for stderr. Once the bar is there, the loop is under way, and the
interrupt comes: no guess about how long a start takes.
"""

from __future__ import annotations

import json
import os
import pty
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from support.command_line import COMMAND, environment


def interrupted(
    folder: Path, *arguments: str, interrupt: bool = True, by: int = signal.SIGINT
) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of a command that gets a signal once its progress bar shows."""
    terminal, inner = pty.openpty()
    process = subprocess.Popen(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(TERM="xterm", COLUMNS="80"),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=inner,
        text=True,
    )
    os.close(inner)
    shown, sent, deadline = "", False, time.monotonic() + 60.0
    while time.monotonic() < deadline:
        if not select.select([terminal], [], [], 0.1)[0]:
            continue
        try:
            data = os.read(terminal, 4096).decode(errors="replace")
        except OSError:  # the process closed it
            data = ""
        if not data:
            break
        shown += data
        if interrupt and not sent and "%" in shown:
            process.send_signal(by)
            sent = True
    os.close(terminal)
    try:
        out, _ = process.communicate(timeout=60)
    finally:
        process.kill()
    assert sent or not interrupt, "the progress bar never came"
    return process.returncode, out, shown


def test_an_interrupted_simulation_shows_and_saves_what_it_has(tmp_path: Path) -> None:
    code, out, shown = interrupted(
        tmp_path, "simulate", "lwa4p-paper", "--duration", "1e4s", "--log", "run.npz"
    )
    assert code == 130
    assert "Simulating lwa4p-paper" in shown
    assert "of 10000 s; what was computed is kept in run.npz" in shown
    assert " violations " in out
    assert "FAIL: interrupted at " in out
    with np.load(tmp_path / "run.npz") as log:
        assert 0.0 <= log["t"][-1] < 1e4
        assert log["tau"].shape == (len(log["t"]), 6)
    assert os.listdir(tmp_path) == ["run.npz"]


def test_an_interrupted_simulation_prints_whole_json(tmp_path: Path) -> None:
    code, out, _ = interrupted(tmp_path, "simulate", "lwa4p-paper", "--duration", "1e4s", "--json")
    figures = json.loads(out)
    assert (code, figures["interrupted"], figures["ok"]) == (130, True, False)
    assert 0.0 < figures["time"] < 1e4


def test_an_interrupted_bench_shows_what_it_has(tmp_path: Path) -> None:
    code, out, shown = interrupted(tmp_path, "bench", "lwa4p-paper")
    assert code == 130
    assert "interrupted; what was measured until then is kept" in shown
    assert out.startswith("lwa4p-paper: 6 joints\n")


@pytest.mark.parametrize("by", [signal.SIGTERM, signal.SIGHUP])
def test_a_command_that_is_ended_leaves_no_half_written_file(tmp_path: Path, by: int) -> None:
    text = """
import signal, time
for ending in (signal.SIGTERM, signal.SIGHUP):
    signal.signal(ending, signal.SIG_DFL)  # whatever runs the tests may ignore them
from modrobust.cli import main
from modrobust.simulation import run
from modrobust.checks import replacing

def slow(*_, **__):
    with replacing("run.npz", ".npz", "a log") as part:
        part.write_text("half of it")
        print("half", flush=True)
        time.sleep(60)

run.simulate = slow
main()
"""
    process = subprocess.Popen(
        [sys.executable, "-c", text, "simulate", "scara"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert "half\n" in iter(process.stdout.readline, "")  # after the heading
        assert len(os.listdir(tmp_path)) == 1
        process.send_signal(by)
        assert process.wait(timeout=30) == 128 + by
    finally:
        process.kill()
        process.communicate()
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("stderr_is_a_terminal", [True, False])
def test_a_quick_run_and_a_pipe_have_no_progress_bar(
    run, tmp_path: Path, stderr_is_a_terminal: bool
) -> None:
    if stderr_is_a_terminal:
        arguments = ("simulate", "lwa4p-paper", "--duration", "10ms")
        code, _, shown = interrupted(tmp_path, *arguments, interrupt=False)
        assert code in (0, 1)
    else:
        shown = run("simulate", "lwa4p-paper", "--duration", "3s").stderr
    assert shown == ""


def test_an_interrupted_campaign_shows_the_runs_that_were_done(tmp_path: Path) -> None:
    options = ("--law", "auto", "--rate", "500Hz", "--motions", "short", "--runs", "5000")
    code, out, shown = interrupted(tmp_path, "campaign", "scara", *options, "--json")
    figures = json.loads(out)
    assert (code, figures["interrupted"], figures["ok"]) == (130, True, False)
    assert 0 < figures["runs"] < figures["wanted"] == 5000
    assert f"interrupted after {figures['runs']} of 5000 runs" in shown
    assert figures["verdict"].startswith(f"tried, not proved: {figures['runs']} of 5000 runs done")
