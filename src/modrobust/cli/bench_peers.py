"""What ``modrobust bench --peers`` prints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


def print_peers(figures: Mapping[str, Any]) -> None:
    """Print one robot's comparisons: times, ratios to the peer, single calls in C."""
    from modrobust.cli.output import microseconds, number, show, table

    show(f"{figures['robot']}: {figures['joints']} joints", style="bold")
    for entry in figures["peers"]:
        rows = table("", "minimum", "median", "ratio of minima", "of medians")
        for item in entry["subjects"]:
            rows.add_row(
                item["name"],
                microseconds(item["minimum"]),
                microseconds(item["median"]),
                number(item["ratio_of_minima"]),
                number(item["ratio_of_medians"]),
            )
        show(f"{entry['peer']}: {entry['title']}", rows)
        alone = [item for item in entry["subjects"] if item["alone"]]
        if alone:
            _print_alone(alone, entry["remarks"])


def _print_alone(subjects: list[Any], remarks: list[str]) -> None:
    """Calls one by one; a state's own time is its minimum, free of what interrupts the machine."""
    from modrobust.cli.output import microseconds, show, table

    rows = table("", "mean", "std", "max", "slowest state")
    for item in subjects:
        calls, states = item["alone"]["calls"], item["alone"]["states"]
        rows.add_row(
            item["name"],
            *(microseconds(calls[key]) for key in ("mean", "std", "max")),
            microseconds(states["max"]),
        )
    show(f"Each call by itself ({'; '.join(remarks)})", rows)
