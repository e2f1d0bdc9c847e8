"""What stands beside the code: the hooks, the citation, the form for an unsound bound."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[1]
SUFFIXES = {"c": (".c", ".h"), "c++": (".cpp",)}


def yaml_of(name: str) -> Any:
    return YAML(typ="safe").load((ROOT / name).read_text(encoding="utf-8"))


def project() -> dict[str, Any]:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    return dict(tomllib.loads(text)["project"])


def files(types: list[str]) -> list[str]:
    """Those that a hook gets when all files are asked about."""
    suffixes = tuple(suffix for kind in types for suffix in SUFFIXES[kind])
    found = (path for folder in ("src", "tests") for path in (ROOT / folder).rglob("*"))
    return sorted(str(path.relative_to(ROOT)) for path in found if path.name.endswith(suffixes))


def test_the_hooks_run_what_make_lint_runs() -> None:
    """Else a commit passes here that is refused there."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed")
    command = ["make", "-n", "lint", "--assume-old=.venv/.installed-test"]
    wanted = subprocess.check_output(command, cwd=ROOT, text=True).splitlines()
    (group,) = yaml_of(".pre-commit-config.yaml")["repos"]
    found = [
        [*shlex.split(hook["entry"]), *(files(hook["types_or"]) if names else ())]
        for hook in group["hooks"]
        for names in [hook.get("pass_filenames", True)]
    ]
    assert found == [shlex.split(line) for line in wanted if not line.startswith("make")]


def test_tools_whose_answers_change_with_their_version_are_pinned() -> None:
    test = project()["optional-dependencies"]["test"]
    for tool in ("clang-format", "mypy", "ruff"):
        (requirement,) = (line for line in test if re.split(r"[=<>~]", line)[0] == tool)
        assert re.fullmatch(r"[a-z-]+==\d+\.\d+\.\*", requirement)


def test_the_citation_names_this_version_and_licence() -> None:
    citation = yaml_of("CITATION.cff")
    for key in ("version", "license"):
        assert citation[key] == project()[key]
    assert citation["title"] == project()["name"]


def test_the_form_for_an_unsound_bound_asks_for_what_repeats_it() -> None:
    form = yaml_of(".github/ISSUE_TEMPLATE/unsound-bound.yml")
    required = {
        part["id"] for part in form["body"] if part.get("validations", {}).get("required", False)
    }
    assert {"file", "seed", "command", "output", "version"} <= required
    output = next(part for part in form["body"] if part.get("id") == "output")
    assert "--json" in output["attributes"]["label"]
    (named,) = re.findall(r"form \*(.*?)\*", (ROOT / "SECURITY.md").read_text(encoding="utf-8"))
    assert named == form["name"]
