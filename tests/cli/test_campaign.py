"""``modrobust campaign``: its table, its verdict, and commands that show a run again."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import numpy as np
import pytest

Run = Callable[..., CompletedProcess[str]]

LOOP = ("--rate", "500Hz", "--delay", "1", "--noise", "position=1e-4, velocity=1e-2")
AUTO = ("scara", "--law", "auto", *LOOP)


def figures_of(run: Run, *arguments: str) -> dict[str, Any]:
    done = run("campaign", *arguments, "--json")
    assert done.returncode in (0, 1), done.stderr
    assert done.stderr == ""
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def test_the_table_has_a_row_a_figure_with_its_run_and_a_command(run: Run) -> None:
    done = run("campaign", *AUTO, "--runs", "3", "--jobs", "2", "--motions", "short")
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0].startswith("scara: 3 runs at 500 Hz, delay 1, noise; law sampled, G = ")
    (row,) = (line for line in lines if "late error, norm" in line)
    assert "modrobust campaign scara --rate 500Hz --delay 1.0 " in row
    assert row.rstrip()[-8:-2] == "--only"
    assert "good: 3 of 3, below epsilon: 3" in lines
    assert "tried, not proved: every one of 3 runs kept the bound" in done.stdout


def test_the_command_of_the_worst_case_shows_the_same_figures(run: Run) -> None:
    whole = figures_of(run, *AUTO, "--runs", "3", "--motions", "short", "--seed", "2")
    worst = whole["worst"]["step_over_limit"]
    words = shlex.split(worst["command"])
    assert words[:2] == ["modrobust", "campaign"]
    again = run(*words[1:], "--json")
    (record,) = json.loads(again.stdout)["records"]
    assert record == whole["records"][worst["run"]]  # bit for bit, by the shortest texts
    assert record["step_over_limit"] == worst["worst"]


@pytest.mark.parametrize("options", [("auto", *LOOP), ("norm", "--rate", "20kHz")])
def test_a_run_of_the_files_own_motion_is_shown_by_simulate(
    run: Run, options: tuple[str, ...]
) -> None:
    options = ("scara", "--law", *options, "--motions", "own", "--runs", "4")
    whole = figures_of(run, *options)
    worst = whole["worst"]["torque_over_limit"]
    words = shlex.split(worst["command"])
    assert words[:2] == ["modrobust", "simulate"]
    figures = json.loads(run(*words[1:], "--json").stdout)
    shares = [a / b for a, b in zip(figures["tau_max"], figures["tau_limit"], strict=True)]
    assert max(shares) == worst["worst"]


def test_only_shows_one_run_and_saves_it(run: Run, tmp_path: Path) -> None:
    done = run("campaign", *AUTO, "--only", "1", "--motions", "short", "--log", "run.npz")
    assert done.returncode == 0
    assert "Run 1: parameters upper, disturbance " in done.stdout
    assert "tried, not proved: the run kept the bound" in done.stdout
    with np.load(tmp_path / "run.npz") as log:
        assert log["t"][-1] == pytest.approx(1.25)


def test_a_run_that_is_bad_is_the_exit_code(run: Run) -> None:
    norm = ("lwa4p", "--law", "norm", "--rate", "1kHz", "--motions", "own", "--only", "0")
    done = run("campaign", *norm)
    assert done.returncode == 1
    assert "tried, not proved: of 1 run, 1 diverged" in done.stdout


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--log", "run.npz"), "--log: given without --only RUN"),
        (("--only", "0", "--log", "run.csv"), "run.csv: "),
        (("--motions", "own,lon"), '--motions: no kind "lon"; did you mean "long"?'),
        (("--epsilon", "0"), "--epsilon: 0; must be positive"),
        (("--rate", "0.5Hz"), "--rate: 0.5 Hz; must lie in [1, 1e+07] Hz"),
    ],
)
def test_what_is_wrong_is_said_of_its_option(
    run: Run, options: tuple[str, ...], message: str
) -> None:
    done = run("campaign", "scara", "--law", "auto", *options)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stdout == ""
