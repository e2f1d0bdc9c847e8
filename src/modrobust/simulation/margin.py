"""How far gains can be raised until a run fails: tried, not proved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from modrobust.model import ControllerSettings, LoopSettings, Robot
from modrobust.motion import Trajectory, default_trajectory
from modrobust.simulation.metrics import LARGEST_ERROR, MOST_AT_LIMIT
from modrobust.simulation.result import SimulationResult
from modrobust.simulation.run import simulate

LARGEST = 4.0
_HALVINGS = 5  # to a tenth
_DURATION = 2.0  # [s], of each run
_LATE = 0.5  # [s], from when on the start is over
_CASES = (("lower", 0), ("upper", 0), ("corner", 1), ("corner", 2), ("random", 3))

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Margin:
    """A factor on the gains, and the first run that failed above it."""

    factor: float
    """All runs were good there; 0 where one failed at the gains themselves."""
    beyond: float | None
    """The least factor at which one failed; None = none up to `LARGEST`."""
    case: str | None
    """That run's true parameters."""
    reason: str | None
    """What went wrong in it."""
    runs: int

    def to_dict(self) -> dict[str, float | str | None]:
        """Plain Python, ready for JSON."""
        return dict(vars(self))


def gain_margin(
    robot: Robot,
    settings: ControllerSettings,
    loop: LoopSettings,
    motion: Trajectory | None = None,
    progress: Progress | None = None,
) -> Margin:
    """Gains times a factor, by bisection from 1 to 4, in the worst of a handful of runs.

    A run has the loop's rate, delay and noise, its limits on, [d] at the end that pushes along,
    a start 5 mrad off, and takes 2 s. It fails where it diverges, where the error is beyond 0.3
    from 0.5 s on, or where torques are at their limits at more than 5 % of the ticks.

    Args:
        robot: Robot with ``n`` joints.
        settings: Law ``sampled`` with its gains; G and Lambda are multiplied by the factor, L_i
            by its square.
        loop: As the drive runs it.
        motion: What is followed; None = the default of `default_trajectory`.
        progress: Called with the part that is done.
    """
    followed = default_trajectory(robot, _DURATION) if motion is None else motion
    harsh = replace(loop, saturation=True, disturbance="worst")
    count = 0

    def failure(factor: float) -> tuple[str, str] | None:
        nonlocal count
        for which, seed in _CASES:
            count += 1
            run = simulate(
                robot,
                parameters=which,
                seed=seed,
                trajectory=followed,
                duration=_DURATION,
                loop=harsh,
                initial_error=0.005,
                law="sampled",
                epsilon=settings.epsilon,
                G=factor * float(settings.G or 0.0),
                Lambda=factor * float(settings.Lambda or 0.0),
                L_i=factor**2 * float(settings.L_i or 0.0),
                blend=settings.blend,
            )
            why = _failed(run)
            if why is not None:
                return (f"{which}, seed {seed}" if which in ("corner", "random") else which), why
        return None

    def report(done: int) -> None:
        if progress is not None:
            progress(done / (_HALVINGS + 2))

    at_once = failure(1.0)
    report(1)
    if at_once is not None:
        return Margin(0.0, 1.0, *at_once, count)
    found = failure(LARGEST)
    report(2)
    if found is None:
        return Margin(LARGEST, None, None, None, count)
    good, bad = 1.0, LARGEST
    for k in range(_HALVINGS):
        middle = 0.5 * (good + bad)
        now = failure(middle)
        good, bad = (middle, bad) if now is None else (good, middle)
        found = found if now is None else now
        report(3 + k)
    return Margin(good, bad, *found, count)


def _failed(run: SimulationResult) -> str | None:
    s = run.statistics
    if s is None or s.status != 0:
        return "the loop diverged"
    late = run.error[run.t >= _LATE]
    if late.size and not float(late.max()) < LARGEST_ERROR:
        return f"the error reached {late.max():.2g}"
    at_limit = np.asarray(s.ticks_at_limit) / max(s.ticks, 1)
    if at_limit.max() > MOST_AT_LIMIT:
        joint = run.robot.joint_names[int(np.argmax(at_limit))]
        return f"{joint} was at its torque limit at {at_limit.max():.0%} of the ticks"
    return None
