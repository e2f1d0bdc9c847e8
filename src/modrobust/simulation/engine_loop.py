"""The closed loop with a plant of another engine: the twin of the kernel's loop, tick by tick.

The controller is the same compiled one; only the robot is not ours.
"""

from __future__ import annotations

import math

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.control import RobustController
from modrobust.model import Parameters
from modrobust.simulation.plants import Plant

_LOGGED = ("q", "dq", "q_des", "dq_des", "ddq_des", "tau", "w", "phi_lo", "phi_hi", "rho")
_WIDTHS = {"width_hull": _kernel.HULL, "width_ianea": _kernel.IANEA}


class EngineLoop:
    """Same attributes and `advance` as ``_kernel.Loop``, for any `Plant`.

    Args:
        controller: The controller of a robot with n joints.
        plant: The true robot in motion.
        true_parameters: What the plant is made of; w is computed from them.
        true_disturbance: Constant true disturbance ``(n,)`` that the plant applies.
        dt: Tick [s].
    """

    def __init__(
        self,
        controller: RobustController,
        plant: Plant,
        true_parameters: Parameters,
        true_disturbance: Array,
        dt: float,
    ) -> None:
        robot = controller.robot
        self.status = _kernel.STATUS_OK
        self.ticks = 0
        self.violations = 0
        self.violation_max = 0.0
        self.error_last = 0.0
        self.last_outside = -1.0
        self.error_max_after = 0.0
        self.rho_sum = 0.0
        self.rho_max = 0.0
        self.tau_max: Array = np.zeros(robot.n)
        self._total_variation: Array = np.zeros(robot.n)
        self._tau_previous: Array = np.zeros(robot.n)
        self._controller, self._plant, self._dt = controller.kernel, plant, dt
        self._robot, self._model = robot, robot.model
        self._true, self._disturbance = true_parameters.packed, true_disturbance
        box = np.stack([robot.disturbance.lo, robot.disturbance.hi])
        self._box = robot.nominal.packed, robot.lower.packed, robot.upper.packed, box
        self._K_r = np.array(controller.settings.K_r)
        self._epsilon = controller.settings.epsilon
        self._n = robot.n

    @property
    def time(self) -> float:
        """End of the last tick [s]."""
        return self.ticks * self._dt

    @property
    def q(self) -> Array:
        """Positions now, ``(n,)``."""
        return np.array(self._plant.q)

    @property
    def dq(self) -> Array:
        """Velocities now, ``(n,)``."""
        return np.array(self._plant.dq)

    def advance(
        self, q_des: Array, dq_des: Array, ddq_des: Array, log_every: int
    ) -> dict[str, Array]:
        """Runs the ticks of the reference rows; arrays of the ticks logged on the way.

        Ends early with `status` set where a tick cannot be computed; all before it stands.
        """
        times: list[float] = []
        rows: dict[str, list[Array]] = {
            name: [] for name in (*_LOGGED, *_WIDTHS, "total_variation")
        }
        for qd, dqd, ddqd in zip(q_des, dq_des, ddq_des, strict=True):
            keep = self.ticks % log_every == 0
            try:
                logged = self._tick(qd, dqd, ddqd, keep)
            except _kernel.KernelError:
                self.status = _kernel.STATUS_DIVERGED
                break
            if keep:
                times.append((self.ticks - 1) * self._dt)
                for name, row in logged.items():
                    rows[name].append(row)
            if not (np.isfinite(self._plant.q).all() and np.isfinite(self._plant.dq).all()):
                self.status = _kernel.STATUS_DIVERGED
                break
        shape = (len(times), self._n)
        return {
            "t": np.array(times, dtype=np.float64),
            **{name: np.array(found).reshape(shape) for name, found in rows.items()},
        }

    def _tick(self, qd: Array, dqd: Array, ddqd: Array, keep: bool) -> dict[str, Array]:
        t = self.time
        q, dq = self._plant.q, self._plant.dq
        tau, nominal, _, lo, hi, rho = self._controller.command(t, q, dq, qd, dqd, ddqd)
        error = self._robot.tracking_error(q, qd)
        dq_a = dqd + self._K_r * error
        ddq_a = ddqd + self._K_r * (dqd - dq)
        reference = (q, dq, dq_a, ddq_a)
        widths = {name: self._width(bound, reference) for name, bound in _WIDTHS.items() if keep}
        true, rounding = _kernel.inverse_dynamics_rounding(
            self._model, self._true, *reference, True
        )
        w = true - nominal - self._disturbance
        sizes = np.abs(true) + np.abs(nominal) + np.abs(self._disturbance)
        excess = float((np.maximum(lo - w, w - hi) - (rounding + 2.0**-52 * sizes)).max())
        if excess > 0.0:  # (24)
            self.violations += 1
            self.violation_max = max(self.violation_max, excess)
        self._measure(t, error, tau)
        values = (q, dq, qd, dqd, ddqd, tau, w, lo, hi, rho)
        logged = dict(zip(_LOGGED, values, strict=True)) if keep else {}
        if keep:
            logged |= {**widths, "total_variation": self._total_variation.copy()}
        self.ticks += 1
        self._plant.advance(tau)
        return logged

    def _width(self, bound: int, reference: tuple[Array, Array, Array, Array]) -> Array:
        q, dq, dq_a, ddq_a = reference
        lo, hi = _kernel.perturbation_bounds(self._model, *self._box, q, dq, dq_a, ddq_a, bound)
        return np.asarray(hi - lo)

    def _measure(self, t: float, error: Array, tau: Array) -> None:
        if self.ticks > 0:
            self._total_variation += np.abs(tau - self._tau_previous)
        self._tau_previous = tau
        self.tau_max = np.maximum(self.tau_max, np.abs(tau))
        self.error_last = math.sqrt(float(error @ error))
        if self.error_last >= self._epsilon:
            self.last_outside, self.error_max_after = t, 0.0
        else:
            self.error_max_after = max(self.error_max_after, self.error_last)
        rho_norm = self._controller.rho_norm
        self.rho_sum += rho_norm
        self.rho_max = max(self.rho_max, rho_norm)
