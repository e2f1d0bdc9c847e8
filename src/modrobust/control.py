r"""The robust tracking controller: a nominal passivity-based torque and a worst-case robust one.

.. math::
   u &= M(q, \Delta_0)\,\ddot q_a + C(q, \dot q, \Delta_0)\,\dot q_a + g(q, \Delta_0) + v  & (3) \\
   \dot q_a &= \dot q_d + K_r \tilde q, \quad \tilde q = q_d - q - 2\pi k,
     \quad r = \dot{\tilde q} + K_r \tilde q                                               & (4) \\
   v &= \left(\kappa(t)\,\|\rho([\Phi])\| + \varphi(t)\right) r                            & (7) \\
   \rho([\Phi]) &= \max(|\underline\Phi|, |\overline\Phi|)                                 & (8)

k is the whole number with which no entry is beyond half a turn where a joint is continuous, and 0
elsewhere (`Robot.wraps`).

Source: [GA17]. The command is computed in C, ``mr_command``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_array, as_number, as_real, did_you_mean
from modrobust.checks.types import Array
from modrobust.errors import ModrobustError, ShapeError, ValueRangeError
from modrobust.kernel import BOUNDS, own_environment, status_error
from modrobust.model import ControllerSettings, Robot, check_robot

LAWS: Mapping[str, int] = {"norm": 0}

SOLVER_ERROR = 1e-6  # [rad s]: the usual absolute tolerance of ODE solvers

PerJoint = float | Mapping[str, float] | Sequence[float] | Array


@dataclass(frozen=True, eq=False)
class Command:
    """What the controller answers; [N] for prismatic joints."""

    tau: Array
    """Torque to apply, u of (3): ``nominal + v``, ``(n,)`` [N m]."""
    nominal: Array
    """Nominal part u_0, the very numbers that the set Phi refers to, ``(n,)`` [N m]."""
    v: Array
    """Robust part, (7), ``(n,)`` [N m]."""
    phi_lo: Array
    """Lower bound of the perturbation, (12), ``(n,)`` [N m]."""
    phi_hi: Array
    """Upper bound of the perturbation, (12), ``(n,)`` [N m]."""
    rho: Array
    """Worst case of each joint, (8), ``(n,)`` [N m]."""
    rho_norm: float
    """Euclidean norm of ``rho`` [N m]."""
    integral_rate: float
    """f of the tracking error's norm: how fast the integral of the gains grows [rad]."""


class RobustController:
    r"""The control law (3), (4), (7), (8) for one robot, with its integrators.

    .. math::
       \kappa(t) = \kappa_P + \kappa_I \int_0^t f(\|\tilde q\|)\,d\tau, \quad
       \varphi(t) = \varphi_P + \varphi_I \int_0^t f(\|\tilde q\|)\,d\tau, \quad
       f(x) = 0 \text{ if } x < \varepsilon \text{ else } x

    The integral advances by ``f(previous error) (t - previous t)`` at each command, by 0 at the
    first: it never uses an error that the robot has not yet had.

    Args:
        robot: Robot with ``n`` joints. Its controller settings are the defaults of the rest.
        law: ``"norm"``, the paper's (7).
        bound: How [Phi] is computed: ``"hull"``, the exact hull, or ``"ianea"``, Algorithm 1.
        K_r: Diagonal of K_r [1/s], positive: one number for all joints, a mapping by joint name,
            or ``(n,)``.
        kappa_P, kappa_I: Gains of kappa [s/rad], [1/rad^2]; not negative.
        phi_P, phi_I: Gains of phi [N m s/rad], [N m/rad^2]; not negative.
        epsilon: Norm of the tracking error within which the integral rests [rad] or [m]; positive.

    Raises:
        ShapeError: ``K_r`` does not have one entry a joint.
        ValueRangeError: A setting is unknown, not finite or out of its range.

    Source: (3) to (8) and Section V of [GA17].
    """

    @own_environment()
    def __init__(
        self,
        robot: Robot,
        *,
        law: str | None = None,
        bound: str | None = None,
        K_r: PerJoint | None = None,
        kappa_P: float | None = None,
        kappa_I: float | None = None,
        phi_P: float | None = None,
        phi_I: float | None = None,
        epsilon: float | None = None,
    ) -> None:
        check_robot(robot)
        own = robot.controller

        def gain(name: str, value: float | None) -> float:
            return _gain(name, getattr(own, name) if value is None else value)

        self.robot = robot
        self.settings = ControllerSettings(
            K_r=_per_joint("K_r", robot, own.K_r if K_r is None else K_r),
            law=_known("law", own.law if law is None else law, LAWS),
            bound=_known("bound", own.bound if bound is None else bound, BOUNDS),
            kappa_P=gain("kappa_P", kappa_P),
            kappa_I=gain("kappa_I", kappa_I),
            phi_P=gain("phi_P", phi_P),
            phi_I=gain("phi_I", phi_I),
            epsilon=gain("epsilon", epsilon),
        )
        if self.settings.epsilon <= 0.0:
            raise ValueRangeError(
                f"epsilon: {self.settings.epsilon:g}; must be positive: it is the radius that the "
                "tracking error is to stay in"
            )
        self.kernel = make_kernel_controller(robot, self.settings)

    def __getstate__(self) -> dict[str, Any]:
        """For copy, deepcopy and pickle: everything, the integrators as numbers."""
        return {**self.__dict__, "kernel": self.kernel.memory()}

    @own_environment()
    def __setstate__(self, state: Mapping[str, Any]) -> None:
        """A copy has integrators of its own, which stand where those of the original stood."""
        self.__dict__.update(state)
        self.kernel = make_kernel_controller(self.robot, self.settings)
        self.kernel.recall(*state["kernel"])

    def command(
        self,
        t: float,
        q: ArrayLike,
        dq: ArrayLike,
        q_des: ArrayLike,
        dq_des: ArrayLike,
        ddq_des: ArrayLike,
    ) -> Command:
        """The torque for the state measured at time ``t``, (3), (4), (7) and (8).

        Args:
            t: Time [s]; not before that of the previous command, but for its rounding.
            q: Measured positions, ``(n,)`` [rad] or [m].
            dq: Measured velocities, ``(n,)`` [rad/s] or [m/s].
            q_des: Desired positions at ``t``, ``(n,)`` [rad] or [m].
            dq_des: Desired velocities at ``t``, ``(n,)`` [rad/s] or [m/s].
            ddq_des: Desired accelerations at ``t``, ``(n,)`` [rad/s^2] or [m/s^2].

        Raises:
            ShapeError: A vector does not have ``n`` entries.
            ValueRangeError: A number is none or not finite, or a joint angle is beyond 1e5 rad, or
                the desired one of a joint that wraps.
            TimeOrderError: ``t`` is before the previous command's; see `reset`.

        On an error the integrators are as they were: the next command can follow.

        Source: (3), (4), (7), (8) of [GA17]; kernel twin ``mr_command``.
        """
        time = as_number("t", t, "s")
        if not math.isfinite(time):
            raise ValueRangeError(f"t: {time:g} s; must be finite")
        signals = self._signals((), q=q, dq=dq, q_des=q_des, dq_des=dq_des, ddq_des=ddq_des)
        try:
            out = self.kernel.command(time, *signals.values())
        except _kernel.KernelError as problem:
            raise self._refusal(problem, signals) from None
        tau, nominal, v, phi_lo, phi_hi, rho = out
        kernel = self.kernel
        return Command(tau, nominal, v, phi_lo, phi_hi, rho, kernel.rho_norm, kernel.integral_rate)

    def torque(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        q_des: ArrayLike,
        dq_des: ArrayLike,
        ddq_des: ArrayLike,
        integral: float = 0.0,
    ) -> Command:
        r"""The torque as a function of the state alone, for somebody else's loop or ODE solver.

        .. math:: \frac{d}{dt}\,\text{integral} = f(\|\tilde q\|)

        A solver carries ``integral`` as one more state, whose rate is the answer's
        ``integral_rate``. Nothing of this controller's own is read or changed: no time, no
        integrals.

        Args:
            q: Positions, ``(n,)`` [rad] or [m].
            dq: Velocities, ``(n,)`` [rad/s] or [m/s].
            q_des: Desired positions at the same instant, ``(n,)`` [rad] or [m].
            dq_des: Desired velocities, ``(n,)`` [rad/s] or [m/s].
            ddq_des: Desired accelerations, ``(n,)`` [rad/s^2] or [m/s^2].
            integral: Of f over time [rad s]; not negative. What a solver's
                error makes of 0, from -1e-6 on, counts as 0.

        Raises:
            ShapeError: A vector does not have ``n`` entries.
            ValueRangeError: A number is none, not finite or negative, or an angle is beyond 1e5 rad
                as for `command`.

        Source: (3), (4), (7), (8) of [GA17]; kernel twin ``mr_command``.
        """
        value = as_number("integral", integral)
        if not (math.isfinite(value) and value >= -SOLVER_ERROR):
            raise ValueRangeError(
                f"integral: {value:g}; must be finite and not negative: it is the integral of f, "
                "which never is; it starts at 0"
            )
        signals = self._signals((), q=q, dq=dq, q_des=q_des, dq_des=dq_des, ddq_des=ddq_des)
        try:
            out, rho_norm, rate = self.kernel.torque(max(value, 0.0), *signals.values())
        except _kernel.KernelError as problem:
            raise self._refusal(problem, signals) from None
        tau, nominal, v, phi_lo, phi_hi, rho = out
        return Command(tau, nominal, v, phi_lo, phi_hi, rho, rho_norm, rate)

    def reset(self) -> None:
        """Forget time and integrals, as if no command had been given yet."""
        self.kernel.reset()

    @property
    def kappa(self) -> float:
        """Gain kappa of (7) at the last command [s/rad]."""
        return self.kernel.kappa

    @property
    def phi(self) -> float:
        """Gain phi of (7) at the last command [N m s/rad]."""
        return self.kernel.phi

    def time_commands(
        self,
        t: ArrayLike,
        q: ArrayLike,
        dq: ArrayLike,
        q_des: ArrayLike,
        dq_des: ArrayLike,
        ddq_des: ArrayLike,
    ) -> Array:
        """Seconds that each command, (3), of a recorded run takes in C, read around the call.

        The integrators of the replay start at rest and those of this controller stay as they are.

        Args:
            t: Instants, ``(k,)`` [s].
            q: Positions, ``(k, n)`` [rad] or [m].
            dq: Velocities, ``(k, n)`` [rad/s] or [m/s].
            q_des: Desired positions, ``(k, n)`` [rad] or [m].
            dq_des: Desired velocities, ``(k, n)`` [rad/s] or [m/s].
            ddq_des: Desired accelerations, ``(k, n)`` [rad/s^2] or [m/s^2].

        Returns:
            Times, ``(k,)`` [s].

        Raises:
            ShapeError: An array does not have ``k`` rows of ``n`` entries.
            ValueRangeError: As for `command`.
            TimeOrderError: ``t`` goes backwards.

        Source: kernel twin ``mr_command``, between two readings of the processor's clock.
        """
        instants = as_array("t", t, np.shape(t)[:1] or (1,), "one entry a command")
        rows = (len(instants),)
        signals = self._signals(rows, q=q, dq=dq, q_des=q_des, dq_des=dq_des, ddq_des=ddq_des)
        try:
            return self.kernel.time_commands(instants, *signals.values())
        except _kernel.KernelError as problem:
            raise self._refusal(problem, signals) from None

    def _refusal(
        self, problem: _kernel.KernelError, signals: Mapping[str, Array]
    ) -> ModrobustError:
        """The exception that says which signal is at fault."""
        turning = self.robot.free_turns
        if (
            problem.args[0] == _kernel.STATUS_ANGLE_RANGE
            and (np.abs(signals["q"][..., turning]) <= _kernel.ANGLE_MAX).all()
            and (np.abs(signals["q_des"][..., self.robot.wraps]) > _kernel.ANGLE_MAX).any()
        ):
            signals = {"q_des": np.where(self.robot.wraps, signals["q_des"], 0.0)}
        return status_error(problem, signals)

    def _signals(self, rows: tuple[int, ...], **named: ArrayLike) -> dict[str, Array]:
        shape = (*rows, self.robot.n)
        owner = f'robot "{self.robot.name}" has {self.robot.n} joints'
        return {name: as_array(name, value, shape, owner) for name, value in named.items()}


def _known(name: str, value: str, known: Mapping[str, int]) -> str:
    if isinstance(value, str) and value in known:
        return value
    hint = did_you_mean(value, known)
    raise ValueRangeError(f'{name}: no {name} "{value}"; {hint}known: {", ".join(known)}')


def _gain(name: str, value: float) -> float:
    number = as_number(name, value)
    if not (math.isfinite(number) and number >= 0.0):
        raise ValueRangeError(f"{name}: {number:g}; must be finite and not negative")
    return number


def _per_joint(name: str, robot: Robot, value: PerJoint) -> tuple[float, ...]:
    """One positive number for each joint."""
    if isinstance(value, Mapping):
        for joint in value:
            if joint not in robot.joint_names:
                hint = did_you_mean(joint, robot.joint_names)
                raise ValueRangeError(
                    f'{name}: no joint "{joint}"; {hint}known: {", ".join(robot.joint_names)}'
                )
        missing = [joint for joint in robot.joint_names if joint not in value]
        if missing:
            raise ValueRangeError(
                f"{name}: nothing for {', '.join(missing)}; every joint needs a value"
            )
        value = [value[joint] for joint in robot.joint_names]
    array = as_real(name, value, "a number, one number a joint, or a mapping by joint name")
    if array.ndim == 0:
        array = np.full(robot.n, float(array))
    if array.shape != (robot.n,):
        raise ShapeError(
            f'{name}: expected shape ({robot.n},), got {array.shape}; robot "{robot.name}" has '
            f"{robot.n} joints"
        )
    for joint, number in zip(robot.joint_names, array, strict=True):
        if not (math.isfinite(number) and number > 0.0):
            raise ValueRangeError(
                f'{name}: {number:g} for joint "{joint}"; must be finite and positive'
            )
    return tuple(array.tolist())


def make_kernel_controller(robot: Robot, settings: ControllerSettings) -> _kernel.Controller:
    """The compiled controller for checked settings."""
    return _kernel.Controller(
        robot.model,
        robot.nominal.packed,
        robot.lower.packed,
        robot.upper.packed,
        np.ascontiguousarray(np.stack([robot.disturbance.lo, robot.disturbance.hi])),
        np.array(settings.K_r, dtype=np.float64),
        settings.kappa_P,
        settings.kappa_I,
        settings.phi_P,
        settings.phi_I,
        settings.epsilon,
        LAWS[settings.law],
        BOUNDS[settings.bound],
    )


def settings_dict(settings: ControllerSettings) -> dict[str, Any]:
    """Settings as plain Python, ready for JSON."""
    return {**asdict(settings), "K_r": list(settings.K_r)}
