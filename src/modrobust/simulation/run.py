r"""Closed loop of controller and plant, run in C in chunks.

.. math:: M(q, \Delta)\,\ddot q + C(q, \dot q, \Delta)\,\dot q + g(q, \Delta)
          + F_v \dot q + F_c\,s(\dot q) = u + d

The plant has true parameters that the controller does not know. The command is evaluated at each
tick and held until the next takes its place; the plant is integrated in between, (28). See
`modrobust.simulation.result` for what a run leaves.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_array, as_integer, as_number, did_you_mean
from modrobust.checks.types import Array
from modrobust.control import ControllerOptions, RobustController, settings_dict
from modrobust.control.settings import kernel_loop
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.kernel import own_environment
from modrobust.model import LoopSettings, Parameters, Robot, check_robot, checked_loop
from modrobust.motion import Trajectory, make_trajectory
from modrobust.motion.limits import (
    check_duration,
    check_limits,
    check_start,
    motion_remarks,
)
from modrobust.motion.trajectory import DEFAULT_DURATION, motion_time
from modrobust.simulation.integration import Steps, choose_steps
from modrobust.simulation.metrics import plain
from modrobust.simulation.plants import BUILTIN, check_plant, make_plant
from modrobust.simulation.result import LOGGED, LoopStatistics, SimulationResult

PARAMETER_CHOICES = ("nominal", "lower", "upper", "corner", "random")
LOG_STEP = 1e-3  # [s]
MAX_TICKS = 10**10

MAX_LOGGED = 10**6  # longer runs are logged more coarsely than every millisecond
_CHUNK_SECONDS = 0.1  # of wall time, between two looks at the keyboard

Progress = Callable[[float, float], None]


@dataclass(frozen=True, eq=False)
class TrueRobot:
    """What the plant is made of: the controller does not know it.

    parameters; disturbance (n,) [N m] or [N], constant; pulled: bodies whose tensor was pulled
    towards nominal to be physical; inside: whether all of it lies within the robot's bounds.
    """

    parameters: Parameters
    disturbance: Array
    pulled: tuple[str, ...]
    inside: bool


@own_environment()
def true_robot(
    robot: Robot,
    parameters: str | Parameters | None = None,
    scenario: str | int | None = None,
    seed: int = 0,
    disturbance: ArrayLike | None = None,
) -> TrueRobot:
    """Parameters and disturbance of the plant, see `simulate`."""
    if scenario is not None:
        scenario = str(scenario)
        if parameters is not None:
            raise ValueRangeError(
                f'parameters: given beside scenario "{scenario}", which sets them; give one of both'
            )
        if scenario not in robot.scenarios:
            raise ValueRangeError(_unknown("scenario", scenario, tuple(robot.scenarios)))
        parameters = robot.scenarios[scenario]
    if parameters is None:
        parameters = "random"
    rng = np.random.default_rng(as_integer("seed", seed, 0))
    d = robot.disturbance
    drawn = d.nominal
    pulled: tuple[str, ...] = ()
    if isinstance(parameters, Parameters):
        point = parameters
        if point.packed.shape != robot.nominal.packed.shape:
            raise ShapeError(
                f"parameters: of {len(point.mass)} bodies and {len(point.viscous)} joints; robot "
                f'"{robot.name}" has {len(robot.body_names)} and {robot.j}'
            )
    elif not isinstance(parameters, str):
        raise ValueRangeError(_unknown("parameters", parameters, PARAMETER_CHOICES))
    elif parameters == "nominal":
        point = robot.nominal
    elif parameters in ("lower", "upper"):
        point, pulled = robot.physical_corner(parameters)
        drawn = d.lo if parameters == "lower" else d.hi
    elif parameters == "corner":
        point, pulled = robot.physical_corner("corner", rng)
        drawn = np.where(rng.integers(0, 2, robot.n) == 1, d.hi, d.lo)
    elif parameters == "random":
        point = robot.sample_parameters(rng)
        drawn = d.lo + rng.random(robot.n) * (d.hi - d.lo)
    else:
        raise ValueRangeError(_unknown("parameters", parameters, PARAMETER_CHOICES))
    given = drawn if disturbance is None else _state("disturbance", disturbance, robot)
    lower, upper = robot.lower.packed, robot.upper.packed
    inside = bool(
        ((lower <= point.packed) & (point.packed <= upper)).all()
        and ((d.lo <= given) & (given <= d.hi)).all()
    )
    return TrueRobot(point, np.array(given, dtype=np.float64), pulled, inside)


@own_environment()
def simulate(
    robot: Robot,
    *,
    scenario: str | int | None = None,
    parameters: str | Parameters | None = None,
    seed: int = 0,
    trajectory: Trajectory | str | Path | None = None,
    duration: float | None = None,
    rate: float | None = None,
    delay: float | None = None,
    loop: LoopSettings | None = None,
    substeps: int | None = None,
    plant: str = BUILTIN,
    q0: ArrayLike | None = None,
    dq0: ArrayLike | None = None,
    initial_error: ArrayLike | None = None,
    disturbance: ArrayLike | None = None,
    progress: Progress | None = None,
    **options: Unpack[ControllerOptions],
) -> SimulationResult:
    """Run the closed loop, the plant (23) under the command (3), and return what happened.

    Args:
        robot: Robot with ``n`` joints.
        scenario: A named scenario of the description: its true parameters, nominal disturbance.
        parameters: True parameters of the plant where no scenario is given: ``"nominal"``,
            ``"lower"``, ``"upper"``, ``"corner"``, ``"random"`` (the default), or a `Parameters`.
            The constant true disturbance is drawn from [d] in the same way.
        seed: Seeds ``"random"`` and ``"corner"``.
        trajectory: See `make_trajectory`; the description's own when None.
        duration: Simulated time [s]; the trajectory's own when None, else 10 s. The last command is
            given at the last whole tick within it. It does not change the motion: a shorter run is
            its first part (``cut_short``), in a longer one its last pose is held.
        rate: Commands a second [Hz]; each is held until the next.
        delay: How late a command acts, in periods, 0 to 1 [1].
        loop: The whole loop, instead of the robot's; rate and delay are laid over it.
        substeps: Steps of the integrator between two commands, by Runge-Kutta's method. None = as
            many as the robot needs, and an implicit method where friction is too stiff for that.
        plant: What moves as the true robot: ``"builtin"``, or another engine, ``"mujoco"`` or
            ``"pinocchio"``, whose loop runs in Python; see `modrobust.simulation.plants`.
        q0: Positions at the start, ``(n,)`` [rad] or [m]. When None: the description's ``initial``
            where its own trajectory is used, else on the trajectory.
        dq0: Velocities at the start, ``(n,)`` [rad/s] or [m/s]; when None as ``q0``.
        initial_error: q_des - q at the start, ``(n,)``, or its norm, spread by the seed; instead of
            q0 [rad] or [m].
        disturbance: Constant true disturbance ``(n,)`` [N m] or [N]; overrides the drawn one.
        **options: Settings of the controller by name, as of `RobustController`.
        progress: Called before the run and between chunks with simulated and total time [s].

    Returns:
        The run; Ctrl-C ends it early and keeps what was computed (``interrupted`` is set), and so
        does a loop that diverges (``diverged``).

    Raises:
        InputError: An argument is wrong; the subclass says how. Nothing was computed.

    Source: Section V of [GA17]; kernel twin ``mr_loop_advance``.
    """
    check_robot(robot)
    check_plant(plant)
    scenario = None if scenario is None else str(scenario)
    seed = as_integer("seed", seed, 0)
    motion = make_trajectory(robot, trajectory)
    asked = checked_loop(robot, loop, rate, delay)
    controller = RobustController(robot, loop=asked, motion=motion, **options)
    settled, need = controller.loop, controller.rate_need
    truth = true_robot(robot, parameters, scenario, seed, disturbance)
    if duration is not None:
        duration = as_number("duration", duration, "s")
        check_duration(duration)
        _tick_count(duration, settled.rate)
    if duration is None:
        duration = DEFAULT_DURATION if motion.duration is None else motion.duration
    check_duration(duration, motion)
    check_limits(robot, motion, duration)
    ticks = _tick_count(duration, settled.rate)
    dt = controller.period
    log_every = max(1, round(LOG_STEP * settled.rate), math.ceil(ticks / MAX_LOGGED))
    start = motion.sample([0.0])
    own = trajectory is None
    if initial_error is not None:
        if q0 is not None:
            raise ValueRangeError("initial_error: given beside q0, which sets it; give one of both")
        q0 = start[0][0] - _initial_error(robot, initial_error, seed)
    q_start = _start("q0", q0, robot.initial_q if own else None, start[0][0], robot)
    dq_start = _start("dq0", dq0, robot.initial_dq if own else None, start[1][0], robot)
    check_start(
        robot,
        ("q0" if q0 is not None else "initial.q", q_start),
        ("dq0" if dq0 is not None else "initial.dq", dq_start),
    )
    steps = choose_steps(robot, truth.parameters, motion, duration, dt, substeps)
    running = _loop(plant, controller, truth, q_start, dq_start, seed, steps)
    run = _Run(running, motion, ticks, dt, log_every)
    run.advance(progress, duration)
    settings = {
        "robot": robot.name,
        "scenario": scenario,
        "parameters": _choice(parameters, scenario),
        "seed": seed,
        **settings_dict(controller.settings),
        "trajectory": motion.to_dict(),
        "motion_time": motion_time(motion),
        "motion_remarks": motion_remarks(robot, motion, duration),
        "duration": duration,
        "loop": settled.to_dict(),
        "rate_needed": None if need is None else need.rate,
        "rate_warning": None if need is None else need.warning,
        "design": None if controller.design is None else controller.design.to_dict(),
        "substeps": steps.count,
        "integrator": steps.method,
        "plant": plant,
        "log_step": log_every * dt,
        "q0": q_start.tolist(),
        "dq0": dq_start.tolist(),
        "disturbance": truth.disturbance.tolist(),
        "parameters_inside_bounds": truth.inside,
        "scaled_to_physical": list(truth.pulled),
    }
    return SimulationResult(
        robot=robot,
        settings=plain(settings),
        controller=controller.settings,
        loop=settled,
        parameters=truth.parameters,
        statistics=run.statistics,
        interrupted=run.interrupted,
        **run.arrays(robot.n),
    )


def _loop(
    plant: str,
    controller: RobustController,
    truth: TrueRobot,
    q0: Array,
    dq0: Array,
    seed: int,
    steps: Steps,
) -> _kernel.Loop:
    """The closed loop in C, whose robot may be that of another engine."""
    moving = None
    if plant != BUILTIN:
        moving = make_plant(plant, controller.robot, truth.parameters, steps.implicit)
    settings = kernel_loop(controller.loop, seed, steps.count, steps.implicit)
    return _kernel.Loop(
        *(controller.kernel, truth.parameters.packed, truth.disturbance, q0, dq0, settings, moving)
    )


def _initial_error(robot: Robot, given: ArrayLike, seed: int) -> Array:
    """The error at the start; a norm is spread over the joints by the seed."""
    if np.ndim(given) == 0:
        size = as_number("initial_error", given)
        direction = np.random.default_rng([seed, 1]).standard_normal(robot.n)
        return np.asarray(size * direction / math.sqrt(math.fsum(direction * direction)))
    return _state("initial_error", given, robot)


class _Run:
    """Drives the kernel's loop in chunks; what a chunk leaves is kept or dropped as a whole."""

    def __init__(
        self,
        loop: _kernel.Loop,
        motion: Trajectory,
        ticks: int,
        dt: float,
        log_every: int,
    ) -> None:
        self.loop, self.motion = loop, motion
        self.ticks, self.dt, self.log_every = ticks, dt, log_every
        self.interrupted = False
        # One append a chunk, so that Ctrl-C between two bytecodes cannot tear logs and statistics.
        self.chunks: list[tuple[dict[str, Array], LoopStatistics]] = []

    def advance(self, progress: Progress | None, duration: float) -> None:
        """Run all ticks, until Ctrl-C or divergence."""
        done, size = 0, self.log_every
        try:
            if progress is not None:
                progress(0.0, duration)
            while done < self.ticks:
                count = min(size, self.ticks - done)
                # k dt as the kernel computes it, never a running sum.
                q, dq, ddq = self.motion.sample(np.arange(done, done + count) * self.dt)
                begin = time.perf_counter()
                log = self.loop.advance(q, dq, ddq, self.log_every)
                self.chunks.append((log, LoopStatistics.of(self.loop)))
                if self.loop.status != _kernel.STATUS_OK:
                    return
                seconds = time.perf_counter() - begin
                done += count
                grown = count * _CHUNK_SECONDS / max(seconds, 1e-6)
                size = int(min(max(grown, count / 2, 1), 4 * count, 100_000))
                if progress is not None:
                    progress(min(done * self.dt, duration), duration)
        except KeyboardInterrupt:
            self.interrupted = True

    @property
    def statistics(self) -> LoopStatistics | None:
        """After the last chunk that was kept; None when there is none."""
        return self.chunks[-1][1] if self.chunks else None

    def arrays(self, n: int) -> dict[str, Array]:
        """The logs put together, (m, n) and t (m,)."""
        if not self.chunks:
            return {name: np.zeros((0,) if name == "t" else (0, n)) for name in LOGGED}
        return {name: np.concatenate([log[name] for log, _ in self.chunks]) for name in LOGGED}


def _tick_count(duration: float, rate: float) -> int:
    # Whole ticks within the duration; rounding of the product makes none of them fall out.
    count = duration * rate * (1.0 + 4.0 * sys.float_info.epsilon)
    if count < 1.0:
        raise ValueRangeError(
            f"duration: {duration:g} s is less than one tick of {rate:g} Hz; make it longer"
        )
    if count >= MAX_TICKS + 1.0:
        raise ValueRangeError(
            f"duration: {duration:g} s at {rate:g} Hz are more than {MAX_TICKS:.0e} "
            "commands; make it shorter"
        )
    return math.floor(count) + 1  # both ends: the first command is given at 0


def _start(
    name: str, given: ArrayLike | None, own: Array | None, motion: Array, robot: Robot
) -> Array:
    value = given if given is not None else motion if own is None else own
    return _state(name, value, robot)


def _state(name: str, value: ArrayLike, robot: Robot) -> Array:
    return as_array(name, value, (robot.n,), f'robot "{robot.name}" has {robot.n} joints')


def _choice(parameters: str | Parameters | None, scenario: str | None) -> str:
    if scenario is not None:
        return "scenario"
    if isinstance(parameters, Parameters):
        return "given"
    return "random" if parameters is None else parameters


def _unknown(what: str, name: object, known: tuple[str, ...]) -> str:
    listed = ", ".join(known) if known else "none, the description has no scenarios"
    return f'{what}: no {what} "{name}"; {did_you_mean(name, known)}known: {listed}'


__all__ = ["PARAMETER_CHOICES", "SimulationResult", "TrueRobot", "simulate", "true_robot"]
