"""Help, version, usage errors, the split of stdout and stderr."""

from __future__ import annotations

import json
import os
import re

import pytest

from modrobust.cli import main

COMMANDS = [
    *("assemble", "design", "simulate", "campaign", "bench"),
    *("modules", "schema", "import-timor"),
]


def test_help_names_every_command_and_gives_examples(run) -> None:
    result = run("--help")
    assert (result.returncode, result.stderr) == (0, "")
    for command in COMMANDS:
        assert re.search(rf"^  {command}  ", result.stdout, re.MULTILINE)
    assert "modrobust simulate lwa4p-paper --scenario 1" in result.stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_help_with_examples(run, command: str) -> None:
    result = run(command, "--help")
    assert (result.returncode, result.stderr) == (0, "")
    assert re.search(rf"Examples:\n  +modrobust {command}", result.stdout)


def test_version_goes_to_stdout(run) -> None:
    result = run("--version")
    assert (result.returncode, result.stderr) == (0, "")
    assert re.fullmatch(r"modrobust \d+\.\d+\.\d+\n", result.stdout)


@pytest.mark.parametrize(
    "arguments", [["nonsense"], ["schema", "nonsense"], ["assemble"], ["simulate", "--wrong"]]
)
def test_wrong_usage_exits_with_2_and_says_nothing_on_stdout(run, arguments: list[str]) -> None:
    result = run(*arguments)
    assert (result.returncode, result.stdout) == (2, "")
    assert "Traceback" not in result.stderr
    assert result.stderr.startswith("Usage: modrobust ")


@pytest.mark.parametrize("kind", ["module", "assembly"])
def test_schema_is_a_json_schema(run, kind: str) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    result = run("schema", kind)
    assert (result.returncode, result.stderr) == (0, "")
    jsonschema.Draft202012Validator.check_schema(json.loads(result.stdout))


def test_what_slows_the_start_is_off_unless_the_user_has_set_it(monkeypatch) -> None:
    monkeypatch.setattr("modrobust.cli._guarded", lambda: 0)
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    monkeypatch.setenv("PYDANTIC_DISABLE_PLUGINS", "")  # so that it is put back afterwards
    monkeypatch.delenv("PYDANTIC_DISABLE_PLUGINS")
    with pytest.raises(SystemExit):
        main()
    assert os.environ["OPENBLAS_NUM_THREADS"] == "2"
    assert os.environ["PYDANTIC_DISABLE_PLUGINS"] == "__all__"
