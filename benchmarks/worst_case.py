"""The slowest command that states and boxes can bring about, against the typical one.

    python benchmarks/worst_case.py [ROBOT]

A real-time step must not take longer because of its data. The range of a quadratic over a box of
COMs is cheap where it is monotonic, so boxes are made far wider than any lever, and velocities
large, so that the quadratic outweighs its slope. A state's time is its least over 30 calls in C, so
that what interrupts the machine does not count. Typical: the median state at 5 mm and 1 rad/s.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from common import machine

import modrobust as mr
from modrobust.bench.peers.cases import COM, random_states, uncertain_everywhere
from modrobust.bench.peers.native import Subject, measure
from modrobust.checks.types import Array
from modrobust.model import Robot

BOXES = (COM, 0.05, 0.5, 5.0, 50.0)  # half-width of every COM [m]
SPEEDS = (0.0, 0.1, 1.0, 10.0, 100.0)  # [rad/s]
STATES = 300


@dataclass(frozen=True)
class Slowest:
    """Of one bound: the typical command's time [s], and the slowest over it by speed and box."""

    typical: float
    ratios: Array

    def rows(self) -> Iterator[list[str]]:
        """One row a speed."""
        for speed, row in zip(SPEEDS, self.ratios, strict=True):
            yield [f"{speed:g}", *(f"{x:.2f}" for x in row)]


HEAD = ["[rad/s]", *(f"{com:g} m" for com in BOXES)]


def measured(robot: Robot, bound: str) -> Slowest:
    """Times of the slowest state, for each speed and box."""
    boxes = [uncertain_everywhere(robot, com) for com in BOXES]
    subjects = [Subject(f"{com:g}", "command", k, bound) for k, com in enumerate(BOXES)]
    least = []
    for speed in SPEEDS:
        states = random_states(robot, STATES, speed=speed)
        answer = measure(boxes, states, subjects, rounds=1, singles=30)
        alone = [item.alone for item in answer.timings if item.alone is not None]
        least.append([calls.min(axis=0) for calls in alone])
    typical = float(np.median(least[SPEEDS.index(1.0)][0]))
    return Slowest(typical, np.max(least, axis=2) / typical)


def main() -> None:
    """Measure and print a table of the slowest state's time over the typical one."""
    print(machine())
    robot = mr.load_robot(sys.argv[1] if len(sys.argv) > 1 else "lwa4p-paper")
    for bound in ("hull", "ianea"):
        found = measured(robot, bound)
        print(f"\n{bound}: typical {found.typical * 1e6:.3g} us; slowest state over typical")
        for row in (HEAD, *found.rows()):
            print("".join(f"{cell:>10}" for cell in row))
        largest = found.ratios.max()
        print(f"largest: {largest:.2f} ({largest * found.typical * 1e6:.3g} us)")


if __name__ == "__main__":
    main()
