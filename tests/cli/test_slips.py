# ruff: noqa: E501  messages stand here as one line, as they are printed
"""Slips of the pen and of the keyboard: each is refused with what was meant."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

HEAD = "modrobust: 1\nrobot: arm\nchain: [lwa4p-paper-link-1]\n"


def refused(run, message: str, *arguments: str) -> None:
    result = run(*arguments)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == f"{message}\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "payload: {mass: 1e299 kg, com: [0, 0, 0.1]}",
            "arm.yaml:4: payload.mass: 1e+299 kg is beyond 1e+12 kg; no robot has that; check its exponent",
        ),
        (
            "payload: {mass: '[0, 1e13]', com: [0, 0, 0.1]}".replace("'", ""),
            "arm.yaml:4: payload.mass: 1e+13 kg is beyond 1e+12 kg; no robot has that; check its exponent",
        ),
        (
            "payload: {mass: 1 kg, com: [0, 0, -1e10 m]}",
            "arm.yaml:4: payload.com[2]: 1e+10 m is beyond 1e+09 m; no robot has that; check its exponent",
        ),
        (
            "payload: {mass: 1 kg, com: [0, 0, 0], inertia: {xx: 1e31, yy: 1e31, zz: 1e31}}",
            "arm.yaml:4: payload.inertia.xx: 1e+31 kg m^2 is beyond 1e+30 kg m^2; no robot has that; check its exponent",
        ),
        (
            "payload: {mass: 1 kg, com: [0, 0, 0], size: [1, 1, -0.5 m]}",
            "arm.yaml:4: payload.size[2]: -0.5 m is not positive; the edge of a box is above 0, its lower bound too; write a positive length",
        ),
        (
            'payload: {mass: "0,9 kg", com: [0, 0, 0]}',
            'arm.yaml:4: payload.mass: "0,9 kg" has a comma; the decimal sign is a point; write "0.9 kg"',
        ),
        (
            'notes: "red \\e[31m"',
            "arm.yaml:4: notes: control character U+001B, written as an escape; a text is plain, or it could steer the terminal that shows it; remove it",
        ),
    ],
)
def test_a_slip_in_a_description_is_refused(run, tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "arm.yaml").write_text(f"{HEAD}{text}\n")
    refused(run, message, "assemble", "arm.yaml")


def test_an_escape_in_json_is_refused_too(run, tmp_path: Path) -> None:
    text = '{"modrobust": 1, "robot": "arm", "notes": "\\u009b31m", "chain": ["x"]}'
    (tmp_path / "arm.json").write_text(text)
    result = run("assemble", "arm.json")
    assert result.returncode == 2
    assert result.stderr.startswith("arm.json:1: notes: control character U+009B")


def test_a_drive_that_makes_the_mass_matrix_infinite_is_named(run, tmp_path: Path) -> None:
    text = HEAD.replace("[lwa4p-paper-link-1]", "[{module: schunk-pb-large-1, set: {AXIS: 1e200}}]")
    (tmp_path / "arm.yaml").write_text(text.replace("AXIS", "axis1.drive.gear_ratio"))
    result = run("assemble", "arm.yaml")
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1
    assert "joint schunk-pb-large-1.axis1: the inertia that it moves is not finite" in result.stderr


def test_the_case_of_letters_does_not_hide_a_name(run) -> None:
    assert 'did you mean "lwa4p"?' in run("assemble", "LWA4P").stderr


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("a.yaml", ["assemble", "a.yaml"], "a description is a regular file; save it as one"),
        (
            "a.csv",
            ["simulate", "lwa4p", "--trajectory", "a.csv"],
            "expected a CSV file; save it as one",
        ),
        ("a.json", ["import-timor", "a.json", "-o", "x"], "expected a file; save it as one"),
    ],
)
def test_a_pipe_is_refused_and_never_waited_for(
    run, tmp_path: Path, name: str, arguments: list[str], message: str
) -> None:
    os.mkfifo(tmp_path / name)
    refused(run, f"{name}: is a pipe or a device; {message}", *arguments)
