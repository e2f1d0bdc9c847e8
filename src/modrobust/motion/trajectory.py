r"""Desired motions :math:`q_d(t)`, sampled many instants at a time, at least twice differentiable.

Every kind has ``sample(t (k,)) -> (q, dq, ddq)``, each ``(k, n)``, [rad] or [m], per s, per s^2.
The control law (3), (4) needs all three; the kernel takes them as arrays, so that a run pays no
Python per tick and any motion works.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from reprlib import repr as short
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_integer, as_number, as_real, did_you_mean, shape_error, unknown_name
from modrobust.checks.types import Array
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.kernel import own_environment
from modrobust.model import Robot, owner_of
from modrobust.motion.csv import read_trajectory_csv, unwrapped
from modrobust.motion.spline import CubicSpline

Samples = tuple[Array, Array, Array]

DEFAULT_DURATION = 10.0  # [s]
# Peak of the derivative of 10 s^3 - 15 s^4 + 6 s^5 over s in [0, 1], at s = 1/2.
QUINTIC_PEAK_RATE = 1.875
# Peak of its second derivative, 10 / sqrt(3), at s = 1/2 -+ sqrt(3)/6.
QUINTIC_PEAK_ACCELERATION = 10.0 / math.sqrt(3.0)
# (13) of [GA17].
PAPER_AMPLITUDE = tuple(math.pi / x for x in (2.0, -4.0, 6.0, -6.0, 4.0, -2.0))  # [rad]
PAPER_OMEGA = (math.pi / 5.0, math.pi / 2.0)  # [rad/s]

_SAME_TIME = 1e-12  # relative: what rounding makes of the last tick
_SPECS = ("paper", "quintic")
_KNOWN = "paper, quintic, FILE.csv, quintic:FILE.csv"


class Trajectory(Protocol):
    """A desired motion of ``n`` joints."""

    @property
    def n(self) -> int:
        """Number of joints."""

    @property
    def duration(self) -> float | None:
        """How long a run takes when nobody says otherwise [s]; None for the general default."""

    @property
    def end(self) -> float:
        """Last instant at which the motion is defined [s]; infinite where it goes on or holds."""

    def sample(self, t: ArrayLike) -> Samples:
        """Positions, velocities and accelerations at instants: q_d and its derivatives of (4).

        Args:
            t: Instants, ``(k,)`` [s].

        Returns:
            Positions, velocities and accelerations, each ``(k, n)`` [rad] or [m], per s, per s^2.

        Raises:
            ValueRangeError: ``t`` holds something else than real numbers.

        Source: the kind of motion; (4) of [GA17] asks for all three.
        """

    def to_dict(self) -> dict[str, Any]:
        """What describes the motion, for the settings of a run; numbers and texts only."""


@dataclass(frozen=True)
class Sines:
    r"""Products of sines, as the paper's (13).

    .. math:: q_d(t) = A \prod_k \sin(\omega_k t)

    Args:
        amplitude: ``A``, (n,) [rad] or [m].
        omega: Angular rates, (k,) [rad/s].
        duration: Default duration of a run [s].

    Raises:
        ShapeError: ``amplitude`` or ``omega`` is no list.
        ValueRangeError: A number is not finite.

    Source: (13) of [GA17].
    """

    amplitude: tuple[float, ...]
    omega: tuple[float, ...]
    duration: float | None = None

    @own_environment()
    def __post_init__(self) -> None:
        _vector("amplitude", self.amplitude)
        _vector("omega", self.omega)

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.amplitude)

    @property
    def end(self) -> float:
        """The sines go on for ever: infinite [s]."""
        return math.inf

    @own_environment()
    def sample(self, t: ArrayLike) -> Samples:
        """Products of sines as (13); derivatives by the product rule, one factor after the other.

        Args:
            t: Instants, ``(k,)`` [s].

        Returns:
            Positions, velocities and accelerations, each ``(k, n)`` [rad] or [m], per s, per s^2.

        Raises:
            ValueRangeError: ``t`` holds something else than real numbers, or an angle
                omega t is beyond 1e5 rad.

        Source: (13) of [GA17].
        """
        instants = _instants(t)
        p, dp, ddp = np.ones_like(instants), np.zeros_like(instants), np.zeros_like(instants)
        for omega in self.omega:
            s, cosine = _sines_cosines(omega, instants)
            ds = omega * cosine
            dds = -omega * omega * s
            p, dp, ddp = p * s, dp * s + p * ds, ddp * s + 2.0 * dp * ds + p * dds
        a = np.asarray(self.amplitude, dtype=np.float64)
        return np.outer(p, a), np.outer(dp, a), np.outer(ddp, a)

    def to_dict(self) -> dict[str, Any]:
        """Kind, amplitude and rates."""
        return {"kind": "sines", "amplitude": list(self.amplitude), "omega": list(self.omega)}


@dataclass(frozen=True, eq=False)
class Quintic:
    r"""Rest to rest through waypoints; holds the first before and the last after its time.

    .. math:: q_d = p_k + (p_{k+1} - p_k)\,(10 s^3 - 15 s^4 + 6 s^5),
              \quad s = (t - t_k) / (t_{k+1} - t_k)

    Args:
        times: Strictly increasing, (k,) [s].
        points: Waypoints, (k, n) [rad] or [m].
        duration: Default duration of a run [s]; the last time when None.
        source: Where the waypoints come from, for the settings of a run.

    Raises:
        ShapeError: ``points`` does not have one row a time.
        ValueRangeError: A number is not finite, or the times do not increase.

    Source: the polynomial of least degree that starts and ends at rest.
    """

    times: Array
    points: Array
    duration: float | None = None
    source: str | None = None

    @own_environment()
    def __post_init__(self) -> None:
        times, points = _rows(self.times, self.points)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "points", points)
        if self.duration is None and times[-1] > 0.0:
            object.__setattr__(self, "duration", float(times[-1]))

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.points.shape[1])

    @property
    def end(self) -> float:
        """The last waypoint is held: infinite [s]."""
        return math.inf

    @own_environment()
    def sample(self, t: ArrayLike) -> Samples:
        r"""Velocity and acceleration are zero at every waypoint.

        .. math:: \dot q_d = (p_{k+1} - p_k)\,30\,(s (1 - s))^2 / (t_{k+1} - t_k)

        Args:
            t: Instants, ``(k,)`` [s].

        Returns:
            Positions, velocities and accelerations, each ``(k, n)`` [rad] or [m], per s, per s^2.

        Raises:
            ValueRangeError: ``t`` holds something else than real numbers.

        Source: the polynomial of least degree that starts and ends at rest.
        """
        instants = _instants(t)
        if len(self.times) == 1:
            q = np.repeat(self.points, len(instants), axis=0)
            return q, np.zeros_like(q), np.zeros_like(q)
        k = np.clip(np.searchsorted(self.times, instants, "right") - 1, 0, len(self.times) - 2)
        length = self.times[k + 1] - self.times[k]
        s = np.clip((instants - self.times[k]) / length, 0.0, 1.0)
        step = self.points[k + 1] - self.points[k]
        h = s**3 * (10.0 + s * (6.0 * s - 15.0))
        dh = 30.0 * (s * (1.0 - s)) ** 2 / length
        ddh = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / length**2
        q = self.points[k] + h[:, None] * step
        return q, dh[:, None] * step, ddh[:, None] * step

    def to_dict(self) -> dict[str, Any]:
        """Kind and waypoints, or where they come from."""
        if self.source is not None:
            return {"kind": "quintic", "source": self.source}
        return {"kind": "quintic", "times": self.times.tolist(), "points": self.points.tolist()}


@dataclass(frozen=True, eq=False)
class Splined:
    r"""A cubic spline through given rows; holds the last after its time.

    .. math:: q_d(t) = a_k + b_k (t - t_k) + c_k (t - t_k)^2 + d_k (t - t_k)^3

    Twice continuously differentiable, but at its end where it is under way there.

    Args:
        times: Strictly increasing from 0, (k,) [s]; k >= 2.
        points: Positions, (k, n) [rad] or [m].
        duration: Default duration of a run [s]; the last time when None.
        source: Where the rows come from, for the settings of a run.
        unwrapped: How many jumps by whole turns were taken out of each joint's rows, (n,).

    Raises:
        ShapeError: ``points`` does not have one row a time.
        ValueRangeError: A number is not finite, or the times do not increase.

    Source: `modrobust.motion.spline`, which has the end conditions.
    """

    times: Array
    points: Array
    duration: float | None = None
    source: str | None = None
    unwrapped: tuple[int, ...] = ()
    _spline: CubicSpline = field(init=False, repr=False)

    @own_environment()
    def __post_init__(self) -> None:
        times, points = _rows(self.times, self.points)
        if len(times) < 2:
            raise ValueRangeError("trajectory: 1 row; a spline needs at least 2; add rows")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "_spline", CubicSpline(times, points))
        if self.duration is None:
            object.__setattr__(self, "duration", float(times[-1]))

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.points.shape[1])

    @property
    def end(self) -> float:
        """The last row is held: infinite [s]."""
        return math.inf

    @own_environment()
    def sample(self, t: ArrayLike) -> Samples:
        r"""Derivatives of the spline; zero after the last row.

        .. math:: q_d(t) = a_k + b_k (t - t_k) + c_k (t - t_k)^2 + d_k (t - t_k)^3

        Args:
            t: Instants, ``(k,)`` [s].

        Returns:
            Positions, velocities and accelerations, each ``(k, n)`` [rad] or [m], per s, per s^2.

        Raises:
            ValueRangeError: ``t`` holds something else than real numbers.

        Source: `modrobust.motion.spline`.
        """
        instants = _instants(t)
        q, dq, ddq = self._spline(instants)
        held = instants > self.times[-1] * (1.0 + _SAME_TIME)
        q[held], dq[held], ddq[held] = self.points[-1], 0.0, 0.0
        return q, dq, ddq

    def to_dict(self) -> dict[str, Any]:
        """Kind and rows, or where they come from."""
        if self.source is not None:
            return {"kind": "csv", "source": self.source}
        return {"kind": "csv", "times": self.times.tolist(), "points": self.points.tolist()}


def paper_trajectory(robot: Robot) -> Sines:
    """The motion (13) of the paper, ten seconds of it.

    Raises:
        ShapeError: The robot does not have 6 joints.

    Source: (13) of [GA17].
    """
    if robot.n != len(PAPER_AMPLITUDE):
        raise ShapeError(
            f'trajectory "paper": has 6 joints; robot "{robot.name}" has {robot.n}; '
            'use "quintic" or a CSV file'
        )
    return Sines(PAPER_AMPLITUDE, PAPER_OMEGA, DEFAULT_DURATION)


@own_environment()
def default_trajectory(robot: Robot, duration: float = DEFAULT_DURATION, seed: int = 0) -> Quintic:
    r"""Rest to rest through seeded waypoints, within position limits and half of the others.

    .. math:: |p_{k+1} - p_k| \le \min\left(\tfrac{1}{2} v_{max}\,h / 1.875,\;
              \tfrac{1}{2} a_{max}\,h^2 \sqrt{3} / 10\right)

    where h is the time between two waypoints.

    A waypoint about every 2.5 s, drawn from the middle 80 % of the position range, or from
    +-pi/2 rad (+-0.25 m) where there is none, and pulled towards the previous one until the peak
    velocity is at most half the limit (0.5 rad/s, 0.1 m/s where there is none) and the peak
    acceleration at most half its limit.

    Args:
        robot: Robot with ``n`` joints.
        duration: Time from the first to the last waypoint [s].
        seed: Seeds the waypoints.

    Raises:
        ValueRangeError: ``duration`` is not positive and finite, or ``seed`` no whole number from
            0.

    Source: peaks of the quintic, see `Quintic`.
    """
    duration = as_number("duration", duration, "s")
    if not (math.isfinite(duration) and duration > 0.0):
        raise ValueRangeError(f"duration: {duration:g} s; must be positive and finite")
    rng = np.random.default_rng(as_integer("seed", seed, 0))
    revolute = robot.free_turns
    half = np.where(revolute, math.pi / 2.0, 0.25)  # [rad], [m]
    lo, hi = robot.position_limits.T
    lo, hi = (
        np.where(np.isfinite(lo), lo, np.where(np.isfinite(hi), hi - 2.0 * half, -half)),
        np.where(np.isfinite(hi), hi, np.where(np.isfinite(lo), lo + 2.0 * half, half)),
    )
    lo, hi = lo + 0.1 * (hi - lo), hi - 0.1 * (hi - lo)
    finite = np.isfinite(robot.velocity_limits)
    # 1.0 rad/s, 0.2 m/s where the description gives no limit.
    speed = 0.5 * np.where(finite, robot.velocity_limits, np.where(revolute, 1.0, 0.2))
    segments = max(1, round(duration / 2.5))
    times = np.linspace(0.0, duration, segments + 1)
    length = duration / segments
    longest = np.minimum(
        speed * length / QUINTIC_PEAK_RATE,
        0.5 * robot.acceleration_limits * length**2 / QUINTIC_PEAK_ACCELERATION,
    )
    points = [np.clip(np.zeros(robot.n), lo, hi)]
    for _ in range(segments):
        step = rng.uniform(lo, hi) - points[-1]
        points.append(points[-1] + np.clip(step, -longest, longest))
    return Quintic(times, np.array(points), duration, source=f"default, seed {seed}")


@own_environment()
def make_trajectory(
    robot: Robot,
    spec: Trajectory | str | Path | None = None,
    duration: float | None = None,
) -> Trajectory:
    """The motion that ``spec`` names.

    Args:
        robot: Robot with ``n`` joints.
        spec: A trajectory; ``"paper"`` for (13); ``"quintic"`` for `default_trajectory`;
            ``"FILE.csv"``, splined; ``"quintic:FILE.csv"``, rest to rest through the rows; None
            for the description's own, or the default where it has none.
        duration: Length of the default motion [s]; where None, that of a description whose motion
            is a quintic without points, else 10 s.

    Raises:
        FileError, DescriptionError: The CSV file cannot be read, or a row of it is wrong.
        ShapeError: The trajectory has another number of joints than the robot.
        ValueRangeError: ``spec`` names no trajectory.
    """
    if duration is None:
        own = robot.trajectory
        of_default = own is not None and own.kind == "quintic" and not own.points
        duration = (own.duration if own is not None and of_default else None) or DEFAULT_DURATION
    trajectory = _make(robot, spec, duration)
    if trajectory.n != robot.n:
        raise ShapeError(f"trajectory: has {trajectory.n} joints; {owner_of(robot)}")
    return trajectory


def _make(robot: Robot, spec: Trajectory | str | Path | None, duration: float) -> Trajectory:
    if spec is None:
        return _from_settings(robot, duration)
    if not isinstance(spec, str | Path):
        if not hasattr(spec, "sample"):
            raise ValueRangeError(
                f"trajectory: {short(spec)}; must be a trajectory, a name or a file; "
                f"known: {_KNOWN}"
            )
        return spec
    text = str(spec)
    if text == "paper":
        return paper_trajectory(robot)
    if text == "quintic":
        return default_trajectory(robot, duration)
    rest_to_rest = text.startswith("quintic:")
    file = text.removeprefix("quintic:")
    if not file.lower().endswith(".csv"):
        raise ValueRangeError(
            f'trajectory: no trajectory "{text}"; {did_you_mean(text, _SPECS)}known: {_KNOWN}'
        )
    if rest_to_rest:
        return Quintic(*read_trajectory_csv(file, robot.joint_names), source=file)
    return _splined(robot, file, None)


def _splined(robot: Robot, file: str, duration: float | None) -> Splined:
    times, points = read_trajectory_csv(file, robot.joint_names)
    points, jumps = unwrapped(points, robot.wraps)
    return Splined(times, points, duration, source=file, unwrapped=jumps)


def _from_settings(robot: Robot, duration: float) -> Trajectory:
    own = robot.trajectory
    if own is None:
        return default_trajectory(robot, duration)
    if own.kind == "sines":
        return Sines(own.amplitude, own.omega, own.duration)
    if own.kind == "quintic" and not own.points:
        return default_trajectory(robot, duration)
    if own.kind == "quintic":
        return Quintic(np.array(own.times), np.array(own.points), own.duration)
    if own.kind == "csv" and own.file is not None:
        return _splined(robot, own.file, own.duration)
    raise ValueRangeError(
        unknown_name(f'trajectory: no kind "{own.kind}"', own.kind, ("sines", "quintic", "csv"))
    )


def motion_time(trajectory: Trajectory) -> float | None:
    """Time to the last point of a motion [s]; its duration where it has no points."""
    if isinstance(trajectory, Quintic | Splined):
        return float(trajectory.times[-1])
    return trajectory.duration


def _instants(t: ArrayLike) -> Array:
    return np.atleast_1d(as_real("t", t, "instants [s]"))


def _sines_cosines(omega: float, t: Array) -> Array:
    """Rows sine and cosine of omega t, by the kernel: NumPy's depend on the processor."""
    try:
        return _kernel.sines_cosines(np.ravel(omega * t))
    except _kernel.KernelError:
        raise ValueRangeError(
            f"trajectory omega: {omega:g} rad/s times {np.abs(t).max():g} s is an angle beyond "
            f"{_kernel.ANGLE_MAX:g} rad; shorten the run or lower omega"
        ) from None


def _vector(name: str, value: ArrayLike) -> Array:
    array = as_real(f"trajectory {name}", value, "a list of numbers")
    if array.ndim != 1 or array.size == 0:
        raise ShapeError(f"trajectory {name}: expected a list of numbers, got shape {array.shape}")
    if not np.isfinite(array).all():
        raise ValueRangeError(f"trajectory {name}: {array.tolist()}; every number must be finite")
    return array


def _rows(times: ArrayLike, points: ArrayLike) -> tuple[Array, Array]:
    t = _vector("times", times)
    q = np.array(as_real("trajectory points", points, f"shape ({len(t)}, n)"))
    if q.ndim != 2 or len(q) != len(t) or q.shape[1] == 0:
        raise shape_error(
            "trajectory points", f"({len(t)}, n)", q.shape, f"there are {len(t)} times"
        )
    if not np.isfinite(q).all():
        raise ValueRangeError("trajectory points: every number must be finite")
    if not (np.diff(t) > 0.0).all():
        k = int(np.argmin(np.diff(t) > 0.0))
        raise ValueRangeError(
            f"trajectory times: {t[k + 1]:g} s follows {t[k]:g} s; times must increase"
        )
    if t[0] < 0.0:
        raise ValueRangeError(f"trajectory times: first is {t[0]:g} s; a motion starts at 0 s")
    return t, q


__all__ = [
    "DEFAULT_DURATION",
    "Quintic",
    "Sines",
    "Splined",
    "Trajectory",
    "default_trajectory",
    "make_trajectory",
    "motion_time",
    "paper_trajectory",
]
