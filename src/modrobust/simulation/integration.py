r"""How the plant is integrated between two commands: by which method, in how many steps.

Friction (20) around standstill pulls each velocity back at a rate that grows with
:math:`F_c / v_c` over the inertia that it acts on:

.. math:: \lambda = \max_q \lambda_{\max}\!\left(M(q)^{-1}
          \mathrm{diag}(F_v + F_c / v_c)\right)

Runge-Kutta's method of fourth order is stable for steps h with :math:`\lambda h < 2.78`. Where that
needs too many steps, as on a link without a rotor, an implicit method of second order takes over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from modrobust import _kernel
from modrobust.checks import as_integer
from modrobust.control.rate import fastest_mode
from modrobust.kernel import own_environment
from modrobust.model import Parameters, Robot
from modrobust.motion import Trajectory

MAX_SUBSTEPS = 10**6
_LONGEST = 5e-4  # [s], a step of Runge-Kutta
_STABLE = 1.4  # lambda h: half of what is stable, because lambda is found at a few positions
_MOST = 12  # steps a millisecond, beyond which the implicit method is quicker
_IMPLICIT = 2e-4  # [s], its step
_POSITIONS = 17


@dataclass(frozen=True)
class Steps:
    """Steps of the integrator a tick.

    Args:
        count: How many.
        implicit: Whether by the implicit method instead of Runge-Kutta's.
    """

    count: int
    implicit: bool

    @property
    def method(self) -> str:
        """The method in words."""
        return "implicit, second order" if self.implicit else "Runge-Kutta, fourth order"


@own_environment()
def choose_steps(
    robot: Robot,
    parameters: Parameters,
    motion: Trajectory,
    duration: float,
    dt: float,
    given: int | None,
) -> Steps:
    """The steps for a run, or what was given, by Runge-Kutta's method.

    Args:
        robot: Robot with n joints.
        parameters: What the plant is made of.
        motion: The desired motion, along which lambda is looked for.
        duration: Of the run [s].
        dt: Tick [s].
        given: Steps a tick that the caller wants, or None.

    Raises:
        ValueRangeError: ``given`` is not in [1, 10^6].
    """
    if given is not None:
        return Steps(as_integer("substeps", given, 1, MAX_SUBSTEPS), False)
    rate = friction_rate(robot, parameters, motion.sample(np.linspace(0, duration, _POSITIONS))[0])
    step = min(_LONGEST, _STABLE / rate if rate > 0.0 else math.inf)
    if step < 1e-3 / _MOST and step < dt:
        return Steps(max(1, math.ceil(dt / _IMPLICIT * (1.0 - 1e-9))), True)
    return Steps(max(1, math.ceil(dt / step * (1.0 - 1e-9))), False)


def friction_rate(robot: Robot, parameters: Parameters, positions: np.ndarray) -> float:
    """Lambda over positions ``(k, n)`` [1/s]; infinite where M cannot be computed."""
    speed = robot.coulomb_speed
    slope = np.divide(parameters.coulomb, speed, out=np.zeros(robot.j), where=speed > 0.0)
    slope = slope + parameters.viscous
    of_free = slope[robot.free]
    np.add.at(of_free, robot.mimic.leaders, robot.mimic.multiplier**2 * slope[robot.mimic.joints])
    if not of_free.any():
        return 0.0
    found = 0.0
    for q in positions:
        try:
            M = _kernel.mass_matrix(robot.model, parameters.packed, np.ascontiguousarray(q), True)
        except _kernel.KernelError:
            return math.inf
        found = max(found, fastest_mode(M, np.diag(of_free))[0])
    return found
