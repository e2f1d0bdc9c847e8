"""The verdict of `simulate`: what was shown, in which run; and nothing more of a run that broke."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

LINK = """\
modrobust: 1
module: link
name: A link
source: made up for a test
connectors: {in: {type: t}, out: {type: t}}
chain:
  - joint: axis
    type: revolute
    limits: {torque: 1000 N m}
  - body: rod
    mass: 1 kg
    com: [0.1 m, 0, 0]
    inertia: {xx: 0.01, yy: 0.01, zz: 0.01}
"""
ARM = """\
modrobust: 1
robot: arm
modules: .
chain: [link]
controller: {K_r: 10, kappa_P: 0.5, kappa_I: 10, phi_P: 200, phi_I: 1000, epsilon: 0.01 rad}
loop: {rate: 50 kHz}
"""


CUT_SHORT = (
    "Cut short: 0.1 s of a motion of 10 s; whether the error stays below epsilon is not judged"
)


def last_line(text: str) -> str:
    return " ".join(text[text.rindex("\n\n") :].split())


def arm(folder: Path, mass: str = "1 kg", more: str = "") -> str:
    (folder / "link.yaml").write_text(LINK.replace("1 kg", mass))
    (folder / "arm.yaml").write_text(ARM + more)
    return "arm.yaml"


@pytest.mark.parametrize(
    ("options", "which"),
    [
        ((), "parameters random, seed 0"),
        (("--parameters", "corner", "--seed", "7"), "parameters corner, seed 7"),
        (("--parameters", "upper"), "parameters upper"),
        (("--scenario", "full"), "scenario full"),
    ],
)
def test_good_speaks_of_this_one_run(run, tmp_path: Path, options, which: str) -> None:
    file = arm(tmp_path, "[1 kg, 1.2 kg]", "scenarios: {full: {set: {link.rod.mass: 1.2 kg}}}\n")
    result = run("simulate", file, "--duration", "100ms", *options)
    assert result.returncode == 0
    assert last_line(result.stdout) == (
        f"{CUT_SHORT} PASS: bound kept, torques within limits, in this one run ({which})"
    )
    assert result.stdout.startswith(f"arm, {which}: 0.1 s")


def test_a_robot_of_modules_with_nothing_uncertain_earns_no_pass(run, tmp_path: Path) -> None:
    result = run("simulate", arm(tmp_path), "--duration", "100ms")
    assert result.returncode == 0
    assert "PASS" not in result.stdout
    assert last_line(result.stdout) == (
        f"{CUT_SHORT} exact: robust against nothing; give bounds or a tolerance in the module "
        "files, see docs/reference/formats.md"
    )


def test_a_bounded_disturbance_is_something_to_be_robust_against(run, tmp_path: Path) -> None:
    file = arm(tmp_path, more="disturbance: [-1 N m, 1 N m]\n")
    result = run("simulate", file, "--duration", "100ms")
    assert (result.returncode, result.stderr) == (0, "")
    assert last_line(result.stdout).startswith(f"{CUT_SHORT} PASS: ")
    figures = json.loads(run("simulate", file, "--duration", "100ms", "--json").stdout)
    assert (figures["uncertain"], figures["ok"]) == (True, True)


def test_a_run_that_diverged_has_one_cause_one_remedy_and_nothing_under_it(
    run, tmp_path: Path
) -> None:
    file = arm(tmp_path, "[1 kg, 1.2 kg]")
    text = (tmp_path / file).read_text().replace("phi_P: 200", "phi_P: 1e4")
    (tmp_path / file).write_text(text)
    result = run("simulate", file, "--rate", "1kHz", "--duration", "1s")
    assert (result.returncode, result.stderr) == (1, "")
    head, _, verdict = result.stdout.partition("\n\n")
    assert len(head.splitlines()) == 3
    lines = [line for line in verdict.splitlines() if ": " in line]
    assert [line.partition(":")[0] for line in lines] == ["FAIL", "Cause", "What helps"]
    said = " ".join(verdict.split())
    assert 'Cause: joint "link.axis": the gain of law "norm", 1e+04 N m s/rad, held' in said
    assert 'What helps: the law "auto", which chooses gains' in said
    for consequence in ("violations", "beyond its limit", "chatters", "Also"):
        assert consequence not in verdict
