"""A campaign in figures: the worst case of each, the run that it was seen in, and a verdict."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from modrobust.campaign.figures import Record
from modrobust.simulation.metrics import plain

FIGURES = (
    "violations",
    "late_error",
    "torque_over_limit",
    "late_at_limit",
    "variation_ratio",
    "v_over_limit",
    "step_over_limit",
)
OPENING = "tried, not proved: "


def worst_cases(
    records: Sequence[Record], command: Callable[[int], str]
) -> dict[str, dict[str, Any]]:
    """The worst value of each figure, the first run that has it, and how to see that run again.

    Runs that diverged count under ``diverged`` alone: their other figures follow from that.
    """
    gone = [r.run.index for r in records if r.diverged]
    rows: dict[str, dict[str, Any]] = {
        "diverged": {"worst": len(gone), "run": min(gone, default=None)}
    }
    for name in FIGURES:
        known = [
            (getattr(r, name), -r.run.index)
            for r in records
            if getattr(r, name) is not None and not (r.diverged and name != "violations")
        ]
        value, index = max(known, default=(None, None))
        unseen = not value
        rows[name] = {"worst": value, "run": None if unseen or index is None else -index}
    for row in rows.values():
        row["command"] = None if row["run"] is None else command(row["run"])
    return rows


def verdict(records: Sequence[Record], wanted: int, epsilon: float) -> str:
    """One sentence on what was tried; nothing is proved of what was not."""
    count = len(records)
    opening = OPENING if count == wanted else f"{OPENING}{count} of {wanted} runs done; "
    if not count:
        return f"{opening}nothing was tried"
    parts = []
    diverged = sum(r.diverged for r in records)
    bad = sum(not r.good for r in records) - diverged
    violated = sum(r.violations > 0 for r in records)
    missed = sum(r.good and not r.meets for r in records)
    if diverged:
        parts.append(f"{diverged} diverged")
    if bad:
        parts.append(f"{bad} did not settle or stayed at a torque limit")
    if violated:
        parts.append(f"the bound was violated in {violated}")
    if missed:
        parts.append(f"{missed} did not stay below epsilon = {epsilon:g}")
    if parts:
        return f"{opening}of {count} run{'s' * (count != 1)}, {', '.join(parts)}"
    every = "the run" if count == 1 else f"every one of {count} runs"
    return f"{opening}{every} kept the bound and stayed below epsilon = {epsilon:g}"


def counts(records: Sequence[Record]) -> dict[str, int]:
    """How many runs were good, met epsilon, and had too little torque for any motion."""
    return {
        "runs": len(records),
        "good": sum(r.good for r in records),
        "meets": sum(r.meets for r in records),
        "infeasible": sum(not r.feasible for r in records),
    }


def plain_rows(rows: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Worst cases, ready for JSON."""
    result: dict[str, Any] = plain(rows)
    return result


def shown(value: float | int | None) -> str:
    """A figure for a table: four digits."""
    if value is None:
        return "-"
    if isinstance(value, int):
        return str(value)
    return f"{value:.4g}" if math.isfinite(value) else "-"
