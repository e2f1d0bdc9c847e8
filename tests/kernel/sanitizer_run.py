"""Runs everything that the kernel computes on random robots; for test_sanitizers.py.

Argument: a shared library of the kernel, built with sanitizers that end the process on a finding.
"""

from __future__ import annotations

import ctypes
import sys

import numpy as np

from support.kernel.kernel_cases import by_native, robots, states
from support.kernel.native import Memory, Native, sincos


def main(path: str) -> None:
    library = ctypes.CDLL(path)
    rng = np.random.default_rng(4)
    computed = 0
    for robot in robots(5, 40):
        with Memory() as memory:
            native = Native(library, robot, memory)
            for state in states(rng, robot.n):
                computed += len(by_native(native, state))
    for x in rng.uniform(-1e5, 1e5, 1000):
        sincos(library, x)
    print(computed)


main(sys.argv[1])
