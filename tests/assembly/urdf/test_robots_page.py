"""docs/measured/robots.md, made by benchmarks/robots_table.py: its robots are those that load."""

from __future__ import annotations

import re

from support.paths import ROOT
from support.real_robots import LOADED, REFUSED

PAGE = (ROOT / "docs" / "measured" / "robots.md").read_text(encoding="utf-8")


def rows(part: str) -> list[list[str]]:
    """Cells of a table's rows, without its head."""
    lines = [line for line in part.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines[2:]]


def test_the_table_holds_the_robots_that_load_with_their_joints_and_no_violation() -> None:
    table = rows(PAGE.partition("## Refused")[0])
    shown = {(row[1], row[0]): int(row[2].partition("+")[0]) for row in table}
    assert shown == {(p, name): n for p, names in LOADED.items() for name, n in names.items()}
    assert {row[9] for row in table} == {"0"}
    assert all(float(row[10]) < float(row[8]) for row in table)  # epsilon entered permanently


def test_the_refused_are_listed_with_their_reasons() -> None:
    table = rows(PAGE.partition("## Refused")[2])
    shown = {(row[1], row[0]): row[2].replace("&lt;", "<") for row in table}
    assert shown.keys() == REFUSED.keys()
    for key, reason in REFUSED.items():
        assert reason in shown[key]
