"""The law ``sampled`` from one payload's box to another's, without a jump of the torque."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.kernel import own_environment


@own_environment()
def take_over(
    before: _kernel.Controller,
    now: _kernel.Controller,
    n: int,
    time: float,
    signals: Mapping[str, Array],
) -> None:
    """Moves sigma of `now` by what the nominal torque jumps from `before` at the next command.

    Args:
        before: The controller until now.
        now: The one that goes on, with the same memory.
        n: Number of joints.
        time: Of the next command [s].
        signals: Of the next command, ``(n,)`` each.

    Raises:
        KernelError: There is no command for these signals; both are as they were.
    """
    old, memory = before.memory(), now.memory()
    try:
        jump = before.command(time, *signals.values())[1]
        jump = jump - now.command(time, *signals.values())[1]
    finally:
        before.recall(*old)
        now.recall(*memory)
    remembered = np.array(memory[5])
    remembered[:n] += jump
    now.recall(*memory[:5], remembered, *memory[6:])
