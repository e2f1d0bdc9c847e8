"""URDFs and Timor's modules on the command line."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from support.urdf_texts import INERTIAL, LIMIT, joint, link, robot, written

AXIS = '<origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>' + LIMIT
ARM = robot(
    link("base", ""), link("a"), link("b"), link("tool", ""), link("finger"),
    joint("one", "base", "a", inside=AXIS), joint("two", "a", "b", inside=AXIS),
    joint("end", "b", "tool", "fixed", '<origin xyz="0 0 0.2"/>'),
    joint("grip", "tool", "finger", inside=AXIS),
)  # fmt: skip
OPTIONS = (
    "arm.urdf", "--lock", "grip=0.5", "--tolerance", "mass=5%,com=5mm,inertia=10%",
    "--payload", "mass=[0 kg, 1 kg], com=[0, 0, [10 mm, 30 mm]], at=tool",
)  # fmt: skip


def test_assemble_shows_and_resolves_a_urdf(run, tmp_path: Path) -> None:
    written(tmp_path, ARM, "arm.urdf")
    result = run("assemble", *OPTIONS, "--json")
    assert (result.returncode, result.stderr) == (0, "")
    resolved = json.loads(result.stdout)
    assert [item["name"] for item in resolved["joints"]] == ["one", "two"]
    assert [item["name"] for item in resolved["bodies"]] == ["a", "b", "finger", "payload"]
    assert resolved["bodies"][0]["mass"]["lo"] <= 1.9
    shown = run("assemble", "arm.urdf", "--tip", "b")
    assert (shown.returncode, shown.stderr) == (0, "")
    assert "no bounds are given" in shown.stdout
    assert "left out behind joint end" in " ".join(shown.stdout.split())


def test_simulate_closes_the_loop_on_a_urdf(run, tmp_path: Path) -> None:
    written(tmp_path, ARM, "arm.urdf")
    result = run("simulate", *OPTIONS, "--duration", "1s", "--json")
    assert json.loads(result.stdout)["violations"] == 0
    assert result.stderr == ""
    result = run("simulate", "arm.urdf", "--base", "a", "--duration", "20ms", "--json")
    assert result.stderr == ("arm.urdf: no bounds are given; every parameter is taken as exact\n")


def test_bench_takes_urdfs_and_their_options(run, tmp_path: Path) -> None:
    written(tmp_path, ARM, "arm.urdf")
    result = run("bench", "arm.urdf", "--lock", "gripp=0")
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == (
        '--lock: gripp: no joint named "gripp"; did you mean "grip"? known: one, two, grip\n'
    )


def test_bad_urdfs_and_options_exit_with_2_and_one_message(run, tmp_path: Path) -> None:
    written(tmp_path, ARM.replace('mass value="2"', 'mass value="-2"', 1), "bad.urdf")
    written(tmp_path, ARM, "arm.urdf")
    assert INERTIAL in ARM
    for arguments, message in (
        (
            ("bad.urdf",),
            "bad.urdf:3: link a, mass: -2 kg is negative; a body's mass is at least 0; write "
            "0 or more",
        ),
        (
            ("arm.urdf", "--lock", "grip"),
            '--lock: "grip" is no JOINT=VALUE; write e.g. --lock finger_joint=0.02',
        ),
        (
            ("arm.urdf", "--lock", "grip=1", "--lock", "grip=2"),
            "--lock: grip is locked twice; give one value",
        ),
        (
            ("arm.urdf", "--tip", "tol"),
            '--tip: no link named "tol"; did you mean "tool"? known: base, a, b, tool, finger',
        ),
        (
            ("lwa4p-paper", "--tolerance", "mass=5%"),
            "--tolerance: a robot of modules; this option is for robots that a URDF describes; "
            "write the tolerance in the module files",
        ),
    ):
        result = run("assemble", *arguments)
        assert (result.returncode, result.stdout, result.stderr) == (2, "", f"{message}\n")


def test_import_timor_writes_modules_that_load(run, tmp_path: Path) -> None:
    away = np.diag([1.0, -1.0, -1.0, 1.0]).tolist()
    ends = [
        {"ID": "in", "pose": away, "gender": "f", "type": "t", "size": []},
        {"ID": "out", "pose": np.eye(4).tolist(), "gender": "m", "type": "t", "size": []},
    ]
    tensor = np.diag([0.01, 0.01, 0.01]).tolist()
    part = {"ID": "b", "mass": 1.0, "r_com": [0, 0, 0.1], "inertia": tensor, "connectors": ends}
    module = {"header": {"ID": "L1", "name": "Link"}, "bodies": [part], "joints": []}
    bad = {"header": {"ID": "L2", "name": "Bad"}, "bodies": [part | {"mass": "x"}], "joints": []}
    database = {"modules": [module, bad], "limit": math.inf}
    (tmp_path / "modules.json").write_text(json.dumps(database))
    result = run("import-timor", "modules.json", "-o", "out")
    assert (result.returncode, result.stdout) == (0, "out/L1.yaml\n")
    assert "L1: body b: inertia taken as about the com" in result.stderr
    assert "modules[1] left out: " in result.stderr
    asked = run("import-timor", "modules.json", "-o", "other", "--json")
    figures = json.loads(asked.stdout)
    assert figures["written"] == ["other/L1.yaml"]
    assert [item["module"] for item in figures["left_out"]] == ["modules[1]"]
    assert asked.stderr == result.stderr
    again = run("import-timor", "modules.json", "-o", "out")
    assert (again.returncode, again.stdout) == (2, "")
    assert again.stderr == (
        "out/L1.yaml: exists; an import overwrites nothing; give an empty folder\n"
    )
