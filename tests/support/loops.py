"""The compiled loop of a controller, with what a test does not care for filled in."""

from __future__ import annotations

from typing import Any

import numpy as np

import modrobust as mr
from modrobust import _kernel
from modrobust.control.settings import kernel_loop
from modrobust.model import Parameters


def make_loop(
    controller: mr.RobustController,
    parameters: Parameters | None = None,
    d: Any = None,
    q: Any = None,
    dq: Any = None,
    *,
    plant: Any = None,
    substeps: int = 1,
    implicit: bool = False,
    seed: int = 0,
    **changes: Any,
) -> Any:
    """A ``_kernel.Loop``: of a controller, its own settings, at rest at 0, of the nominal robot.

    d: constant disturbance (n,); changes: of `kernel_loop`, by name, such as ``dt`` [s] or
    ``noise_position``.
    """
    robot = controller.robot
    zero = np.zeros(robot.n)
    settings = {**kernel_loop(controller.loop, seed, substeps, implicit), **changes}
    start = [zero if x is None else np.array(x, dtype=float) for x in (d, q, dq)]
    point = robot.nominal if parameters is None else parameters
    made: Any = _kernel.Loop
    return made(controller.kernel, point.packed, *start, settings, plant)
