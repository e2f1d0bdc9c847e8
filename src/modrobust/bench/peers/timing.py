"""Times of several subjects over the same rounds, and their ratios to one of them.

Machines change their speed while they are measured. Every round therefore runs every subject in
turn, and what is compared are minimum and median times over the rounds of one run.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modrobust.checks.types import Array
from modrobust.simulation.metrics import time_statistics


@dataclass(frozen=True, eq=False)
class Timing:
    """Seconds a call of one subject: the mean of each round, ``(rounds,)`` [s]."""

    name: str
    rounds: Array
    alone: Array | None = None
    """Every call timed by itself, (repeats, states) [s], the clock's own cost included."""

    @property
    def minimum(self) -> float:
        """Least over the rounds [s]."""
        return float(self.rounds.min())

    @property
    def median(self) -> float:
        """Median over the rounds [s]."""
        return float(np.median(self.rounds))


@dataclass(frozen=True, eq=False)
class Comparison:
    """Subjects measured in one run; ``reference`` names the one that the others are related to."""

    title: str
    timings: tuple[Timing, ...]
    reference: str
    disagreement: float | None = None
    """Largest difference between our torques and the peer's, over the largest torque."""
    remarks: tuple[str, ...] = field(default=())

    def timing(self, name: str) -> Timing:
        """The subject of that name."""
        return next(item for item in self.timings if item.name == name)

    def ratio_of_minima(self, name: str) -> float:
        """Minimum time over the reference's."""
        return self.timing(name).minimum / self.timing(self.reference).minimum

    def ratio_of_medians(self, name: str) -> float:
        """Median time over the reference's median."""
        return self.timing(name).median / self.timing(self.reference).median

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {
            "title": self.title,
            "reference": self.reference,
            "disagreement": self.disagreement,
            "remarks": list(self.remarks),
            "subjects": [
                {
                    "name": item.name,
                    "minimum": item.minimum,
                    "median": item.median,
                    "ratio_of_minima": self.ratio_of_minima(item.name),
                    "ratio_of_medians": self.ratio_of_medians(item.name),
                    "rounds": len(item.rounds),
                    "alone": None if item.alone is None else _alone(item.alone),
                }
                for item in self.timings
            ],
        }


def _alone(seconds: Array) -> dict[str, Any]:
    """Statistics over all calls, and over states with each one's minimum: without interruptions."""
    return {
        "calls": time_statistics(seconds.ravel()),
        "states": time_statistics(seconds.min(axis=0)),
    }


def interleaved(
    subjects: Mapping[str, Callable[[], object]], calls: int, rounds: int
) -> tuple[Timing, ...]:
    """Time functions that make ``calls`` calls each, in turn, after one round that warms up.

    Args:
        subjects: By name, functions without arguments.
        calls: Calls that each function makes, by which its time is divided.
        rounds: How often every function is run.
    """
    times: dict[str, list[float]] = {name: [] for name in subjects}
    for _ in range(rounds + 1):
        for name, function in subjects.items():
            begin = time.perf_counter()
            function()
            times[name].append((time.perf_counter() - begin) / calls)
    return tuple(Timing(name, np.array(found[1:])) for name, found in times.items())
