"""Tables and help at the widths that people have: rows stay whole, summaries too."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from support.command_line import COMMAND, environment

COMMANDS = (
    *("", "assemble", "design", "simulate", "campaign", "bench"),
    *("modules", "schema", "import-timor"),
)
LONG = "the_third_joint_of_the_left_arm_of_the_torso_of_the_robot"
TWO_LINKS = f"""<robot name="arm">
  <link name="base"/>
  <link name="{LONG}_link"><inertial><mass value="1"/><origin xyz="0.1 0 0"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="{LONG}" type="revolute"><parent link="base"/><child link="{LONG}_link"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="50"/></joint>
</robot>
"""


def at(width: int | None, folder: Path, *arguments: str) -> str:
    changes = {} if width is None else {"COLUMNS": str(width)}
    return subprocess.run(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(**changes),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    ).stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_help_fits_in_80_columns(tmp_path: Path, command: str) -> None:
    text = at(80, tmp_path, *filter(None, [command]), "--help")
    assert [line for line in text.splitlines() if len(line) > 80] == []


def test_the_list_of_commands_shows_whole_summaries(tmp_path: Path) -> None:
    lines = at(80, tmp_path, "--help").partition("Commands:\n")[2].splitlines()
    summaries = dict(re.findall(r"^  (\S+)  +(.+)$", "\n".join(lines[:8]), re.MULTILINE))
    assert tuple(summaries) == COMMANDS[1:]
    assert all(text.endswith(".") and not text.endswith("..") for text in summaries.values())


@pytest.mark.parametrize("width", [None, 80, 120])
def test_long_names_do_not_split_the_rows_of_tables(tmp_path: Path, width: int | None) -> None:
    (tmp_path / "arm.urdf").write_text(TWO_LINKS)
    options = ("arm.urdf", "--tolerance", "mass=5%")
    shown = at(width, tmp_path, "assemble", *options)
    shown += at(width, tmp_path, "simulate", *options, "--duration", "10ms")
    rows = [line.split() for line in shown.splitlines() if line.startswith(f" {LONG}")]
    # D-H, links, limits; and the simulation's torques
    assert [len(row) for row in rows] == [5, 5, 11, 8]
    assert rows[1][1] == f"{LONG}_link"


@pytest.mark.parametrize("command", [("assemble",), ("simulate", "--duration", "20ms")])
def test_tables_of_the_papers_robot_fit_in_80_columns(tmp_path: Path, command) -> None:
    name, *options = command
    text = at(80, tmp_path, name, "lwa4p-paper", *options)
    assert [line for line in text.splitlines() if len(line) > 80] == []


def test_the_papers_times_stand_only_under_the_papers_robot(tmp_path: Path) -> None:
    short = ("--duration", "10ms")
    assert "paper (ianea" in at(80, tmp_path, "simulate", "lwa4p-paper", *short)
    assert "paper (ianea" not in at(80, tmp_path, "simulate", "lwa4p", *short)


def test_bench_measures_the_robot_it_is_given_and_no_chains(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(TWO_LINKS)
    options = ("bench", "arm.urdf", "--tolerance", "mass=5%", "--repeat", "1")
    text = at(80, tmp_path, *options)
    assert text.startswith("arm: 1 joints\n")
    assert "paper" not in text
    assert "chains" not in text
    figures = json.loads(at(80, tmp_path, *options, "--json"))
    assert figures["growth"] == []
