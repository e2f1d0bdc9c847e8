r"""Why a loop diverged: the joint whose inertia is too small for a gain that is held.

Between two ticks the command stands still, T = 1 / control rate. The robust torque v = k r of (7),
k = kappa ‖rho‖ + phi, brakes a joint of inertia J by the share k T / J of its velocity in one hold:
from 2 on it leaves the joint faster than it was, in the other direction. With all joints coupled

.. math:: k T\,\lambda_{\max}(M^{-1}) = k T / \lambda_{\min}(M) < 2

This explains runs that diverged; it proves nothing of those that did not.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.model import ControllerSettings, Parameters, Robot

_HELD = 2.0  # k T / J from which a held gain drives a joint
_LIKELY = 1.0  # between two logged ticks it may have grown from here to 2
_QUIET = 0.5  # k T / J at which a held gain brakes without overshoot, with some room
_ROWS = 1000  # looked at, at most, besides the last
_LAST = 100


@dataclass(frozen=True)
class Divergence:
    """Where a diverged loop broke, and what would help.

    joint: Name of the joint that the gain drives most; None where no tick was logged.
    kind: Its type, "revolute" or "prismatic"; None where there is no joint.
    t: When the gain was too large for the hold, for the first time seen [s].
    gain: k = kappa ‖rho‖ + phi at that time [N m s/rad] or [N s/m].
    inertia: Least eigenvalue of M there, true parameters, drives included [kg m^2] or [kg].
    hold: T [s].
    share: gain hold / inertia; 2 is the limit of what is stable.
    rate: Control rate that would brake without overshoot at that gain [Hz].

    All but `joint`, `kind` and `hold` are None where the gain does not explain the divergence.
    """

    joint: str | None
    kind: str | None
    hold: float
    t: float | None = None
    gain: float | None = None
    inertia: float | None = None
    share: float | None = None
    rate: float | None = None
    drive: bool = True
    """Whether the joint's reflected rotor inertia is described."""
    bound: str = "hull"
    """The bound that the gain came from."""

    @property
    def cause(self) -> str:
        """What broke, in words that follow "the loop diverged at ... s: "."""
        if self.joint is None:
            return "in its first steps"
        if self.gain is None or self.inertia is None or self.share is None:
            return f'joint "{self.joint}" moved fastest; the gain does not explain it'
        turns = self.kind == "revolute"
        gain, inertia = ("N m s/rad", "kg m^2") if turns else ("N s/m", "kg")
        return (
            f'joint "{self.joint}": the gain kappa ‖rho‖ + phi of {self.gain:.3g} {gain}, held for '
            f"{self.hold * 1e3:.3g} ms, is {self.share:.3g} times its inertia of "
            f"{self.inertia:.3g} {inertia} (smallest eigenvalue of M); a held gain is stable below "
            f"{_HELD:g} times"
        )

    @property
    def remedies(self) -> list[str]:
        """What helps, the best first."""
        if self.rate is None:
            return ["a higher control rate", "lower gains", "a start nearer to the motion"]
        rate = f"{self.rate:.3g} Hz" if self.rate < 1e3 else f"{self.rate / 1e3:.3g} kHz"
        said = [f"a control rate of {rate} or more"]
        if not self.drive:
            said.append("the joint's drive in the description (rotor inertia and gear ratio)")
        if self.bound != "hull":
            said.append('bound "hull", whose rho is smaller')
        return [*said, "lower gains kappa_P, kappa_I, phi_P, phi_I"]

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {**asdict(self), "cause": self.cause, "remedies": self.remedies}


def find_divergence(
    robot: Robot,
    parameters: Parameters,
    controller: ControllerSettings,
    hold: float,
    t: Array,
    q: Array,
    dq: Array,
    error: Array,
    rho: Array,
) -> Divergence:
    """The first logged tick at which the gain was too large for the hold, and its joint.

    Args:
        robot: Robot with n joints.
        parameters: True parameters of the plant.
        controller: The gains of the run.
        hold: T, time between two commands [s].
        t: Logged instants ``(m,)`` [s].
        q: Positions, ``(m, n)`` [rad] or [m].
        dq: Velocities, ``(m, n)`` [rad/s] or [m/s].
        error: Norm of the tracking error, ``(m,)``.
        rho: Worst cases (8), ``(m, n)``.
    """
    if not len(t):
        return Divergence(None, None, hold)
    gains = _gains(controller, t, error, rho)
    worst: tuple[float, int, int, float] | None = None  # share, row, joint, inertia
    for k in _rows(len(t)):
        found = _least_inertia(robot, parameters, q[k])
        if found is None or not math.isfinite(gains[k]):
            continue
        joint, inertia = found
        share = float(gains[k]) * hold / inertia
        if worst is None or share > worst[0]:
            worst = share, k, joint, inertia
        if share >= _HELD:
            break
    if worst is None or worst[0] < _LIKELY:
        joint = int(np.argmax(np.nan_to_num(np.abs(dq[-1]), nan=np.inf)))
        return Divergence(robot.joint_names[joint], robot.free_types[joint], hold)
    share, k, joint, inertia = worst
    i = robot.free[joint]
    reflected = robot.gear_ratio[i] ** 2 * robot.nominal.rotor_inertia[i]
    return Divergence(
        joint=robot.joint_names[joint],
        kind=robot.free_types[joint],
        hold=hold,
        t=float(t[k]),
        gain=float(gains[k]),
        inertia=inertia,
        share=share,
        rate=_rounded_up(share / (_QUIET * hold)),
        drive=bool(reflected > 0.0),
        bound=controller.bound,
    )


def _gains(c: ControllerSettings, t: Array, error: Array, rho: Array) -> Array:
    """``k = kappa ‖rho‖ + phi`` at the logged ticks ``(m,)``, the integral summed over them."""
    with np.errstate(over="ignore", invalid="ignore"):
        grown = np.where(error < c.epsilon, 0.0, error)[:-1] * np.diff(t)
        integral = np.concatenate([[0.0], np.cumsum(grown)])
        kappa, phi = (c.kappa_P + c.kappa_I * integral, c.phi_P + c.phi_I * integral)
        result: Array = kappa * np.linalg.norm(rho, axis=1) + phi
    return result


def _rows(count: int) -> list[int]:
    """Indices looked at: evenly spaced ones, and all of the end, where it goes fast."""
    spread = np.linspace(0, count - 1, min(count, _ROWS)).astype(int)
    return sorted({*spread.tolist(), *range(max(0, count - _LAST), count)})


def _least_inertia(robot: Robot, parameters: Parameters, q: Array) -> tuple[int, float] | None:
    """Joint and value of the smallest eigenvalue of M(q); None where M cannot be computed."""
    try:
        M = _kernel.mass_matrix(robot.model, parameters.packed, q, True)
    except _kernel.KernelError:
        return None
    values, vectors = np.linalg.eigh(M)
    if not values[0] > 0.0:
        return None
    return int(np.argmax(np.abs(vectors[:, 0]))), float(values[0])


def _rounded_up(rate: float) -> float:
    """The rate with one or two digits, never less."""
    step = 10.0 ** (math.floor(math.log10(rate)) - 1) * 5.0
    return math.ceil(rate / step) * step


__all__ = ["Divergence", "find_divergence"]
