"""The scripts of benchmarks/: what they put together and what they print, without measuring."""

from __future__ import annotations

import sys
from types import ModuleType

import numpy as np
import pytest

from modrobust.bench.peers.timing import Comparison, Timing
from modrobust.errors import MissingExtraError
from modrobust.model import Robot
from support.paths import ROOT

SCRIPTS = ROOT / "benchmarks"
NAMES = ("common", "growth", "worst_case", "batch", "performance_page")


@pytest.fixture
def scripts(monkeypatch: pytest.MonkeyPatch) -> dict[str, ModuleType]:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    modules = {name: __import__(name) for name in NAMES}
    for name in NAMES:  # names as short as these must not stay
        monkeypatch.delitem(sys.modules, name)
    return modules


def test_every_script_says_how_it_is_run() -> None:
    for path in SCRIPTS.glob("*.py"):
        if path.name != "common.py":
            assert f"python benchmarks/{path.name}" in path.read_text(encoding="utf-8")


def test_a_peer_that_is_missing_is_skipped_with_its_remedy(
    scripts: dict[str, ModuleType],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def absent(robot: Robot) -> Comparison:
        raise MissingExtraError('pip install "modrobust[peers]" brings it')

    monkeypatch.setattr("sys.argv", ["script"])
    scripts["common"].main("peer", absent)
    assert 'skipped: pip install "modrobust[peers]" brings it' in capsys.readouterr().out


def test_only_the_last_bodies_are_uncertain_at_the_tip(scripts: dict[str, ModuleType]) -> None:
    robot = scripts["growth"].uncertain_at_the_tip(4, 1)
    assert (robot.upper.mass > robot.lower.mass).tolist() == [False, False, False, True]
    wide = (robot.upper.com > robot.lower.com).all(axis=1)
    assert wide.tolist() == [False, False, False, True]
    exact = scripts["growth"].uncertain_at_the_tip(4, 0)
    assert np.array_equal(exact.lower.packed, exact.upper.packed)


def test_the_page_has_a_row_for_each_subject_and_three_columns_a_compiler(
    scripts: dict[str, ModuleType],
) -> None:
    compared = Comparison(
        "", (Timing("theirs", np.array([2e-6])), Timing("ours", np.array([1e-6]))), "theirs"
    )
    page = scripts["performance_page"].compared({"gcc": compared, "clang": compared})
    assert page.splitlines() == [
        "| [us] | gcc | ratio of minima | of medians | clang | ratio of minima | of medians |",
        "|---|---|---|---|---|---|---|",
        "| theirs | 2 | 1 | 1 | 2 | 1 | 1 |",
        "| ours | 1 | 0.5 | 0.5 | 1 | 0.5 | 0.5 |",
    ]


@pytest.mark.parametrize(
    ("said", "number"),
    [
        ("gcc (Debian 12.2.0-14+deb12u1) 12.2.0", "12.2.0"),
        ("Debian clang version 14.0.6", "14.0.6"),
        ("Apple clang version 15.0.0 (clang-1500.3.9.4)", "15.0.0"),
    ],
)
def test_a_compilers_version_is_its_number(
    scripts: dict[str, ModuleType], said: str, number: str
) -> None:
    assert scripts["performance_page"].version(said) == number
