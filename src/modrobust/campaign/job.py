"""What every process of a campaign knows, and how it does one run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from modrobust.campaign.figures import Record, figures
from modrobust.campaign.motions import LATE, LATE_OF_OTHERS, TIMES, DrawnMotion, draw_motion
from modrobust.campaign.plan import Plan, Run
from modrobust.checks.types import Array
from modrobust.kernel import own_environment
from modrobust.model import ControllerSettings, LoopSettings, Robot
from modrobust.motion import make_trajectory
from modrobust.simulation import SimulationResult, simulate, true_robot
from modrobust.simulation.plants import BUILTIN
from modrobust.simulation.run import TrueRobot

_REMEMBERED = 512


@dataclass(frozen=True, eq=False)
class Job:
    """A robot, its controller and loop, and the plan of the runs.

    Args:
        robot: Robot with ``n`` joints.
        settings: Of the controller, gains included.
        loop: Common to all runs.
        plan: What they differ in.
        plant: What moves as the true robot, see `modrobust.simulate`.
        plain: Whether `modrobust.simulate` has the same controller for the description's motion.
    """

    robot: Robot
    settings: ControllerSettings
    loop: LoopSettings
    plan: Plan
    plant: str = BUILTIN
    plain: bool = False

    def record(self, index: int) -> Record:
        """The figures of the run of that number."""
        result, late, feasible = self._simulate(self.plan.run(index))
        return figures(self.plan.run(index), result, late, feasible)

    def result(self, index: int) -> SimulationResult:
        """The whole run of that number."""
        return self._simulate(self.plan.run(index))[0]

    def _simulate(self, run: Run) -> tuple[SimulationResult, float, bool]:
        """The run, when its late part begins [s], and whether the torques suffice for it."""
        robot, loop = self.robot, run.loop(self.loop)
        late, feasible, motion = LATE_OF_OTHERS, True, None
        truth = _true_robot(robot, run.parameters, run.seed)
        start = make_trajectory(robot, None)
        if run.motion in TIMES:
            drawn = _drawn_motion(robot, run.parameters, TIMES[run.motion], run.seed)
            motion = start = drawn.trajectory
            feasible = drawn.feasible
            late = LATE if TIMES[run.motion] <= 1.0 else LATE_OF_OTHERS
        if not feasible:  # then what the limits do says nothing about the law
            robot = replace(robot, effort_limits=np.full(robot.n, np.inf))
        result = simulate(
            robot,
            parameters=truth.parameters,
            disturbance=truth.disturbance,
            seed=run.seed,
            trajectory=motion,
            loop=loop,
            plant=self.plant,
            initial_error=self._initial_error(run, start.sample([0.0])[0][0]),
            **vars(self.settings),
        )
        return result, late, feasible

    @own_environment()
    def _initial_error(self, run: Run, q: Array) -> float | Array:
        """A norm, whose direction the run's seed gives; or an error for each joint.

        There the signs are drawn, and turned where the robot would start beyond its limits.
        """
        sizes = self.plan.initial_error
        if isinstance(sizes, float):
            return sizes
        lo, hi = self.robot.position_limits.T
        drawn = np.random.default_rng([run.seed, 3]).integers(0, 2, self.robot.n)
        error = np.where(drawn == 1, 1.0, -1.0) * np.array(sizes)
        error = np.where((q - error < lo) | (q - error > hi), -error, error)
        return np.asarray(q - np.clip(q - error, lo, hi))


# What the same run of another campaign draws again: a corner takes longer than its loop.
@lru_cache(maxsize=_REMEMBERED)
def _true_robot(robot: Robot, parameters: str, seed: int) -> TrueRobot:
    if parameters in ("lower", "upper") and seed:  # which is not used
        return _true_robot(robot, parameters, 0)
    return true_robot(robot, parameters, seed=seed)


@lru_cache(maxsize=_REMEMBERED)
def _drawn_motion(robot: Robot, parameters: str, time: float, seed: int) -> DrawnMotion:
    return draw_motion(robot, _true_robot(robot, parameters, seed).parameters, time, seed)
