"""What `simulate` says after its verdict, and above it of the motion."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

SHAKING = """
modrobust: 1
robot: shaking
chain: [schunk-pb-large-1]
controller: {kappa_P: 300, kappa_I: 10, phi_P: 0, phi_I: 1}
"""


def test_a_torque_that_shakes_is_the_last_line_and_leaves_the_exit_code(
    run, tmp_path: Path
) -> None:
    (tmp_path / "shaking.yaml").write_text(SHAKING)
    result = run("simulate", "shaking.yaml", "--duration", "5s", "--rate", "20kHz")
    last = result.stdout[result.stdout.rindex("PASS: ") :]
    last = last[last.index("Note: ") :]
    assert result.returncode == 0
    words = " ".join(last.split())
    assert words.startswith('Note: the torque chatters, joint "schunk-pb-large-1.axis')
    assert words.endswith("at 10 Hz (limit 1.1); raise phi_P, lower kappa_P")
    again = run(*("simulate", "shaking.yaml", "--duration", "5s", "--rate", "20000", "--json"))
    figures = json.loads(again.stdout)
    assert (again.returncode, figures["ok"], len(figures["remarks"])) == (0, True, 1)
    assert f"Note: {figures['remarks'][0]}" == words


@pytest.mark.parametrize(
    ("arguments", "motion"),
    [
        (["lwa4p-paper"], "the file's own, sines"),
        (["shaking.yaml"], "the default, quintic through seeded waypoints, seed 0"),
        (["lwa4p-paper", "--trajectory", "quintic"], "the default, quintic through seeded"),
        (["lwa4p-paper", "--trajectory", "paper"], "(13) of the paper"),
        (["shaking.yaml", "--trajectory", "rest.csv"], "rest.csv"),
    ],
)
def test_the_heading_names_the_motion(
    run, tmp_path: Path, arguments: list[str], motion: str
) -> None:
    (tmp_path / "shaking.yaml").write_text(SHAKING)
    (tmp_path / "rest.csv").write_text("0,0,0\n1,0,0\n")
    result = run("simulate", *arguments, "--duration", "2ms")
    assert result.stdout.splitlines()[1].startswith(f"Motion: {motion}")


def test_help_says_that_remarks_leave_the_exit_code_and_what_moves_by_default(run) -> None:
    text = " ".join(run("simulate", "--help").stdout.split())
    assert "Remarks at the end" in text
    assert "do not change it" in text
    assert "a default within the limits" in text
    assert 'The file\'s "initial:" state counts only with' in text
