"""The table of times keeps its layout whatever was measured, so that a README can show it."""

from __future__ import annotations

import io

from rich.console import Console

from modrobust.cli.output import times


def header(value: float) -> str:
    console = Console(width=80, file=io.StringIO(), record=True)
    console.print(
        times({"this run": dict.fromkeys(("mean", "max", "std", "p50", "p99"), value)}, "")
    )
    return next(line for line in console.export_text().splitlines() if "mean" in line)


def test_the_columns_stand_still_for_times_of_any_length() -> None:
    found = {header(value) for value in (2e-6, 2.1e-6, 2.13e-6, 0.213e-6, 123e-6, 12.3e-3)}
    assert len(found) == 1
