r"""The rule that chooses the gain G, and the three things that bound it.

.. math::
   G = \min\left(G_{stab},\; G_{noise},\; \max(G_{eps},\; 20/\mathrm{s})\right), \quad
   \Lambda = G/2, \quad L_i = G^2 \min(0.05,\; \pi_1)                              \quad (35)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.design.need import Need, need
from modrobust.design.points import central_parameters, light_parameters
from modrobust.design.scalar import LAMBDA, LoopTiming, filter_share, stable_gain
from modrobust.design.spectra import Spectra, spectra
from modrobust.design.states import MotionStates
from modrobust.model import LoopSettings, Parameters, Robot

FLOOR = 20.0  # [1/s]: a slower loop would hardly follow a motion
NOISE_SHARE = 0.3  # of an effort limit: what noise through the gains may take of it
UNIFORM = math.sqrt(3.0)  # three standard deviations of noise that is uniform in [-1, 1]
LEAST_POSITION_NOISE = 1e-6  # [rad] or [m]: no sensor is better; without it 4 kHz asks for
LEAST_VELOCITY_NOISE = 1e-4  # [rad/s] or [m/s]: many times the limit
_ROUNDS = 60


@dataclass(frozen=True)
class GainChoice:
    """What the rule found for a robot, a loop, a set of states and an epsilon."""

    central: Parameters
    light: Parameters
    spectra: Spectra
    need: Need
    light_mass: Array
    """M_s in the states, ``(k, n, n)`` [kg m^2]."""
    stability: float
    """G_stab [1/s]."""
    noise: float
    """G_noise [1/s]; infinite where no joint has an effort limit."""
    accuracy: float
    """G_eps [1/s]."""
    reached: float
    """The epsilon that the two limits allow [rad] or [m]."""

    @property
    def limit(self) -> float:
        """The largest gain that loop and noise allow [1/s]."""
        return min(self.stability, self.noise)

    @property
    def gain(self) -> float:
        """G of (35) [1/s]."""
        return min(self.limit, max(self.accuracy, FLOOR))

    @property
    def binding(self) -> str:
        """What G stops at: "stability", "noise", "epsilon" or "floor"."""
        if self.gain < self.limit:
            return "epsilon" if self.accuracy > FLOOR else "floor"
        return "stability" if self.stability <= self.noise else "noise"

    @property
    def reachable(self) -> bool:
        """Whether the gain that epsilon asks for is allowed."""
        return self.accuracy <= self.limit


def choose(
    robot: Robot,
    loop: LoopSettings,
    states: MotionStates,
    epsilon: float,
    known: GainChoice | None = None,
) -> GainChoice:
    """The rule (35) for checked arguments.

    Args:
        robot: Its bounds are the box.
        loop: As the drive runs it.
        states: Of the motion, or of any.
        epsilon: Norm of the error to stay within [rad] or [m].
        known: What was found for the same box and states; only the loop, the effort limits or
            epsilon are others.

    Source: our own; (35) to (39) of docs/theory/equations.md.
    """
    if known is None:
        central = central_parameters(robot)
        light = light_parameters(robot, central, states.q)
        found = spectra(robot, central, light, states.q)
        M_s = np.array([_kernel.mass_matrix(robot.model, light.packed, q, True) for q in states.q])
        push = need(robot, central, M_s, states)
    else:
        central, light, found = known.central, known.light, known.spectra
        M_s, push = known.light_mass, known.need
    stability = stable_gain(found, timing(loop))
    noise = noise_gain(M_s, robot.effort_limits, loop)
    limit = min(stability, noise)
    return GainChoice(
        central,
        light,
        found,
        push,
        M_s,
        stability,
        noise,
        math.sqrt(4.0 * push.total / epsilon),
        4.0 * push.total / limit**2,
    )


def timing(loop: LoopSettings) -> LoopTiming:
    """What a loop's stability depends on."""
    corner = loop.filter if loop.velocity == "differentiated" else None
    return LoopTiming(1.0 / loop.rate, loop.delay, corner)


def integral_gain(G: float, found: Spectra) -> float:
    """L_i of (35) [1/s^2]."""
    return G * G * min(0.05, found.light[0])


def measured_noise(loop: LoopSettings, n: int) -> tuple[Array, Array]:
    r"""Largest errors of the q and dq that the law gets, ``(n,)`` each, in rad or m and per s.

    .. math:: n_q + \Delta q / 2, \qquad n_v + \Delta v / 2 \quad\text{or, differentiated,}\quad
              (\Delta q + 2 n_q)\,(1 - e^{-2 \pi f T}) / T

    with declared noise n and steps Delta; at least 1e-6 and 1e-4, which no sensor falls below.

    Args:
        loop: As the drive runs it.
        n: Number of joints.
    """

    def of(values: tuple[float, ...]) -> Array:
        return np.array(values) if values else np.zeros(n)

    step = of(loop.quantisation_position)
    position = of(loop.noise_position) + 0.5 * step
    if loop.velocity == "differentiated":
        passed = filter_share(loop.filter, 1.0 / loop.rate)
        velocity = (step + 2.0 * of(loop.noise_position)) * loop.rate * passed
    else:
        velocity = of(loop.noise_velocity) + 0.5 * of(loop.quantisation_velocity)
    return np.maximum(position, LEAST_POSITION_NOISE), np.maximum(velocity, LEAST_VELOCITY_NOISE)


def noise_gain(light_mass: Array, limits: Array, loop: LoopSettings) -> float:
    r"""G_noise [1/s]: the largest gain at which noise asks for 0.3 of an effort limit.

    .. math:: \sqrt3\,\lVert e_i^T M_s\,(\tfrac32 G N_v + \tfrac12 G^2 N_q) \rVert
              \le 0.3\,\overline\tau_i

    for every joint i with a limit and every state; N_q counts n_q + D T n_v, since the predictor
    takes a velocity for the delay's time.

    Args:
        light_mass: M_s, ``(k, n, n)`` [kg m^2].
        limits: Effort limits ``(n,)`` [N m] or [N].
        loop: As the drive runs it.

    Source: our own; (39) of docs/theory/equations.md.
    """
    limited = np.isfinite(limits)
    if not limited.any():
        return math.inf
    position, velocity = measured_noise(loop, len(limits))
    position = position + loop.delay / loop.rate * velocity
    rows, room = light_mass[:, limited], NOISE_SHARE * limits[limited]

    def fits(G: float) -> bool:
        each = (1.0 + LAMBDA) * G * velocity + LAMBDA * G * G * position
        asked = UNIFORM * np.sqrt(((rows * each) ** 2).sum(axis=2))
        return bool((asked <= room).all())

    low, high = 0.0, 1.0
    while fits(high):
        low, high = high, 2.0 * high
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low
