"""The figures of one run of a campaign, from what `modrobust.simulate` leaves of it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from modrobust.campaign.plan import Run
from modrobust.checks.types import Array
from modrobust.kernel import own_environment
from modrobust.simulation import SimulationResult
from modrobust.simulation.metrics import LARGEST_ERROR, MOST_AT_LIMIT, plain

_SETTLED = 6  # first logged ticks, which the largest v is not looked for in
_STILL = 1e-3  # of the largest torque: less variation at 10 Hz counts as so much
_SLOW = 0.1  # [s], sampling at 10 Hz


@dataclass(frozen=True)
class Record:
    """What is kept of a run; late means from `late` on, of the logged ticks.

    Args:
        run: Which one.
        feasible: Whether the motion leaves the true robot a fifth of its torque limits. The run was
            done without limits where no motion does.
        late: When the late part begins [s].
        epsilon: Norm of the tracking error that the law was made for [rad] or [m].
        diverged: Whether the loop left the range that can be computed.
        violations: Ticks at which w left [Phi], (24).
        late_error: Largest norm of the tracking error [rad] or [m]; infinite of a diverged run.
        torque_over_limit: Largest torque over its limit [1], of all ticks.
        late_at_limit: Share of late ticks at which a torque is at its limit or beyond it [1].
        variation_ratio: Late variation of a torque over that of its samples at 10 Hz, largest
            joint [1]; None where no time is left for it.
        v_over_limit: Largest robust part of a torque over its limit [1].
        step_over_limit: Mean late change of a torque from tick to tick over its limit, largest
            joint [1].

    Figures of a run that diverged are those up to there. What is over a limit is 0 of a joint that
    has none.
    """

    run: Run
    feasible: bool
    late: float
    epsilon: float
    diverged: bool
    violations: int
    late_error: float
    torque_over_limit: float
    late_at_limit: float
    variation_ratio: float | None
    v_over_limit: float
    step_over_limit: float

    @property
    def good(self) -> bool:
        """Did not diverge, late error below 0.3, at most 5 % of late ticks at a limit."""
        return (
            not self.diverged
            and self.late_error < LARGEST_ERROR
            and self.late_at_limit <= MOST_AT_LIMIT
        )

    @property
    def meets(self) -> bool:
        """Good, and the late error below epsilon."""
        return self.good and self.late_error < self.epsilon

    @property
    def ok(self) -> bool:
        """Meets epsilon, and no bound was violated."""
        return self.meets and not self.violations

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON; None where there is no number."""
        derived = {"good": self.good, "meets": self.meets}
        result: dict[str, Any] = plain({**asdict(self.run), **_own(self), **derived})
        return result


def _own(record: Record) -> dict[str, Any]:
    return {key: value for key, value in vars(record).items() if key != "run"}


@own_environment()
def figures(run: Run, result: SimulationResult, late: float, feasible: bool) -> Record:
    """The record of a run that was simulated; `late` in [s]."""
    robot, s = result.robot, result.statistics
    limit = robot.effort_limits
    first = int(np.searchsorted(result.t, late - 1e-9))
    tau, error = result.tau[first:], result.error[first:]
    at_limit = (np.abs(tau) >= limit * (1.0 - 1e-12)).any(axis=1)
    variation, steps = _variation(result, first)
    size = np.abs(tau).max(axis=0, initial=0.0)
    v = np.abs(result.tau - result.nominal)[_SETTLED:] / limit
    ended = result.diverged or not len(tau)
    return Record(
        run=run,
        feasible=feasible,
        late=late,
        epsilon=result.controller.epsilon,
        diverged=result.diverged,
        violations=0 if s is None else s.violations,
        late_error=math.inf if ended else float(error.max()),
        torque_over_limit=0.0 if s is None else float((s.tau_max / limit).max()),
        late_at_limit=float(at_limit.mean()) if len(tau) else 0.0,
        variation_ratio=_variation_ratio(result, first, variation, size),
        v_over_limit=float(v.max(initial=0.0)),
        step_over_limit=float((variation / limit).max() / steps) if steps else 0.0,
    )


def _variation(result: SimulationResult, first: int) -> tuple[Array, int]:
    """Variation of each torque over all ticks from a logged one on, (n,), and how many they are."""
    if len(result.t) - first < 2:
        return np.zeros(result.robot.n), 0
    total = result.total_variation
    return total[-1] - total[first], round((result.t[-1] - result.t[first]) * result.loop.rate)


def _variation_ratio(
    result: SimulationResult, first: int, fast: Array, size: Array
) -> float | None:
    t = result.t[first:]
    if len(t) < 2 or t[-1] - t[0] < _SLOW:
        return None
    instants = t[0] + _SLOW * np.arange(math.floor((t[-1] - t[0]) / _SLOW + 1e-9) + 1)
    index = first + np.minimum(np.searchsorted(t, instants - 1e-9), len(t) - 1)
    slow = np.abs(np.diff(result.tau[index], axis=0)).sum(axis=0)
    fast = result.total_variation[index[-1]] - result.total_variation[first]
    return float((fast / (slow + _STILL * size + 1e-12)).max())
