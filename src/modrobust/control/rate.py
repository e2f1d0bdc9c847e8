r"""The rate that gains of one's own need: an estimate from runs that failed, no bound.

.. math:: x = T\,\max_t \lambda_{\max}\!\left(M_s(q_d)^{-1} K(q_d)\right), \quad
          K = \mathrm{diag}(\kappa_P \|\rho\| + \varphi_P)

along the desired motion, with :math:`\kappa_P\rho_i` for the law ``componentwise``; M_s is the mass
matrix at the light end of the box. Of 6,000 runs on 22 robots without delay, x > 3.5 missed 3 % of
those that failed and named 17 % that did not; x > 1 missed none and named 51 %. With a delay of one
period the two limits are 1.75 and 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.design.points import central_parameters, light_parameters
from modrobust.design.states import configurations
from modrobust.kernel import BOUNDS, own_environment
from modrobust.model import ControllerSettings, LoopSettings, Robot
from modrobust.motion import Trajectory
from modrobust.motion.trajectory import motion_time

_STATES = 33
_MAY = 1.0
_WILL = 3.5  # halved by a delay of one period


@dataclass(frozen=True)
class RateNeed:
    """What a law and its gains ask of the loop's rate, estimated.

    Args:
        share: x at the rate of the loop; above `may` a run can diverge, above `will` it most
            likely does.
        will: The limit of x that names a failure.
        rate: At which x would be `may` [Hz].
        joint: Name of the joint that x is found on.
    """

    share: float
    will: float
    rate: float
    joint: str
    may: float = _MAY

    @property
    def warning(self) -> str | None:
        """One sentence where the loop is too slow for the gains, else None."""
        if not self.share > self.may:
            return None
        verb = "will most likely" if self.share > self.will else "may"
        return (
            f"at this rate the loop {verb} diverge: the gains need about {hertz(self.rate)} (an "
            f'estimate; joint "{self.joint}"); take the law "auto", which chooses gains for the '
            "rate"
        )


@own_environment()
def needed_rate(
    robot: Robot, settings: ControllerSettings, loop: LoopSettings, motion: Trajectory | None
) -> RateNeed | None:
    """The estimate, or None for laws that know the hold, and where M cannot be computed."""
    if settings.law not in ("norm", "componentwise") or settings.hold_aware:
        return None
    if motion is None:
        q = configurations(robot)
        dq = ddq = np.zeros_like(q)
    else:
        duration = motion_time(motion) or 10.0
        q, dq, ddq = motion.sample(np.linspace(0.0, duration, _STATES))
    try:
        light = light_parameters(robot, central_parameters(robot), q)
        states = zip(q, dq, ddq, strict=True)
        found = [_share(robot, settings, light.packed, *state) for state in states]
    except (_kernel.KernelError, ArithmeticError, ValueError):
        return None
    share, joint = max(found)
    share /= loop.rate
    will = _WILL / (1.0 + loop.delay)
    return RateNeed(share, will, share * loop.rate / _MAY, robot.joint_names[joint])


def _share(
    robot: Robot, settings: ControllerSettings, light: Array, q: Array, dq: Array, ddq: Array
) -> tuple[float, int]:
    """lambda_max(M_s^-1 K) at a state and the joint that it is found on."""
    box = robot.nominal.packed, robot.lower.packed, robot.upper.packed
    d = np.stack([robot.disturbance.lo, robot.disturbance.hi])
    code = BOUNDS[settings.bound]
    lo, hi = _kernel.perturbation_bounds(robot.model, *box, d, q, dq, dq, ddq, code)
    rho = np.maximum(np.abs(lo), np.abs(hi))
    if settings.law == "norm":
        rho = np.full(robot.n, np.linalg.norm(rho))
    gain = np.minimum(settings.kappa_P * rho + settings.phi_P, 1e300)
    return fastest_mode(_kernel.mass_matrix(robot.model, light, q, True), np.diag(gain))


def fastest_mode(M: Array, K: Array) -> tuple[float, int]:
    """Largest eigenvalue of M^-1 K [1/s], and the entry of its vector that is largest.

    Args:
        M: Mass matrix, ``(n, n)``, positive definite [kg m^2].
        K: Symmetric, ``(n, n)`` [N m s/rad].

    Raises:
        LinAlgError: M is not positive definite.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    values, vectors = np.linalg.eigh(inverse @ K @ inverse.T)
    return float(values[-1]), int(np.argmax(np.abs(inverse.T @ vectors[:, -1])))


def hertz(rate: float) -> str:
    """A rate for people, two digits."""
    return f"{rate:.2g} Hz" if rate < 1e3 else f"{rate / 1e3:.2g} kHz"
