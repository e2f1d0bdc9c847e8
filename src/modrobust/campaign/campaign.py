"""Closed loops over a list of runs: many points of the box, many motions, the worst of each figure.

One run says nothing about a box. A campaign tries the ends of it: that is no proof.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np

from modrobust.campaign.figures import Record
from modrobust.campaign.job import Job
from modrobust.campaign.plan import (
    INITIAL_ERROR,
    MAX_RUNS,
    MOTIONS,
    PARAMETERS,
    checked_plan,
)
from modrobust.campaign.summary import counts, plain_rows, verdict, worst_cases
from modrobust.campaign.workers import processors, run_all
from modrobust.checks import as_integer
from modrobust.checks.types import Array
from modrobust.control import ControllerOptions, settings_dict
from modrobust.control.controller import designed
from modrobust.control.settings import AUTO, checked_settings
from modrobust.design.points import light_parameters
from modrobust.kernel import own_environment
from modrobust.model import (
    DISTURBANCES,
    NOISES,
    ControllerSettings,
    LoopSettings,
    Robot,
    check_robot,
    checked_loop,
)
from modrobust.motion import make_trajectory
from modrobust.simulation import SimulationResult
from modrobust.simulation.metrics import plain
from modrobust.simulation.plants import BUILTIN, check_plant

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class Campaign:
    """What a campaign left: a record for each run that was done, in the order of their numbers."""

    job: Job
    """What the runs share, and the plan of what they differ in."""
    wanted: tuple[int, ...]
    """Numbers of the runs that were asked for."""
    records: tuple[Record, ...]
    """Figures of the runs that were done."""
    interrupted: bool
    """Whether Ctrl-C ended it early."""

    @property
    def ok(self) -> bool:
        """Every run was done, is good, kept the bound and stayed below epsilon when late."""
        return not self.interrupted and all(r.ok for r in self.records)

    @property
    def verdict(self) -> str:
        """One sentence; it begins "tried, not proved: "."""
        return verdict(self.records, len(self.wanted), self.job.settings.epsilon)

    def rerun(self, index: int) -> SimulationResult:
        """The run of that number once more, whole: its figures are the same bit for bit."""
        return self.job.result(as_integer("index", index, 0, MAX_RUNS - 1))

    def summary(self, command: Callable[[int], str] | None = None) -> dict[str, Any]:
        """Worst cases, counts and verdict, plain Python ready for JSON; null for no number.

        Args:
            command: Says how a run is seen again, by its number; None = in Python.
        """
        rows = worst_cases(self.records, command or (lambda index: f"campaign.rerun({index})"))
        job = self.job
        figures: dict[str, Any] = plain(
            {
                "robot": job.robot.name,
                **counts(self.records),
                "wanted": len(self.wanted),
                "interrupted": self.interrupted,
                "ok": self.ok,
                "verdict": self.verdict,
                "settings": settings_dict(job.settings),
                "loop": job.loop.to_dict(),
                "plan": dict(vars(job.plan)),
                "plant": job.plant,
            }
        )
        return {
            **figures,
            "worst": plain_rows(rows),
            "records": [r.to_dict() for r in self.records],
        }


@own_environment()
def campaign(
    robot: Robot,
    *,
    runs: int = 100,
    jobs: int | None = None,
    seed: int = 0,
    only: int | None = None,
    rate: float | None = None,
    delay: float | None = None,
    loop: LoopSettings | None = None,
    parameters: Sequence[str] = PARAMETERS,
    disturbances: Sequence[str] = DISTURBANCES,
    noises: Sequence[str] = NOISES,
    motions: Sequence[str] = MOTIONS,
    initial_error: float | Sequence[float] | Array = INITIAL_ERROR,
    plant: str = BUILTIN,
    progress: Progress | None = None,
    **options: Unpack[ControllerOptions],
) -> Campaign:
    """Run many closed loops of one robot under one law, and keep the figures of each.

    Run k is a function of the robot, the settings, the seed and k alone: not of the number of runs
    or processes. The law ``auto`` chooses its gains once: for the description's motion where that
    is the only one, else for any motion within the limits.

    Args:
        robot: Robot with ``n`` joints.
        runs: How many.
        jobs: Processes; None = one for each processor, 1 = no other process than this.
        seed: Seeds everything that is drawn.
        only: The number of a single run to do instead, from 0.
        rate: Commands a second [Hz].
        delay: How late a command acts, in periods, 0 to 1.
        loop: The whole loop, instead of the robot's; rate and delay are laid over it. Disturbance
            and kind of noise are those of each run.
        parameters: Kinds of true parameters, taken in turn, see `modrobust.simulate`.
        disturbances: Kinds of the disturbance: ``"constant"``, ``"sine"``, ``"random"``,
            ``"worst"``.
        noises: Kinds of the noise where the loop has any: ``"uniform"``, ``"worst"``.
        motions: ``"own"``, the description's; ``"short"`` and ``"long"``, drawn rest to rest in
            1 s and in 10 s, within half of the limits of speed.
        initial_error: Norm of the error at the start, its direction drawn [rad] or [m]; or its
            size on each joint ``(n,)``, the signs drawn.
        plant: What moves as the true robot, see `modrobust.simulate`.
        progress: Called with the number of runs done and wanted, first before any.
        **options: Settings of the controller by name, as of `RobustController`.

    Returns:
        The figures; Ctrl-C ends it early and keeps what was done (``interrupted`` is set).

    Raises:
        InputError: An argument is wrong; the subclass says how.

    Source: our own.
    """
    check_robot(robot)
    check_plant(plant)
    count = as_integer("runs", runs, 1, MAX_RUNS)
    processes = processors() if jobs is None else as_integer("jobs", jobs, 1)
    wanted = tuple(range(count)) if only is None else (as_integer("only", only, 0, MAX_RUNS - 1),)
    common = checked_loop(robot, loop, rate, delay)
    plan = checked_plan(
        *(robot, common, seed, parameters, disturbances, noises, motions, initial_error)
    )
    settings, plain = chosen_settings(robot, common, plan.motions == ("own",), options)
    job = Job(robot, settings, common, plan, plant, plain)
    found: dict[int, Record] = {}

    def done(record: Record) -> None:
        found[record.run.index] = record
        if progress is not None:
            progress(len(found), len(wanted))

    interrupted = False
    try:
        if progress is not None:
            progress(0, len(wanted))
        run_all(job, wanted, processes, done)
    except KeyboardInterrupt:
        interrupted = True
    return Campaign(job, wanted, tuple(found[k] for k in sorted(found)), interrupted)


def chosen_settings(
    robot: Robot, loop: LoopSettings, own: bool, options: ControllerOptions
) -> tuple[ControllerSettings, bool]:
    """Settings of the controller, gains included, and whether `Job.plain`.

    Args:
        robot: Robot with ``n`` joints.
        loop: Common to all runs.
        own: Whether the gains of ``auto`` are for the description's motion alone.
        options: As of `RobustController`.
    """
    settings = checked_settings(robot, options)
    if settings.law != AUTO:
        return settings, True
    motion = make_trajectory(robot, None) if own else None
    chosen, found = designed(robot, settings, loop, motion)
    # Runs take D_s as it is for any positions; along one motion alone it may have to give way less.
    light = light_parameters(robot, found.central)
    same = np.array_equal(light.packed, found.light.packed)
    return chosen, bool(own and same)


__all__ = ["Campaign", "campaign"]
