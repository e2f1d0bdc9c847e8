"""Export, other engines and pictures from the command line.

An installed wheel is tested without the extras: there the message names the extra.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

import modrobust as mr
from support.command_line import COMMAND, EXECUTABLE, environment

BARE = EXECUTABLE is not None  # an environment without extras
PAYLOAD = ("simulate", "lwa4p-payload", "--rate", "3000", "--duration", "0.1 s")


def test_assemble_writes_urdf_and_mjcf_and_says_what_they_do_not_hold(run, tmp_path: Path) -> None:
    options = ("--urdf", "a.urdf", "--mjcf", "a.xml", "--parameters", "upper", "--json")
    result = run("assemble", "lwa4p-payload", *options)
    assert result.returncode == 0
    point, pulled = mr.load_robot("lwa4p-payload").physical_corner("upper")
    upper = point.mass.tolist()
    highest = [body["mass"]["hi"] for body in json.loads(result.stdout)["bodies"]]
    names = [body["name"] for body in json.loads(result.stdout)["bodies"]]
    assert all(
        x == y for x, y, name in zip(upper, highest, names, strict=True) if name not in pulled
    )
    for file in ("a.urdf", "a.xml"):
        text = (tmp_path / file).read_text()
        assert all(f'"{mass!r}"' in text for mass in upper)
        assert "the disturbance [d]" in text.split("-->")[0]
    lines = result.stderr.splitlines()
    assert "not held by URDF: rotor inertia of every joint" in lines
    assert "not held by MJCF: velocity limits" in lines
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.urdf", "a.xml"]


def test_the_same_seed_exports_the_same_robot(run, tmp_path: Path) -> None:
    for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        options = ("--parameters", "random", "--seed", seed, "--urdf", f"{name}.urdf", "--json")
        assert run("assemble", "lwa4p", *options).returncode == 0
    a, b, c = ((tmp_path / f"{name}.urdf").read_text() for name in "abc")
    assert a == b
    assert a != c


def test_an_exported_urdf_assembles_again(run, tmp_path: Path) -> None:
    first = run("assemble", "scara", "--urdf", "scara.urdf", "--json")
    again = run("assemble", "scara.urdf", "--json")
    assert again.returncode == 0
    names = [
        [joint["name"] for joint in json.loads(result.stdout)["joints"]]
        for result in (first, again)
    ]
    assert names[0] == names[1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("assemble", "lwa4p", "--urdf", "a.xml"),
            'a.xml: suffix ".xml"; a URDF ends in .urdf; name it so\n',
        ),
        (
            ("assemble", "lwa4p", "--mjcf", "nowhere/a.xml"),
            "nowhere/a.xml: no directory nowhere; make it first\n",
        ),
        (
            ("assemble", "lwa4p", "--parameters", "upper"),
            "--parameters: nothing is written at them; add --urdf or --mjcf\n",
        ),
        (
            ("assemble", "missing.yaml", "--urdf", "a.urdf"),
            None,
        ),
        (
            (*PAYLOAD, "--video", "run.avi"),
            'run.avi: suffix ".avi"; a video ends in .mp4 or .gif; name it so\n',
        ),
    ],
)
def test_bad_places_are_refused_and_nothing_is_left(
    run, tmp_path: Path, arguments: tuple[str, ...], message: str | None
) -> None:
    result = run(*arguments)
    assert result.returncode == 2
    assert result.stdout == ""
    assert message is None or result.stderr == message
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("plant", ["mujoco", "pinocchio"])
def test_simulate_runs_with_another_engine_or_names_its_extra(run, plant: str) -> None:
    result = run(*PAYLOAD, "--plant", plant, "--json")
    if BARE:
        assert result.returncode == 2
        assert result.stderr == (
            f'plant "{plant}": the package {plant} is not installed; '
            f'install it with pip install "modrobust[{plant}]"\n'
        )
        return
    assert result.returncode == 0, result.stderr
    figures = json.loads(result.stdout)
    assert figures["violations"] == 0
    assert figures["settings"]["plant"] == plant


@pytest.mark.skipif(BARE, reason="needs the extra mujoco")
def test_the_headline_names_the_engine(run) -> None:
    result = run(*PAYLOAD, "--plant", "mujoco")
    assert result.returncode == 0
    assert "plant mujoco" in result.stdout.replace("\n", " ")


def test_without_a_screen_view_says_so_before_the_run(tmp_path: Path) -> None:
    import subprocess

    result = subprocess.run(
        [*COMMAND, *PAYLOAD, "--view"],
        cwd=tmp_path,
        env={k: v for k, v in environment().items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    assert result.stdout == ""
    if BARE:
        assert 'pip install "modrobust[mujoco]"' in result.stderr
    elif os.uname().sysname == "Linux":
        assert result.stderr == (
            "view: there is no screen (neither DISPLAY nor WAYLAND_DISPLAY is set); "
            "run it on a desktop, or make a video with --video run.mp4\n"
        )


def test_a_video_is_written_or_what_is_missing_is_said(run, tmp_path: Path) -> None:
    result = run(*PAYLOAD, "--video", "run.gif", "--json")
    if result.returncode == 2:
        assert result.stderr.startswith("video: ")
        assert list(tmp_path.iterdir()) == []
        return
    assert result.returncode == 0
    assert (tmp_path / "run.gif").read_bytes()[:6] == b"GIF89a"
    assert [p.name for p in tmp_path.iterdir()] == ["run.gif"]
