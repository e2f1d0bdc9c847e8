"""Time, growth and tightness of the robust command, as in Section V of the paper.

Three measurements: the controller replayed on a simulation's inputs sampled at 1 ms (`replay`),
its time against the number of joints (`growth`), and the width of the perturbation bound by
Algorithm 1 and by the hull against the range that a search finds (`tightness`). `benchmark` does
all of them and keeps what it has when Ctrl-C comes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from modrobust.bench.found_range import found_range, probe_count
from modrobust.checks.types import Array
from modrobust.control import RobustController
from modrobust.dynamics import perturbation_bounds
from modrobust.errors import ValueRangeError
from modrobust.kernel import BOUNDS, own_environment
from modrobust.model import Robot, synthetic_chain
from modrobust.simulation import SimulationResult, simulate
from modrobust.simulation.metrics import plain, ratio, time_statistics

# Whole command on a Speedgoat real-time target, Intel Core i7-3770K at 3.5 GHz, signals sampled at
# 1 ms. Source: Section V of [GA17].
PAPER_TIMES: Mapping[str, float] = {"mean": 15.3e-6, "max": 17.2e-6, "std": 0.288e-6}  # [s]

PAPER_ROBOT = "lwa4p-paper"  # the robot that they were measured on

SIZES = (2, 4, 8, 16, 32, 64, 128, 256)
# Below this the constant part of a command hides how it grows.
_FIT_FROM = 16
_RANDOM_SPEED = 2.0  # [rad/s] or [m/s], where the robot has no velocity limit
_RANDOM_ACCELERATION = 5.0  # [rad/s^2] or [m/s^2]
_MOVING = 10.0  # times the Coulomb speed: smooth and true friction differ by 0.5 % there
_FEWEST_STATES = 20
_EVALUATIONS = 40_000  # of inverse dynamics, for each search

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class ReplayTimes:
    """Seconds of every command of a replay, (commands,) each, for one bound."""

    bound: str
    in_c: Array
    """Read in C around the kernel's call, without Python."""
    in_python: Array
    """Through `RobustController.command`."""

    def to_dict(self) -> dict[str, Any]:
        """Statistics of both."""
        return {
            "bound": self.bound,
            "commands": len(self.in_c),
            "in_c": time_statistics(self.in_c),
            "in_python": time_statistics(self.in_python),
        }


@dataclass
class Growth:
    """Time of a command [s] against the number of joints, every body uncertain, for one bound."""

    bound: str
    joints: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    """Median over commands, minimum over repeats."""

    @property
    def exponent(self) -> float | None:
        """Slope of log time over log joints, by least squares over the longer chains."""
        kept = [(n, s) for n, s in zip(self.joints, self.seconds, strict=True) if n >= _FIT_FROM]
        if len(kept) < 2:
            return None
        x, y = np.log(np.array(kept)).T
        return float(np.polyfit(x, y, 1)[0])

    def to_dict(self) -> dict[str, Any]:
        """Numbers and the fitted exponent."""
        return {
            "bound": self.bound,
            "joints": list(self.joints),
            "seconds": list(self.seconds),
            "exponent": self.exponent,
            "fitted_from": _FIT_FROM,
        }


@dataclass(frozen=True, eq=False)
class Tightness:
    """Widths of [Phi], (states, n) each, [N m] or [N]."""

    where: str
    width_hull: Array
    width_ianea: Array
    width_found: Array | None = None
    """Of the true range as far as a search attains it; None where none was made."""

    def to_dict(self) -> dict[str, Any]:
        """Mean widths, their ratios, and the median of each state's ratio, per joint."""
        hull, ianea = self.width_hull.mean(axis=0), self.width_ianea.mean(axis=0)
        each = ratio(self.width_ianea, self.width_hull)
        # A joint whose bound has no width has no ratio, in any state.
        some = np.isfinite(each).any(axis=0)
        median = np.full(each.shape[1], np.nan)
        if some.any():
            median[some] = np.nanmedian(each[:, some], axis=0)
        figures: dict[str, Any] = plain(
            {
                "where": self.where,
                "states": len(self.width_hull),
                "width_hull": hull,
                "width_ianea": ianea,
                "ianea_over_hull": ratio(ianea, hull),
                "ianea_over_hull_median": median,
            }
        )
        if self.width_found is not None:
            found = self.width_found.mean(axis=0)
            figures |= plain({"width_found": found, "hull_over_found": ratio(hull, found)})
        return figures


@dataclass
class RobotBenchmark:
    """Figures of one robot; what was not reached before Ctrl-C is missing."""

    robot: Robot
    run: SimulationResult | None = None
    times: list[ReplayTimes] = field(default_factory=list)
    tightness: list[Tightness] = field(default_factory=list)
    laws: dict[str, Array] = field(default_factory=dict)
    """Seconds in C of every command of each law, by its name."""

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {
            "robot": self.robot.name,
            "joints": list(self.robot.joint_names),
            "times": [item.to_dict() for item in self.times],
            "laws": {name: time_statistics(seconds) for name, seconds in self.laws.items()},
            "tightness": [item.to_dict() for item in self.tightness],
        }


@dataclass
class BenchmarkResult:
    """All figures of `benchmark`."""

    robots: list[RobotBenchmark] = field(default_factory=list)
    growth: list[Growth] = field(default_factory=list)
    interrupted: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON, with the paper's figures beside."""
        return {
            "robots": [item.to_dict() for item in self.robots],
            "growth": [item.to_dict() for item in self.growth],
            "paper": {
                "robot": PAPER_ROBOT,
                "times": dict(PAPER_TIMES),
                "source": "Giusti and Althoff 2017, Section V",
            },
            "interrupted": self.interrupted,
        }


def replay(run: SimulationResult, bound: str, repeat: int = 1) -> ReplayTimes:
    """Times of the whole command on the inputs of a run sampled at 1 ms.

    Args:
        run: A simulation; its logged inputs and its controller's gains are used.
        bound: ``"hull"`` or ``"ianea"``.
        repeat: How often the inputs are replayed; all times are kept. One more replay warms up.
    """
    settings = {**vars(run.controller), "bound": bound}
    controller = RobustController(run.robot, **settings)
    inputs = (run.q, run.dq, run.q_des, run.dq_des, run.ddq_des)
    controller.time_commands(run.t, *inputs)
    in_c = [controller.time_commands(run.t, *inputs) for _ in range(repeat)]
    in_python = np.empty((repeat, len(run.t)))
    clock = time.perf_counter_ns
    for k in range(repeat):
        controller.reset()
        for i, row in enumerate(zip(run.t.tolist(), *inputs, strict=True)):
            begin = clock()
            controller.command(*row)
            in_python[k, i] = (clock() - begin) * 1e-9
    return ReplayTimes(bound, np.concatenate(in_c), in_python.ravel())


LAW_CASES: Mapping[str, tuple[dict[str, Any], float]] = {  # settings, and the delay
    "norm": ({"law": "norm"}, 0.0),
    "componentwise": ({"law": "componentwise"}, 0.0),
    "norm, hold-aware": ({"law": "norm", "hold_aware": True}, 0.0),
    "sampled": ({"law": "sampled", "G": 20.0}, 0.0),
    "sampled, a period late": ({"law": "sampled", "G": 20.0}, 1.0),
}
"""Laws whose commands are timed; what gains they have does not change how long they take."""


def law_times(run: SimulationResult, repeat: int = 1) -> dict[str, Array]:
    """Seconds in C of each law's command on the inputs of a run sampled at 1 ms, by its name.

    Args:
        run: A simulation; its logged inputs and its bound are used.
        repeat: How often the inputs are replayed; all times are kept. One more replay warms up.
    """
    inputs = (run.q, run.dq, run.q_des, run.dq_des, run.ddq_des)
    found = {}
    for name, (settings, delay) in LAW_CASES.items():
        loop = replace(run.loop, delay=delay)
        controller = RobustController(run.robot, loop=loop, bound=run.controller.bound, **settings)
        each = [controller.time_commands(run.t, *inputs) for _ in range(repeat + 1)]
        found[name] = np.concatenate(each[1:])
    return found


def chain_times(n: int, bound: str, repeat: int = 1, commands: int = 200) -> float:
    """Median time of a command for a synthetic chain of ``n`` joints [s], minimum over repeats."""
    robot = synthetic_chain(n)
    rng = np.random.default_rng(n)
    shape = (commands, n)
    q = rng.uniform(-np.pi, np.pi, shape)
    dq, dq_des, ddq_des = (rng.uniform(-0.1, 0.1, shape) for _ in range(3))
    controller = RobustController(robot, bound=bound)
    t = np.arange(commands) * 1e-3
    medians = [
        float(np.median(controller.time_commands(t, q, dq, q, dq_des, ddq_des)))
        for _ in range(repeat + 1)  # the first warms up
    ]
    return min(medians[1:])


def growth(
    bound: str,
    sizes: Sequence[int] = SIZES,
    repeat: int = 3,
    progress: Callable[[float], None] | None = None,
    into: Growth | None = None,
) -> Growth:
    """Time of a command against the number of joints, every body uncertain.

    ``into`` is filled size by size, so that Ctrl-C leaves in it what was measured.
    """
    result = Growth(bound) if into is None else into
    for i, n in enumerate(sizes):
        seconds = chain_times(n, bound, repeat)
        result.joints.append(n)
        result.seconds.append(seconds)
        if progress is not None:
            progress((i + 1) / len(sizes))
    return result


@own_environment()
def random_tightness(
    robot: Robot, states: int = 1000, seed: int = 0, search: bool = False
) -> Tightness:
    """Widths of [Phi] by both kinds of bound over random states.

    Positions are drawn from the limits (+-pi rad, +-0.5 m without), velocities and auxiliary
    velocities from theirs (+-2 rad/s, +-2 m/s without), auxiliary accelerations from +-5 rad/s^2.
    With ``search``, against the range that is found too.
    """
    rng = np.random.default_rng(seed)
    n = robot.n
    revolute = robot.free_turns
    reach = np.where(revolute, np.pi, 0.5)  # [rad], [m]
    lo, hi = robot.position_limits.T
    q = rng.uniform(
        np.where(np.isfinite(lo), lo, -reach), np.where(np.isfinite(hi), hi, reach), (states, n)
    )
    limit = robot.velocity_limits
    speed = np.where(np.isfinite(limit), limit, _RANDOM_SPEED)
    dq, dq_a = rng.uniform(-speed, speed, (2, states, n))
    ddq_a = rng.uniform(-_RANDOM_ACCELERATION, _RANDOM_ACCELERATION, (states, n))
    return _tightness(robot, f"{states} random states, seed {seed}", (q, dq, dq_a, ddq_a), search)


@own_environment()
def trajectory_tightness(run: SimulationResult, states: int = 1000) -> Tightness:
    """Widths of [Phi] of both kinds and found by search, at up to so many states of a run.

    The states are evenly spaced among those in which every joint moves (all, if none is such):
    about standstill a bound holds for true Coulomb friction too, which the search does not try.
    """
    moving = np.flatnonzero(
        (np.abs(run.dq) > _MOVING * run.robot.coulomb_speed[run.robot.free]).all(axis=1)
    )
    rows = moving if len(moving) else np.arange(len(run.t))
    rows = rows[np.linspace(0, len(rows) - 1, min(states, len(rows))).astype(int)]
    K_r = np.asarray(run.controller.K_r)
    dq_a = run.dq_des + K_r * run.robot.tracking_error(run.q, run.q_des)  # (4)
    ddq_a = run.ddq_des + K_r * (run.dq_des - run.dq)
    chosen = (run.q[rows], run.dq[rows], dq_a[rows], ddq_a[rows])
    return _tightness(run.robot, f"{len(rows)} states of the trajectory", chosen, search=True)


def _tightness(
    robot: Robot, where: str, states: tuple[Array, Array, Array, Array], search: bool
) -> Tightness:
    widths: dict[str, Array] = {}
    for name in BOUNDS:
        rows = zip(*states, strict=True)
        bounds = [perturbation_bounds(robot, q, v, va, aa, bound=name) for q, v, va, aa in rows]
        widths[name] = np.array([hi - lo for lo, hi in bounds])
    found = None
    if search:
        q, dq, dq_a, ddq_a = states
        lo, hi = found_range(robot, q, dq, dq_a, ddq_a)
        # [d] shifts the torque, whatever the parameters are
        found = hi - lo + (robot.disturbance.hi - robot.disturbance.lo)
    return Tightness(where, widths["hull"], widths["ianea"], found)


@own_environment()
def benchmark(
    robots: Sequence[Robot],
    *,
    repeat: int = 3,
    sizes: Sequence[int] = SIZES,
    states: int = 1000,
    seed: int = 0,
    duration: float | None = None,
    progress: Progress | None = None,
) -> BenchmarkResult:
    """Times, tightness and growth; Ctrl-C ends it early and keeps what was measured.

    Args:
        robots: Robots to measure; each is simulated on its own default motion for the inputs.
        repeat: How often each time is taken.
        sizes: Numbers of joints for the growth; empty for none.
        states: States for the tightness, along the trajectory and random; fewer where a robot
            has so many bodies that the search would take long.
        seed: Seeds the true parameters and the random states.
        duration: Length of the simulations [s].
        progress: Called with what is being done and its fraction done.

    Raises:
        ValueRangeError: ``repeat`` or ``states`` is less than 1.
    """
    for name, count in (("repeat", repeat), ("states", states)):
        if count < 1:
            raise ValueRangeError(f"{name}: {count}; must be at least 1")
    result = BenchmarkResult()

    def show(what: str, fraction: float) -> None:
        if progress is not None:
            progress(what, fraction)

    try:
        for robot in robots:
            _measure(robot, result, repeat, states, seed, duration, show)
            if result.interrupted:
                return result
        for bound in BOUNDS if sizes else ():
            shown = partial(show, f"growth, {bound}")
            result.growth.append(Growth(bound))
            growth(bound, sizes, repeat, shown, into=result.growth[-1])
    except KeyboardInterrupt:
        result.interrupted = True
    return result


def _measure(
    robot: Robot,
    result: BenchmarkResult,
    repeat: int,
    states: int,
    seed: int,
    duration: float | None,
    show: Progress,
) -> None:
    own = RobotBenchmark(robot)
    result.robots.append(own)
    run = simulate(
        robot,
        seed=seed,
        duration=duration,
        progress=lambda t, end: show(f"{robot.name}: simulation", t / end),
    )
    own.run = run
    result.interrupted = run.interrupted
    if run.interrupted or run.diverged or len(run.t) == 0:
        return
    for i, bound in enumerate(BOUNDS):
        own.times.append(replay(run, bound, repeat))
        show(f"{robot.name}: replay", (i + 1) / len(BOUNDS))
    own.laws = law_times(run, repeat)
    # as many states as a search of about a second allows
    states = min(states, max(_FEWEST_STATES, _EVALUATIONS // probe_count(robot)))
    own.tightness.append(trajectory_tightness(run, states))
    own.tightness.append(random_tightness(robot, states, seed, search=True))
    show(f"{robot.name}: tightness", 1.0)
