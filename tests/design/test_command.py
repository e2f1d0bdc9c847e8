"""``modrobust design`` as a user runs it, and the margin."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest

import modrobust as mr
from modrobust.design import design
from modrobust.model import LoopSettings
from modrobust.motion import make_trajectory
from modrobust.simulation.margin import gain_margin
from support.command_line import run_in


def test_json_is_the_design_for_the_loop_of_the_options(tmp_path):
    options = ("--rate", "2kHz", "--delay", "0.5", "--epsilon", "0.02 rad", "--trajectory", "any")
    noise = ("--noise", "position=1e-5, velocity=1e-3")
    result = run_in(tmp_path, "design", "scara", *options, *noise, "--json")
    assert (result.returncode, result.stderr) == (0, "")
    robot = mr.load_robot("scara")
    loop = LoopSettings(2000.0, 0.5, (1e-5,) * 4, (1e-3,) * 4)
    found = design(robot, loop, epsilon=0.02)
    assert json.loads(result.stdout) == json.loads(json.dumps(found.to_dict(helps=True)))


def test_the_files_own_motion_is_the_default(tmp_path):
    shown = json.loads(run_in(tmp_path, "design", "scara", "--json").stdout)
    robot = mr.load_robot("scara")
    found = design(robot, motion=make_trajectory(robot))
    assert shown["motion"] == found.motion
    assert shown["gains"]["G"] == found.G


def test_what_cannot_be_met_exits_with_1_and_says_what_helps(tmp_path):
    result = run_in(tmp_path, "design", "lwa4p-paper", "--rate", "500", "--trajectory", "any")
    assert (result.returncode, result.stderr) == (1, "")
    assert re.search(r"^ rate and delay allow +237 /s  <- binds$", result.stdout, re.MULTILINE)
    assert "Note: epsilon 0.01 rad is not reachable at this rate: it asks for" in result.stdout
    head, _, table = result.stdout.partition("the least epsilon that could then be met\n")
    assert "What would help, each alone: " in head
    rows = [line for line in table.splitlines() if line.startswith(" ") and "/s" in line]
    assert rows[0].startswith(" twice the rate, 1000 Hz")
    assert rows[-1].startswith(" as it is")


@pytest.mark.parametrize("robot", ["scara", "lwa4p-paper"])
def test_tables_fit_in_80_columns(tmp_path, robot):
    result = run_in(tmp_path, "design", robot, "--delay", "1", "--rate", "500")
    assert [line for line in result.stdout.splitlines() if len(line) > 80] == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--epsilon", "0"), "--epsilon: 0; must be positive and finite"),
        (("--epsilon", "2 kg"), "--epsilon"),
        (("--rate", "0"), "--rate: 0 Hz; must be positive and finite"),
        (("--trajectory", "circle"), '--trajectory: no trajectory "circle"'),
        (("--noise", "speed=3"), "--noise"),
    ],
)
def test_wrong_options_are_named(tmp_path, options, message):
    result = run_in(tmp_path, "design", "scara", *options)
    assert (result.returncode, result.stdout) == (2, "")
    assert message in result.stderr
    assert "Traceback" not in result.stderr


def test_the_margin_lies_between_what_held_and_what_failed():
    robot = mr.load_robot("lwa4p-paper")
    loop = LoopSettings(rate=1000.0, delay=1.0)
    found = design(robot, loop)
    margin = gain_margin(robot, found.settings, loop)
    assert 1.0 < margin.factor < 4.0
    assert margin.beyond is not None
    assert margin.beyond - margin.factor == pytest.approx(3.0 / 2**5)
    assert margin.case is not None
    assert margin.reason is not None
    again = replace(
        found.settings,
        G=margin.beyond * found.G,
        Lambda=0.5 * margin.beyond * found.G,
        L_i=margin.beyond**2 * (found.settings.L_i or 0.0),
    )
    assert gain_margin(robot, again, loop).factor == 0.0


def test_gains_far_below_the_limit_do_not_fail():
    robot = mr.load_robot("scara")
    seen: list[float] = []
    margin = gain_margin(robot, design(robot).settings, robot.loop, progress=seen.append)
    assert (margin.factor, margin.beyond, margin.reason) == (4.0, None, None)
    assert margin.runs == 10
    assert seen == sorted(seen)
