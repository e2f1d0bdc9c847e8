"""Each command on a built-in robot: what it prints, writes and answers."""

from __future__ import annotations

import json
import os
import pty
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from support.command_line import COMMAND, environment

SHORT = ("simulate", "lwa4p-paper", "--scenario", "1", "--duration", "20ms")


def test_assemble_writes_the_same_json_that_it_prints(run, tmp_path: Path) -> None:
    result = run("assemble", "lwa4p-paper", "--json", "--output", "resolved.json")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == (tmp_path / "resolved.json").read_text()
    robot = json.loads(result.stdout)
    assert (robot["robot"], len(robot["joints"]), robot["gravity"]) == (
        "lwa4p-paper",
        6,
        [0.0, 0.0, -9.81],
    )


def test_assemble_shows_masses_limits_and_what_is_exact(run) -> None:
    result = run("assemble", "lwa4p-payload")
    assert (result.returncode, result.stderr) == (0, "")
    for title in ("Modules of", "Standard D-H table", "Links, their masses", "static gravity"):
        assert title in result.stdout
    assert all(len(line) <= 80 for line in result.stdout.splitlines())


def test_a_robot_file_in_another_folder_works_as_the_built_in_one(run, tmp_path: Path) -> None:
    text = "modrobust: 1\nrobot: arm\nchain: [lwa4p-paper-link-1]\ncontroller: {K_r: 10}\n"
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "arm.yaml").write_text(text)
    result = run("assemble", "robots/arm.yaml", "--json")
    assert [joint["name"] for joint in json.loads(result.stdout)["joints"]] == [
        "lwa4p-paper-link-1.axis"
    ]


def test_simulate_answers_1_when_epsilon_is_not_reached_and_says_so(run, tmp_path: Path) -> None:
    (tmp_path / "still.csv").write_text("0,0\n0.02,0\n")
    (tmp_path / "far.yaml").write_text(
        "modrobust: 1\nrobot: far\nchain: [lwa4p-paper-link-1]\n"
        "controller: {law: norm}\nloop: {rate: 50 kHz}\n"
        "trajectory: {kind: csv, file: still.csv}\ninitial: {q: 0.1, dq: 0}\n"
    )
    result = run("simulate", "far.yaml")
    assert result.returncode == 1
    assert "FAIL: the tracking error did not stay below epsilon = 0.01" in result.stdout
    assert "violations             0 of 1001 ticks, of the bound" in result.stdout


def test_simulate_says_what_the_file_says_of_the_scenario(run) -> None:
    text = " ".join(run(*SHORT).stdout.split())
    assert "Scenario 1: Table II, scenario 1, an object of 0.7 kg in the hand" in text


def test_schema_takes_json_as_every_command_does(run) -> None:
    plain, asked = run("schema", "module"), run("schema", "module", "--json")
    assert (asked.returncode, asked.stdout, asked.stderr) == (0, plain.stdout, "")


def test_simulate_prints_json_and_saves_the_run(run, tmp_path: Path) -> None:
    result = run(*SHORT, "--bound", "ianea", "--log", "run.npz", "--json")
    figures = json.loads(result.stdout)
    assert (result.returncode, result.stderr) == (0, "")
    assert figures["cut_short"]  # 20 ms of the 10 s of (13)
    assert (figures["violations"], figures["diverged"]) == (0, False)
    assert figures["settings"]["bound"] == "ianea"
    with np.load(tmp_path / "run.npz") as log:
        assert log["t"][-1] == 0.02
        assert (log["phi_lo"] <= log["w"]).all()
    assert os.listdir(tmp_path) == ["run.npz"]


def test_simulate_follows_a_motion_from_a_file(run, tmp_path: Path) -> None:
    rows = [f"{t},{','.join([str(0.01 * t)] * 6)}" for t in range(4)]
    (tmp_path / "motion.csv").write_text("\n".join(rows))
    result = run("simulate", "lwa4p-paper", "--trajectory", "motion.csv", "--json")
    assert result.returncode == 0
    assert json.loads(result.stdout)["settings"]["duration"] == 3.0


def test_bench_gives_times_tightness_and_growth_as_json(run) -> None:
    result = run("bench", "--growth", "--repeat", "1", "--json")
    assert (result.returncode, result.stderr) == (0, "")
    figures = json.loads(result.stdout)
    (robot,) = figures["robots"]
    assert [item["bound"] for item in robot["times"]] == ["hull", "ianea"]
    for item in robot["times"]:
        assert 0.0 < item["in_c"]["min"] < item["in_python"]["min"]
    for item in robot["tightness"]:
        assert all(ratio >= 1.0 for ratio in item["ianea_over_hull"])
    assert [item["joints"][-1] for item in figures["growth"]] == [256, 256]


def test_modules_lists_the_catalogue_with_what_mates_to_what(run) -> None:
    result = run("modules", "--json")
    assert (result.returncode, result.stderr) == (0, "")
    modules = {module["module"]: module for module in json.loads(result.stdout)}
    assert sum(module["product"] for module in modules.values()) >= 30
    assert all(module["source"] for module in modules.values())
    assert modules["hebi-link-x5-325"]["licence"]
    assert None in [module["licence"] for module in modules.values()]
    assert "schunk-link-350" in modules["schunk-pb-large-1"]["mounts"]
    assert "hebi-x5-1" not in modules["schunk-pb-large-1"]["mounts"]
    table = run("modules").stdout
    assert all(module in table for module in modules)


def test_modules_of_a_folder(run, tmp_path: Path) -> None:
    assert run("modules", str(tmp_path)).stdout.startswith("0 modules")
    assert run("modules", "nowhere").stderr == (
        "nowhere: no such directory; give a directory with module files\n"
    )


def on_a_terminal(folder: Path, **environment_changes: str) -> str:
    """What a short, bad simulation shows on a terminal."""
    terminal, inner = pty.openpty()
    subprocess.run(
        [*COMMAND, *SHORT],
        cwd=folder,
        env=environment(TERM="xterm", COLUMNS="80", **environment_changes),
        stdin=subprocess.DEVNULL,
        stdout=inner,
        check=False,
    )
    os.close(inner)
    shown = b""
    try:
        while data := os.read(terminal, 4096):
            shown += data
    except OSError:  # read to the end
        pass
    os.close(terminal)
    return shown.decode()


def test_colour_is_for_terminals_and_not_where_no_color_is_set(run, tmp_path: Path) -> None:
    red = re.compile(r"\x1b\[[0-9;]*3\dm")
    assert red.search(on_a_terminal(tmp_path))
    assert not red.search(on_a_terminal(tmp_path, NO_COLOR="1"))
    assert "\x1b" not in run(*SHORT).stdout


def columns_of(folder: Path, width: int, *arguments: str) -> str:
    done = subprocess.run(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(COLUMNS=str(width)),
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


@pytest.mark.parametrize("width", [20, 40])
def test_numbers_stay_whole_in_a_narrow_terminal(tmp_path: Path, width: int) -> None:
    wide, narrow = (columns_of(tmp_path, w, "assemble", "scara") for w in (200, width))
    for row in re.findall(r"^ (?:arm|quill|wrist)\S+  .*", wide, re.MULTILINE):
        numbers = re.split(r"  +", row.strip())[3:]
        assert all(number in narrow for number in numbers)
        assert any(all(n in line for n in numbers) for line in narrow.splitlines())


def test_the_mounting_is_shown_and_always_which_way_gravity_points(run) -> None:
    text = run("assemble", "concert-wall").stdout
    assert "Base in the world: xyz [0 0 1.2] m, rpy [0 90 0] deg.\n" in text
    assert "Gravity in base axes: [9.81 0 0] m/s^2, along +x.\n" in text
    assert "\nD-H base [" in text
    assert "\nD-H tool [" in text
    text = run("assemble", "lwa4p-paper").stdout
    assert "Gravity in base axes: [0 0 -9.81] m/s^2, along -z.\n" in text
    assert "Base in the world" not in text


def test_gravity_of_another_place_is_shown_without_a_mounting(run, tmp_path: Path) -> None:
    text = "modrobust: 1\nrobot: moon\ngravity: [0, 0, -1.62]\nchain: [schunk-pb-large-1]\n"
    (tmp_path / "moon.yaml").write_text(text)
    shown = run("assemble", "moon.yaml").stdout
    assert "Gravity in base axes: [0 0 -1.62] m/s^2, along -z.\n" in shown
    assert "Base in the world" not in shown


@pytest.mark.parametrize(("value", "bold"), [("", True), ("1", False)])
def test_no_color_leaves_plain_text_on_a_terminal(tmp_path: Path, value: str, bold: bool) -> None:
    terminal, inner = pty.openpty()
    done = subprocess.Popen(
        [*COMMAND, "assemble", "scara"],
        cwd=tmp_path,
        env=environment(NO_COLOR=value, TERM="xterm", COLUMNS="80"),
        stdout=inner,
    )
    os.close(inner)
    shown = b""
    while True:
        try:
            data = os.read(terminal, 65536)
        except OSError:
            break
        if not data:
            break
        shown += data
    os.close(terminal)
    assert done.wait(60) == 0
    assert (b"\x1b[" in shown) is bold
