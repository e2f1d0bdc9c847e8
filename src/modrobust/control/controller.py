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
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_array, as_number, unknown_name
from modrobust.checks.types import Array
from modrobust.control.rate import RateNeed, needed_rate
from modrobust.control.settings import (
    AUTO,
    PARTS,
    ControllerOptions,
    checked_settings,
    make_kernel_controller,
)
from modrobust.control.takeover import take_over
from modrobust.design import Design, central_parameters, design, light_parameters
from modrobust.errors import ModrobustError, ValueRangeError
from modrobust.kernel import own_environment, status_error
from modrobust.model import ControllerSettings, LoopSettings, Robot, check_robot, checked_loop
from modrobust.motion import Trajectory, make_trajectory

SOLVER_ERROR = 1e-6  # [rad s]: the usual absolute tolerance of ODE solvers


class RateWarning(UserWarning):
    """The loop is slower than the gains need, by an estimate."""


@dataclass(frozen=True, eq=False)
class Command:
    """What the controller answers; [N] for prismatic joints."""

    tau: Array
    """Torque to apply, u of (3) or (32): ``nominal + v``, ``(n,)`` [N m]."""
    nominal: Array
    """Nominal part u_0, the very numbers that the set Phi refers to, ``(n,)`` [N m]."""
    v: Array
    """Robust part, (7), (29), or feedback and sigma of (32), ``(n,)`` [N m]."""
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
    alpha: float
    """Share of the feedback that torque limits leave room for, (32), of ``sampled``; else 1 [1]."""


class RobustController:
    r"""The control law for one robot, with what it remembers from tick to tick.

    .. math::
       \kappa(t) = \kappa_P + \kappa_I \int_0^t f(\|\tilde q\|)\,d\tau, \quad
       \varphi(t) = \varphi_P + \varphi_I \int_0^t f(\|\tilde q\|)\,d\tau, \quad
       f(x) = 0 \text{ if } x < \varepsilon \text{ else } x

    of the laws ``norm``, (7), and ``componentwise``, whose integral advances by ``f(previous error)
    (t - previous t)`` at each command, by 0 at the first: it never uses an error that the robot has
    not yet had. The law ``sampled``, (31) to (34), is made for a command that is held for a period
    and may act late; ``auto`` is the same with gains that `modrobust.design.design` chooses for the
    robot's box, the loop and the motion.

    Args:
        robot: Robot with ``n`` joints. Its controller and loop are the defaults of the rest.
        rate: Commands a second [Hz]; each is held until the next. One that is given and too slow
            for the gains, by an estimate, is warned of (`RateWarning`).
        delay: How late a command acts, in periods, 0 to 1 [1].
        loop: The whole loop, instead of the robot's; rate and delay are laid over it.
        motion: What ``auto`` chooses gains for: a `Trajectory`; None = the robot's own, else any
            motion within the limits of positions and velocities.
        **options: Settings by name, see `ControllerSettings`; ``K_r`` may be one number for all
            joints, a mapping by joint name, or ``(n,)``. None = the robot's own. Other names are a
            ``TypeError``.

    Raises:
        ShapeError: ``K_r`` does not have one entry a joint.
        ValueRangeError: A setting is unknown, not finite or out of its range.

    Source: (3) to (8) and Section V of [GA17]; (29) and (31) to (34) are our own.
    """

    @own_environment()
    def __init__(
        self,
        robot: Robot,
        *,
        rate: float | None = None,
        delay: float | None = None,
        loop: LoopSettings | None = None,
        motion: Trajectory | None = None,
        **options: Unpack[ControllerOptions],
    ) -> None:
        check_robot(robot)
        self.robot = robot
        self.loop = checked_loop(robot, loop, rate, delay)
        settings = checked_settings(robot, options)
        self.design: Design | None = None
        if settings.law == AUTO:
            if motion is None and robot.trajectory is not None:
                motion = make_trajectory(robot, None)
            settings, self.design = designed(robot, settings, self.loop, motion)
            self._points = self.design.central, self.design.light
        elif settings.law == "sampled" or settings.hold_aware:
            central = central_parameters(robot)
            self._points = central, light_parameters(robot, central)
        else:  # not used
            self._points = robot.nominal, robot.nominal
        self.settings = settings
        self.payload: str | None = None
        self.kernel = self._kernel_of(None)
        self._motion = motion
        self._before: _kernel.Controller | None = None  # of the payload used until now
        self._ticks = 0  # that `step` has done
        if rate is not None:
            need = self.rate_need
            if need is not None and need.warning is not None:
                warnings.warn(need.warning, RateWarning, stacklevel=3)

    def __getstate__(self) -> dict[str, Any]:
        """For copy, deepcopy and pickle: everything, the kernel's state as numbers."""
        return {**self.__dict__, "kernel": self.kernel.memory(), "_before": None}

    @own_environment()
    def __setstate__(self, state: Mapping[str, Any]) -> None:
        """A copy has a state of its own, which stands where that of the original stood."""
        self.__dict__.update(state)
        self.kernel = self._kernel_of(self.payload)
        self.kernel.recall(*state["kernel"])

    def _kernel_of(self, payload: str | None) -> _kernel.Controller:
        """The compiled controller that counts on this payload, or on any of them."""
        robot, points = self.robot, self._points
        if payload is not None:
            nominal, lower, upper = robot.payloads[payload]
            robot = replace(robot, nominal=nominal, lower=lower, upper=upper, payloads={})
            if self.settings.law == "sampled":  # M_s is what the gains were chosen with
                points = central_parameters(robot), points[1]
        return make_kernel_controller(robot, self.settings, self.loop, *points)

    @property
    @own_environment()
    def period(self) -> float:
        """T, for which a command is held [s]."""
        return 1.0 / self.loop.rate

    @cached_property
    def rate_need(self) -> RateNeed | None:
        """The rate that this law and its gains need, estimated; None for laws that know the hold.

        Of the motion that the controller was made for, else at rest.
        """
        return needed_rate(self.robot, self.settings, self.loop, self._motion)

    def command(
        self,
        t: float,
        q: ArrayLike,
        dq: ArrayLike,
        q_des: ArrayLike,
        dq_des: ArrayLike,
        ddq_des: ArrayLike,
    ) -> Command:
        """The torque for the state measured at time ``t``.

        The laws ``norm`` and ``componentwise`` are (3), (4), (7), (8) and (29); ``sampled`` is (31)
        to (34): it takes each call for one tick, a period after the one before.

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

        Source: (3), (4), (7), (8) of [GA17], (31) to (34); kernel twin ``mr_command``.
        """
        time = as_number("t", t, "s")
        if not math.isfinite(time):
            raise ValueRangeError(f"t: {time:g} s; must be finite")
        signals = self._signals((), q=q, dq=dq, q_des=q_des, dq_des=dq_des, ddq_des=ddq_des)
        try:
            if self._before is not None and self.settings.law == "sampled":
                take_over(self._before, self.kernel, self.robot.n, time, signals)
            out = self.kernel.command(time, *signals.values())
        except _kernel.KernelError as problem:
            raise self._refusal(problem, signals) from None
        self._before = None
        tau, nominal, v, phi_lo, phi_hi, rho = out
        kernel = self.kernel
        return Command(
            *(tau, nominal, v, phi_lo, phi_hi, rho),
            *(kernel.rho_norm, kernel.integral_rate, kernel.alpha),
        )

    @own_environment()
    def step(
        self,
        q: ArrayLike,
        dq: ArrayLike,
        q_des: ArrayLike,
        dq_des: ArrayLike,
        ddq_des: ArrayLike,
    ) -> Command:
        """The command of the next tick, `period` after the last: for a loop of one's own.

        The first one is at time 0. Torques of the law ``sampled`` stay within the effort limits.

        Args:
            q: Measured positions, ``(n,)`` [rad] or [m].
            dq: Measured velocities, ``(n,)`` [rad/s] or [m/s].
            q_des: Desired positions now, ``(n,)`` [rad] or [m].
            dq_des: Desired velocities, ``(n,)`` [rad/s] or [m/s].
            ddq_des: Desired accelerations, ``(n,)`` [rad/s^2] or [m/s^2].

        Raises:
            ShapeError: A vector does not have ``n`` entries.
            ValueRangeError: As for `command`.

        Source: (3) to (8) of [GA17], (29), (31) to (34); kernel twin ``mr_command``.
        """
        answer = self.command(self._ticks / self.loop.rate, q, dq, q_des, dq_des, ddq_des)
        self._ticks += 1
        return answer

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
            ValueRangeError: A number is none, not finite or negative, an angle is beyond 1e5 rad
                as for `command`, or the law is ``sampled``.

        Source: (3), (4), (7), (8) of [GA17]; kernel twin ``mr_command``.
        """
        if self.settings.law == "sampled":
            raise ValueRangeError(
                'law: "sampled" is no function of the state alone: it goes from tick to tick; call '
                'command() once a period, or take the law "norm"'
            )
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
        return Command(tau, nominal, v, phi_lo, phi_hi, rho, rho_norm, rate, 1.0)

    @own_environment()
    def reset(self, q: ArrayLike | None = None) -> None:
        """Forget time and integrals, as if no command had been given yet.

        The law ``sampled`` then leads from where the robot stands to the motion, (34).

        Args:
            q: Where it stands, ``(n,)`` [rad] or [m]; None = as the next command measures it.

        Raises:
            ShapeError: ``q`` does not have ``n`` entries.
            ValueRangeError: A number is none or not finite.

        Source: our own, (34).
        """
        self.kernel.reset()
        self._before, self._ticks = None, 0
        if q is not None and self.settings.law == "sampled":
            place = self._signals((), q=q)["q"]
            memory = np.zeros(4 * self.robot.n)
            memory[2 * self.robot.n : 3 * self.robot.n] = place
            self.kernel.recall(0.0, 0.0, 0.0, -1, 0.0, memory, 0.0, 0.0, 0.0, 1.0)

    @own_environment()
    def use(self, payload: str | None) -> None:
        """From the next command on, count on one of the robot's named payloads, or on any of them.

        The guarantee is then that of the payload's own box: w of every point of it lies in [Phi].
        While a payload is being grasped or laid down, use None: the box around all of them.
        Integrals go on: the next torque of the law ``sampled`` is the one that the box before
        would have led to, as far as the new [Phi] allows it. Gains stay.

        Args:
            payload: A name in the description's ``payloads``, or None for the box around them.

        Raises:
            ValueRangeError: No payload has that name.

        Source: our own; docs/theory/guarantees.md.
        """
        known = self.robot.payloads
        if payload is not None and payload not in known:
            found = f'payload: no payload "{payload}" in the description'
            raise ValueRangeError(unknown_name(found, payload, known))
        kernel = self._kernel_of(payload)
        kernel.recall(*self.kernel.memory())
        self._before = self._before or self.kernel
        self.kernel, self.payload = kernel, payload

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


def designed(
    robot: Robot, settings: ControllerSettings, loop: LoopSettings, motion: Trajectory | None
) -> tuple[ControllerSettings, Design]:
    """The settings of the law ``auto`` with gains for a motion, None = any, and their design.

    What the settings say beside the gains stands.
    """
    found = design(robot, loop, epsilon=settings.epsilon, motion=motion)
    parts = {name: getattr(settings, name) for name in PARTS}
    return replace(found.settings, bound=settings.bound, **parts), found
