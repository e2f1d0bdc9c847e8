"""The loop that a drive runs, checked for a robot."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from modrobust.checks import as_number, shape_error, unknown_name
from modrobust.errors import ValueRangeError
from modrobust.model.parts import DISTURBANCES, NOISES, SENSOR_SIZES, VELOCITIES, LoopSettings
from modrobust.model.robot import Robot, owner_of

MAX_RATE = 1e7  # [Hz]


def checked_loop(
    robot: Robot,
    loop: LoopSettings | None,
    rate: float | None = None,
    delay: float | None = None,
) -> LoopSettings:
    """The loop that is given, or the robot's own, with rate and delay laid over it.

    Raises:
        ValueRangeError: It is none, or a setting is unknown, not finite or out of its range.
        ShapeError: Noise or steps do not have one entry a joint.
    """
    found = robot.loop if loop is None else loop
    if not isinstance(found, LoopSettings):
        raise ValueRangeError(f"loop: a {type(found).__name__}; must be a LoopSettings")
    hertz = as_number("rate", found.rate if rate is None else rate, "Hz")
    if not (math.isfinite(hertz) and 1.0 <= hertz <= MAX_RATE):
        raise ValueRangeError(
            f"rate: {hertz:g} Hz; must lie in [1, {MAX_RATE:g}] Hz; most drives take 250 to 4000"
        )
    late = as_number("delay", found.delay if delay is None else delay)
    if not 0.0 <= late <= 1.0:
        raise ValueRangeError(f"delay: {late:g}; must lie in [0, 1], in periods of the loop")
    for name, known in (
        ("noise", NOISES),
        ("velocity", VELOCITIES),
        ("disturbance", DISTURBANCES),
    ):
        value = getattr(found, name)
        if value not in known:
            raise ValueRangeError(unknown_name(f'{name}: no {name} "{value}"', value, known))
    for name in ("filter", "frequency"):
        value = as_number(name, getattr(found, name))
        if not (math.isfinite(value) and value > 0.0):
            raise ValueRangeError(f"{name}: {value:g}; must be finite and positive")
    sizes: dict[str, Any] = {name: _sizes(robot, found, name) for name in SENSOR_SIZES}
    return replace(found, rate=hertz, delay=late, **sizes)


def _sizes(robot: Robot, loop: LoopSettings, name: str) -> tuple[float, ...]:
    """One size a joint, from one for all as well; none where there is none."""
    array = np.asarray(getattr(loop, name), dtype=np.float64)
    if array.size == 0:
        return ()
    array = np.full(robot.n, float(array)) if array.ndim == 0 else array
    if array.shape != (robot.n,):
        raise shape_error(f"loop.{name}", (robot.n,), array.shape, owner_of(robot))
    if not (np.isfinite(array).all() and (array >= 0.0).all()):
        raise ValueRangeError(f"loop.{name}: must be finite and not negative")
    return tuple(array.tolist())
