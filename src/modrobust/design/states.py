"""Where a robot is looked at: seeded configurations, and states along a motion or of any motion."""

from __future__ import annotations

import math

import numpy as np

from modrobust.checks.types import Array
from modrobust.model import Robot

CONFIGURATIONS = 24
_SEED = 20281128


def position_range(robot: Robot) -> tuple[Array, Array]:
    """Ends (n,), (n,) [rad] or [m] of the middle 80 % of what each joint may reach.

    A joint without limits is taken within a turn, or +-0.25 m; one with a single limit within half
    a turn, or 0.5 m, of it.
    """
    lo, hi = robot.position_limits.T
    turns = robot.free_turns
    half = np.where(turns, math.pi, 0.25)  # [rad], [m]
    span = np.where(turns, math.pi, 0.5)
    known_lo, known_hi = np.isfinite(lo), np.isfinite(hi)
    low = np.where(known_lo, lo, np.where(known_hi, hi - span, -half))
    high = np.where(known_hi, hi, np.where(known_lo, lo + span, half))
    low, high = (
        np.where(turns & (high > -math.pi), np.maximum(low, -math.pi), low),
        np.where(turns & (low < math.pi), np.minimum(high, math.pi), high),
    )
    width = high - low
    return low + 0.1 * width, high - 0.1 * width


def configurations(robot: Robot, count: int = CONFIGURATIONS) -> Array:
    """Seeded positions ``(count, n)`` [rad] or [m] inside `position_range`, ever the same."""
    lo, hi = position_range(robot)
    drawn = np.random.default_rng(_SEED).random((count, robot.n))
    return np.asarray(lo + drawn * (hi - lo))
