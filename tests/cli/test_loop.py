"""The loop as options of `simulate`: over the file's own, and as the library has it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import modrobust as mr
from modrobust.cli.options import loop_of, start_error
from modrobust.errors import ModrobustError
from modrobust.model import LoopSettings

ARM = """
modrobust: 1
robot: arm
chain:
  - {module: lwa4p-paper-link-1, as: one}
  - {module: lwa4p-paper-link-2, as: two}
loop: {rate: 2 kHz, delay: 0.5, noise: {position: 1e-4, velocity: 1e-2}, saturation: true}
"""


@pytest.fixture
def arm(tmp_path: Path) -> mr.Robot:
    (tmp_path / "arm.yaml").write_text(ARM)
    return mr.load_robot(tmp_path / "arm.yaml")


def figures(run: Any, *options: str) -> dict[str, Any]:
    result = run("simulate", "arm.yaml", "--duration", "20ms", *options, "--json")
    assert result.returncode in (0, 1), result.stderr
    settings: dict[str, Any] = json.loads(result.stdout)["settings"]
    return settings


def test_without_options_the_loop_is_the_file_s(run, arm: mr.Robot) -> None:
    assert loop_of(arm) == arm.loop
    loop = figures(run)["loop"]
    assert (loop["rate"], loop["delay"], loop["saturation"]) == (2000.0, 0.5, True)
    assert (loop["noise_position"], loop["noise_velocity"]) == ([1e-4] * 2, [1e-2] * 2)


def test_every_option_stands_over_the_file(arm: mr.Robot) -> None:
    given = ("4kHz", 1.0, "velocity=2e-3, sign=worst", "position=0.01 deg", False, "worst")
    assert loop_of(arm, *given) == LoopSettings(
        rate=4000.0,
        delay=1.0,
        noise_velocity=(2e-3, 2e-3),
        noise="worst",
        quantisation_position=(1.7453292519943296e-4,) * 2,
        disturbance="worst",
    )
    assert loop_of(arm, noise="none") == replace(arm.loop, noise_position=(), noise_velocity=())


def test_options_reach_the_run(run, arm: mr.Robot) -> None:
    given = ("--rate", "500", "--delay", "1", "--noise", "none", "--quantisation", "velocity=1e-3")
    more = ("--no-saturation", "--disturbance", "sine", "--law", "componentwise", "--hold-aware")
    settings = figures(run, *given, *more)
    loop = settings["loop"]
    assert (loop["rate"], loop["delay"], loop["saturation"]) == (500.0, 1.0, False)
    assert (loop["noise_position"], loop["quantisation_velocity"]) == ([], [1e-3, 1e-3])
    assert loop["disturbance"] == "sine"
    assert (settings["law"], settings["hold_aware"]) == ("componentwise", True)


def test_an_error_at_the_start_is_a_norm_or_one_of_each_joint(run, arm: mr.Robot) -> None:
    assert start_error(arm, None) is None
    assert start_error(arm, "1 deg") == pytest.approx(0.0174532925)
    assert start_error(arm, "two.axis=-0.1 rad, one.axis=0.2") == (0.2, -0.1)
    assert figures(run, "--initial-error", "0.02 rad")["q0"] != figures(run)["q0"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--rate", "1 ms"), '--rate: "1 ms" has the unit "ms"; a frequency [Hz] is expected; '),
        (("--rate", "5khz"), '--rate: "5khz": unknown unit "khz"; did you mean "kHz"? known: '),
        (("--rate", "0.5"), "--rate: 0.5 Hz; must lie in [1, 1e+07] Hz; "),
        (("--noise", "1e-4"), '--noise: "1e-4": "1e-4" is no key=value; write "key=value, '),
        (("--noise", "position=-1"), "--noise: position: -1 is negative; it is at least 0; "),
        (("--noise", "positon=1"), '--noise: unknown key "positon"; did you mean "position"? '),
        (("--quantisation", "velocity=1 kg"), '--quantisation: velocity: "1 kg" has the unit '),
        (("--initial-error", "5 kg"), '--initial-error: "5 kg" has the unit "kg"; an angle [rad]'),
        (("--initial-error", "one=1"), '--initial-error: no joint named "one"; known: one.axis, '),
        (("--law", "sampled"), 'G: nothing given; the law "sampled" needs it; '),
    ],
)
def test_an_option_is_refused_for(run, arm: mr.Robot, options: tuple[str, str], message) -> None:
    result = run("simulate", "arm.yaml", *options)
    assert (result.returncode, result.stdout) == (2, "")
    assert " ".join(result.stderr.split()).startswith(message)


@pytest.mark.parametrize(
    ("options", "found"),
    [
        (("--delay", "2"), "--delay"),
        (("--disturbance", "wave"), "--disturbance"),
        (("--law", "best"), "--law"),
        (("--control-rate", "1kHz"), "--control-rate"),
    ],
)
def test_what_is_no_option_ends_with_its_name(run, arm: mr.Robot, options, found: str) -> None:
    result = run("simulate", "arm.yaml", *options)
    assert (result.returncode, result.stdout) == (2, "")
    assert found in result.stderr


def test_noise_of_a_velocity_that_is_differentiated_is_refused(arm: mr.Robot) -> None:
    loop = replace(arm.loop, velocity="differentiated", noise_velocity=())
    with pytest.raises(ModrobustError, match="--noise: velocity beside velocity: differentiated"):
        loop_of(replace(arm, loop=loop), noise="velocity=1e-2")


def test_a_drive_of_all_joints_reaches_every_command(run, tmp_path: Path) -> None:
    from support.urdf_texts import two_links, written

    written(tmp_path, two_links())
    drive = ("--drive", "rotor_inertia=1e-4 ± 10%, gear_ratio=50")
    joint = json.loads(run("assemble", "small.urdf", *drive, "--json").stdout)["joints"][0]
    assert (joint["drive"]["gear_ratio"], joint["drive"]["rotor_inertia"]["nominal"]) == (50, 1e-4)
    result = run("simulate", "small.urdf", "--drive", "gear_ratio=1 kg")
    assert result.returncode == 2
    assert result.stderr.startswith('--drive: gear_ratio: "1 kg" has the unit "kg"; ')
