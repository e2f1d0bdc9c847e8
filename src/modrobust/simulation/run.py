r"""Closed loop of controller and plant, run in C in chunks.

.. math:: M(q, \Delta)\,\ddot q + C(q, \dot q, \Delta)\,\dot q + g(q, \Delta)
          + F_v \dot q + F_c\,s(\dot q) = u + d

The plant has true parameters that the controller does not know. The command is evaluated at each
tick of the control rate and held until the next; the plant is integrated in between by the
classical Runge-Kutta method. See `modrobust.simulation.result` for what a run leaves.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_array, as_integer, as_number, did_you_mean
from modrobust.checks.types import Array
from modrobust.control import PerJoint, RobustController, settings_dict
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.kernel import own_environment
from modrobust.model import Parameters, Robot
from modrobust.motion import Trajectory, make_trajectory
from modrobust.motion.limits import (
    check_duration,
    check_limits,
    check_start,
    motion_remarks,
)
from modrobust.motion.trajectory import DEFAULT_DURATION, motion_time
from modrobust.simulation.engine_loop import EngineLoop
from modrobust.simulation.metrics import plain
from modrobust.simulation.plants import BUILTIN, check_plant, make_plant
from modrobust.simulation.result import LOGGED, LoopStatistics, SimulationResult

PARAMETER_CHOICES = ("nominal", "lower", "upper", "corner", "random")
CONTROL_RATE = 50e3  # [Hz]
MAX_CONTROL_RATE = 1e7  # [Hz]
LOG_STEP = 1e-3  # [s]
MAX_TICKS = 10**10
MAX_SUBSTEPS = 10**6
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
    law: str | None = None,
    bound: str | None = None,
    K_r: PerJoint | None = None,
    kappa_P: float | None = None,
    kappa_I: float | None = None,
    phi_P: float | None = None,
    phi_I: float | None = None,
    epsilon: float | None = None,
    trajectory: Trajectory | str | Path | None = None,
    duration: float | None = None,
    control_rate: float = CONTROL_RATE,
    substeps: int = 1,
    plant: str = BUILTIN,
    q0: ArrayLike | None = None,
    dq0: ArrayLike | None = None,
    disturbance: ArrayLike | None = None,
    progress: Progress | None = None,
) -> SimulationResult:
    """Run the closed loop, the plant (23) under the command (3), and return what happened.

    Args:
        robot: Robot with ``n`` joints.
        scenario: A named scenario of the description: its true parameters, nominal disturbance.
        parameters: True parameters of the plant where no scenario is given: ``"nominal"``,
            ``"lower"``, ``"upper"``, ``"corner"``, ``"random"`` (the default), or a `Parameters`.
            The constant true disturbance is drawn from [d] in the same way.
        seed: Seeds ``"random"`` and ``"corner"``.
        law: See `RobustController`.
        bound: See `RobustController`.
        K_r: One number for all joints, a mapping by joint name, or ``(n,)`` [1/s].
        kappa_P: Constant part of kappa [s/rad].
        kappa_I: Gain of the integral in kappa [1/rad^2].
        phi_P: Constant part of phi [N m s/rad].
        phi_I: Gain of the integral in phi [N m/rad^2].
        epsilon: Norm of the tracking error to reach [rad] or [m].
        trajectory: See `make_trajectory`; the description's own when None.
        duration: Simulated time [s]; the trajectory's own when None, else 10 s. The last command is
            given at the last whole tick within it. It does not change the motion: a shorter run is
            its first part (``cut_short``), in a longer one its last pose is held.
        control_rate: Commands a second [Hz]; each is held until the next.
        substeps: Runge-Kutta steps between two commands.
        plant: What moves as the true robot: ``"builtin"``, or another engine, ``"mujoco"`` or
            ``"pinocchio"``, whose loop runs in Python; see `modrobust.simulation.plants`.
        q0: Positions at the start, ``(n,)`` [rad] or [m]. When None: the description's ``initial``
            where its own trajectory is used, else on the trajectory.
        dq0: Velocities at the start, ``(n,)`` [rad/s] or [m/s]; when None as ``q0``.
        disturbance: True disturbance ``(n,)`` [N m] or [N]; overrides the drawn one.
        progress: Called before the run and between chunks with simulated and total time [s].

    Returns:
        The run; Ctrl-C ends it early and keeps what was computed (``interrupted`` is set), and so
        does a loop that diverges (``diverged``).

    Raises:
        InputError: An argument is wrong; the subclass says how. Nothing was computed.

    Source: Section V of [GA17]; kernel twin ``mr_loop_advance``.
    """
    check_plant(plant)
    scenario = None if scenario is None else str(scenario)
    seed = as_integer("seed", seed, 0)
    substeps = as_integer("substeps", substeps, 1, MAX_SUBSTEPS)
    control_rate = as_number("control_rate", control_rate, "Hz")
    controller = RobustController(
        robot,
        law=law,
        bound=bound,
        K_r=K_r,
        kappa_P=kappa_P,
        kappa_I=kappa_I,
        phi_P=phi_P,
        phi_I=phi_I,
        epsilon=epsilon,
    )
    truth = true_robot(robot, parameters, scenario, seed, disturbance)
    if duration is not None:
        duration = as_number("duration", duration, "s")
        check_duration(duration)
        _tick_count(duration, control_rate)
    motion = make_trajectory(robot, trajectory)
    if duration is None:
        duration = DEFAULT_DURATION if motion.duration is None else motion.duration
    check_duration(duration, motion)
    check_limits(robot, motion, duration)
    ticks = _tick_count(duration, control_rate)
    dt = 1.0 / control_rate
    log_every = max(1, round(LOG_STEP * control_rate), math.ceil(ticks / MAX_LOGGED))
    start = motion.sample([0.0])
    own = trajectory is None
    q_start = _start("q0", q0, robot.initial_q if own else None, start[0][0], robot)
    dq_start = _start("dq0", dq0, robot.initial_dq if own else None, start[1][0], robot)
    check_start(
        robot,
        ("q0" if q0 is not None else "initial.q", q_start),
        ("dq0" if dq0 is not None else "initial.dq", dq_start),
    )
    loop = _loop(plant, controller, truth, q_start, dq_start, dt, substeps)
    run = _Run(loop, motion, ticks, dt, log_every)
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
        "control_rate": control_rate,
        "hold": "the command is evaluated at the control rate and held between",
        "substeps": substeps,
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
    dt: float,
    substeps: int,
) -> _kernel.Loop | EngineLoop:
    """The closed loop in C, or with a plant of another engine."""
    d = truth.disturbance
    if plant == BUILTIN:
        kernel = controller.kernel
        return _kernel.Loop(kernel, truth.parameters.packed, d, q0, dq0, dt, substeps)
    moving = make_plant(plant, controller.robot, truth.parameters, d, q0, dq0, dt, substeps)
    return EngineLoop(controller, moving, truth.parameters, d, dt)


class _Run:
    """Drives the kernel's loop in chunks; what a chunk leaves is kept or dropped as a whole."""

    def __init__(
        self,
        loop: _kernel.Loop | EngineLoop,
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


def _tick_count(duration: float, control_rate: float) -> int:
    if not (math.isfinite(control_rate) and 1.0 <= control_rate <= MAX_CONTROL_RATE):
        raise ValueRangeError(
            f"control_rate: {control_rate:g} Hz; must lie in [1, {MAX_CONTROL_RATE:g}] Hz; "
            f"the default is {CONTROL_RATE:g} Hz"
        )
    # Whole ticks within the duration; rounding of the product makes none of them fall out.
    count = duration * control_rate * (1.0 + 4.0 * sys.float_info.epsilon)
    if count < 1.0:
        raise ValueRangeError(
            f"duration: {duration:g} s is less than one tick of {control_rate:g} Hz; make it longer"
        )
    if count >= MAX_TICKS + 1.0:
        raise ValueRangeError(
            f"duration: {duration:g} s at {control_rate:g} Hz are more than {MAX_TICKS:.0e} "
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
