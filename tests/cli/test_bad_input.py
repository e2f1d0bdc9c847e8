# ruff: noqa: E501  messages stand here as one line, as they are printed
"""Bad input ends with exit code 2, one message, no traceback, nothing on stdout, no file left.

Every message is pinned: a changed wording is a change to review.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROBOT = """\
modrobust: 1
robot: arm
chain: [lwa4p-paper-link-1]
controller: {K_r: 10}
"""
MODULE = """\
modrobust: 1
module: link
name: A link
source: made up for a test
connectors:
  in: {type: t}
  out: {type: t}
chain:
  - joint: axis
    type: revolute
  - body: rod
    mass: 1 kg
    com: [0, 0, 0.1 m]
    inertia: {xx: 0.01, yy: 0.01, zz: 0.01}
"""
ASSEMBLY_OF_LINK = "modrobust: 1\nrobot: arm\nmodules: .\nchain: [link]\n"


def refused(run, message: str, *arguments: str) -> None:
    """The command says exactly `message`, exits with 2 and leaves no file."""
    folder = run.args[0]
    before = sorted(os.listdir(folder))
    result = run(*arguments)
    assert result.stderr == f"{message}\n"
    assert (result.returncode, result.stdout) == (2, "")
    assert sorted(os.listdir(folder)) == before


@pytest.mark.parametrize("command", ["assemble", "simulate", "bench"])
def test_a_missing_file_is_refused(run, command: str) -> None:
    refused(run, "arm.yaml: no such file; check the path", command, "arm.yaml")


def test_an_unknown_name_is_refused_with_the_names_that_exist(run) -> None:
    refused(
        run,
        'lwa4p-papr: neither a file nor a built-in robot; did you mean "lwa4p-paper"? give a file or one of baxter, concert-wall, gantry, hebi-arm, iiwa, lwa4p, lwa4p-paper, lwa4p-payload, panda, pino-arm, scara, snake12, tiago, ur5',
        "assemble",
        "lwa4p-papr",
    )


def test_no_name_is_refused(run) -> None:
    refused(
        run,
        "robot: an empty text; the name of a built-in robot or the path of a file is expected",
        "assemble",
        "",
    )


def test_a_line_break_in_a_file_name_is_shown_escaped(run) -> None:
    refused(run, "a\\nb.yaml: no such file; check the path", "assemble", "a\nb.yaml")


def test_a_directory_is_refused(run, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").mkdir()
    refused(
        run,
        "arm.yaml: is a directory; a description is one file; name the file in it",
        "assemble",
        "arm.yaml",
    )


def test_a_wrong_suffix_is_refused(run, tmp_path: Path) -> None:
    (tmp_path / "arm.txt").write_text(ROBOT)
    refused(
        run,
        'arm.txt: suffix ".txt"; a description ends in .yaml, .yml or .json; rename or convert it',
        "assemble",
        "arm.txt",
    )


def test_a_binary_file_is_refused(run, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_bytes(b"\x7fELF\x02\x01\x01\x00")
    refused(
        run,
        "arm.yaml: a binary file (it holds NUL bytes); a description is UTF-8 text",
        "assemble",
        "arm.yaml",
    )


def test_an_empty_file_is_refused(run, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text("")
    refused(
        run,
        'arm.yaml: empty; a description starts with "modrobust: 1"; see docs/reference/formats.md',
        "assemble",
        "arm.yaml",
    )


def test_a_yaml_bomb_is_refused(run, tmp_path: Path) -> None:
    lines = ["a: &a [x, x, x, x, x, x, x, x, x]"]
    for last, name in zip("abcdefgh", "bcdefghi", strict=True):
        lines.append(f"{name}: &{name} [{', '.join([f'*{last}'] * 9)}]")
    (tmp_path / "arm.yaml").write_text("\n".join(lines))
    refused(
        run,
        'arm.yaml:1: a: anchor "&a"; aliases and anchors are not allowed, because they can expand without end; write the value out where it is needed',
        "assemble",
        "arm.yaml",
    )


def test_a_module_cycle_is_refused(run, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(ASSEMBLY_OF_LINK)
    for name, inner in (("link", "other"), ("other", "link")):
        (tmp_path / f"{name}.yaml").write_text(
            MODULE.replace("module: link", f"module: {name}").replace(
                "  - joint: axis\n    type: revolute\n", f"  - module: {inner}\n"
            )
        )
    refused(
        run,
        "other.yaml:9: chain[0]: module cycle link -> other -> link; a module cannot contain itself; remove this entry",
        "assemble",
        "arm.yaml",
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "1 kg",
            "1 m",
            'link.yaml:12: body rod, mass: "1 m" has the unit "m"; a mass [kg] is expected; write it in kg',
        ),
        (
            "1 kg",
            ".nan kg",
            'link.yaml:12: body rod, mass: ".nan kg" is not a number; numbers are finite; write a finite number',
        ),
        (
            "1 kg",
            "inf kg",
            'link.yaml:12: body rod, mass: "inf kg" is infinite; numbers are finite; write a finite number',
        ),
        (
            "[0, 0, 0.1 m]",
            "[0, 0.1 m]",
            "link.yaml:13: body rod, com: a list of 2; a vector is a list of three; write [x, y, z]",
        ),
        (
            "mass: 1 kg",
            "mas: 1 kg",
            'link.yaml:12: body rod: unknown key "mas"; did you mean "mass"? known: body, span, expressed_in, mass, com, inertia',
        ),
        (
            "mass: 1 kg",
            "mass: -1 kg",
            "link.yaml:12: body rod, mass: -1 kg is negative; a body's mass is at least 0; write 0 or more",
        ),
    ],
)
def test_a_wrong_module_is_refused_at_its_line(
    run, tmp_path: Path, old: str, new: str, message: str
) -> None:
    (tmp_path / "arm.yaml").write_text(ASSEMBLY_OF_LINK)
    (tmp_path / "link.yaml").write_text(MODULE.replace(old, new))
    refused(run, message, "assemble", "arm.yaml")


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("--duration=-1", "--duration: -1 s; must be positive and finite; such as 10 s"),
        ("--duration=-1 s", "--duration: -1 s; must be positive and finite; such as 10 s"),
        ("--duration=0", "--duration: 0 s; must be positive and finite; such as 10 s"),
        (
            "--duration=nan",
            '--duration: "nan" is not a number; numbers are finite; write a finite number',
        ),
        (
            "--duration=10 kg",
            '--duration: "10 kg" has the unit "kg"; a time [s] is expected; write it in s',
        ),
        (
            "--rate=nan",
            '--rate: "nan" is not a number; numbers are finite; write a finite number',
        ),
        (
            "--rate=0",
            "--rate: 0 Hz; must lie in [1, 1e+07] Hz; most drives take 250 to 4000",
        ),
        (
            "--duration=1e-9s",
            "--duration: 1e-09 s is less than one tick of 50000 Hz; make it longer",
        ),
        ("--scenario=3", '--scenario: no scenario "3"; known: 1, 2'),
        (
            "--trajectory=quintc",
            '--trajectory: no trajectory "quintc"; did you mean "quintic"? known: paper, quintic, FILE.csv, quintic:FILE.csv',
        ),
        ("--trajectory=no.csv", "no.csv: no such file; give the path of a CSV file of t and q"),
        ("--log=run.txt", 'run.txt: suffix ".txt"; a log ends in .npz; name it so'),
        ("--log=no/run.npz", "no/run.npz: no directory no; make it first"),
    ],
)
def test_a_wrong_option_is_refused(run, option: str, message: str) -> None:
    refused(run, message, "simulate", "lwa4p-paper", option)


def test_a_seed_beside_a_scenario_is_refused(run) -> None:
    message = '--seed: given beside scenario "1", which draws nothing; give one of both'
    refused(run, message, *("simulate", "lwa4p-paper", "--scenario", "1", "--seed", "4"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["simulate", "a", "--bound", "hul"], "'--bound': 'hul' is not one of 'hull', 'ianea'."),
        (["schema", "foo"], "'kind': 'foo' is not one of 'module', 'assembly'."),
        (["simulate", "a", "--seed", "x"], "'--seed': must be a valid integer"),
        (["bench", "--repeat", "0"], "'--repeat': must be greater than or equal to 1"),
    ],
)
def test_a_value_that_is_not_allowed_is_refused_in_plain_words(
    run, arguments: list[str], message: str
) -> None:
    result = run(*arguments)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.splitlines()[-1] == f"Error: Invalid value for {message}"


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ("resolved.txt", 'resolved.txt: suffix ".txt"; a resolved robot ends in .json; name it so'),
        ("no/resolved.json", "no/resolved.json: no directory no; make it first"),
        ("folder.json", "folder.json: is a directory; give the name of a file in it"),
        (
            "/proc/resolved.json",
            "/proc/resolved.json: cannot be written: No such file or directory; choose another place",
        ),
    ],
)
def test_an_unwritable_output_is_refused(run, tmp_path: Path, output: str, message: str) -> None:
    (tmp_path / "folder.json").mkdir()
    refused(run, message, "assemble", "lwa4p-paper", "-o", output)


def test_a_wrong_file_leaves_the_output_as_it_was(run, tmp_path: Path) -> None:
    (tmp_path / "resolved.json").write_text("before")
    refused(
        run, "arm.yaml: no such file; check the path", "assemble", "arm.yaml", "-o", "resolved.json"
    )
    assert (tmp_path / "resolved.json").read_text() == "before"


def test_a_csv_row_of_wrong_length_is_refused_at_its_line(run, tmp_path: Path) -> None:
    (tmp_path / "motion.csv").write_text("0,0,0,0,0,0,0\n1,0,0,0,0,0\n")
    refused(
        run,
        "motion.csv:2: 6 columns; expected 7: t and one position for each of 6 joints, separated by commas",
        "simulate",
        "lwa4p-paper",
        "--trajectory",
        "motion.csv",
    )
