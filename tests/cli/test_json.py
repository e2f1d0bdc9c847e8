"""What ``--json`` prints is what docs/reference/json.md describes: every key, and no other."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import modrobust as mr
from cli.json_schemas import SCHEMAS, keys
from modrobust.bench.benchmark import benchmark
from modrobust.bench.peers import PeerReport
from modrobust.bench.peers.timing import Comparison, Timing
from modrobust.cli.output import words
from support.paths import ROOT
from support.urdf_texts import LIMIT, joint, link, robot, written

PAGE = (ROOT / "docs" / "reference" / "json.md").read_text(encoding="utf-8")
SHORT = ("simulate", "lwa4p-paper", "--duration", "20ms")
GRIPPER = robot(
    link("base", ""), link("a"), link("b"),
    joint("one", "base", "a"),
    joint("two", "a", "b", inside='<axis xyz="0 1 0"/>' + LIMIT + '<mimic joint="one"/>'),
)  # fmt: skip


def check(command: str, figures: Any) -> None:
    Draft202012Validator(SCHEMAS[command]).validate(json.loads(json.dumps(figures)))


def section(command: str) -> str:
    """What the page says of a command."""
    found = re.search(rf"^## `{command}.*?(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)
    assert found is not None, command
    return found[0]


@pytest.mark.parametrize("command", SCHEMAS)
def test_the_page_names_every_key_and_no_other(command: str) -> None:
    Draft202012Validator.check_schema(SCHEMAS[command])
    table = re.findall(r"^\| (`.+?) \|", section(command), re.MULTILINE)
    rest = re.findall(r"`([^`]*)`", section(command))
    named = {name for text in rest for name in re.findall(r"\w+", text)}
    assert keys(SCHEMAS[command]) <= named
    first = {name for cell in table for name in re.findall(r"\w+", cell)}
    assert first <= keys(SCHEMAS[command])


@pytest.mark.parametrize("name", ["lwa4p-payload", "scara", "small.urdf"])
def test_assemble(run, tmp_path: Path, name: str) -> None:
    written(tmp_path, GRIPPER)
    figures = json.loads(run("assemble", name, "--json").stdout)
    check("assemble", figures)
    assert ("mimic" in figures["joints"][-1]) is (name == "small.urdf")


@pytest.mark.parametrize(
    "options",
    [
        (),
        ("--scenario", "1"),
        ("--trajectory", "quintic"),
        ("--trajectory", "rest.csv"),
        ("--parameters", "upper", "--seed", "3"),
        ("--rate", "1kHz", "--duration", "1s"),  # diverges
    ],
)
def test_simulate(run, tmp_path: Path, options: tuple[str, ...]) -> None:
    (tmp_path / "rest.csv").write_text("0,0,0,0,0,0,0\n9,0,0,0,0,0,0\n")
    figures = json.loads(run(*SHORT, *options, "--json").stdout)
    check("simulate", figures)
    assert figures["diverged"] is ("--rate" in options)


def test_a_run_that_was_interrupted_before_anything_has_the_same_keys() -> None:
    def stop(done: float, total: float) -> None:
        raise KeyboardInterrupt

    result = mr.simulate(mr.load_robot("lwa4p-paper"), duration=1.0, progress=stop)
    assert result.interrupted
    check("simulate", result.summary())
    nothing: dict[str, Any] = vars(result) | {"statistics": None, "t": np.zeros(0)}
    empty: dict[str, Any] = {
        k: np.zeros((0, 6)) if np.ndim(v) == 2 else v for k, v in nothing.items()
    }
    fields = type(result).__dataclass_fields__
    check("simulate", type(result)(**{k: v for k, v in empty.items() if k in fields}).summary())


def test_bench() -> None:
    arm = mr.load_robot("scara")
    result = benchmark([arm], repeat=1, sizes=(2, 16, 18), states=3, duration=0.02)
    assert result.robots[0].times
    check("bench", result.to_dict())
    check("bench", benchmark([], sizes=()).to_dict())


def test_bench_of_peers() -> None:
    seconds = np.array([[1e-6, 2e-6]])
    timings = (Timing("ours", seconds[0], seconds), Timing("peer", seconds[0]))
    report = PeerReport("arm", 2, {"Peer": Comparison("a title", timings, "peer")}, {"Other": "x"})
    check("bench --peers", [report.to_dict()])


def test_modules(run) -> None:
    figures = json.loads(run("modules", "--json").stdout)
    assert len(figures) > 40
    check("modules", figures)


def test_import_timor() -> None:
    check("import-timor", {"written": ["a.yaml"], "left_out": [{"module": "b", "why": "c"}]})


def test_tables_say_the_words_of_the_keys(run) -> None:
    """Each label of a table of `simulate` is a key of its JSON, or a part of one."""
    text = run(*SHORT, "--json").stdout
    known = {words(key) for key in json.loads(text)}
    shown = run(*SHORT).stdout
    labels = re.findall(r"^ ([a-z][a-z ]*?)  +\S", shown, re.MULTILINE)
    header = next(line for line in shown.splitlines() if line.startswith(" joint "))
    labels += re.split(r"  +", header.strip())
    assert {"violations", "rho mean", "tau max", "width hull", "ianea/hull"} <= set(labels)
    assert set(labels) - {"joint"} <= known
