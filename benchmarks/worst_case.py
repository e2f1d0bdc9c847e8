"""The slowest command that states and boxes can bring about, against the typical one.

    python benchmarks/worst_case.py [ROBOT]

A real-time step must not take longer because of its data. The range of a quadratic over a box of
COMs is cheap where it is monotonic, so boxes are made far wider than any lever, and velocities
large, so that the quadratic outweighs its slope. A state's time is its least over 30 calls in C, so
that what interrupts the machine does not count. Typical: the median state at 5 mm and 1 rad/s.
"""

import sys

import numpy as np
from common import machine

import modrobust as mr
from modrobust.peers.cases import COM, random_states, uncertain_everywhere
from modrobust.peers.native import Subject, measure

BOXES = (COM, 0.05, 0.5, 5.0, 50.0)  # half-width of every COM [m]
SPEEDS = (0.0, 0.1, 1.0, 10.0, 100.0)  # [rad/s]
STATES = 300


def main() -> None:
    """Measure and print a table of the slowest state's time over the typical one."""
    print(machine())
    robot = mr.load_robot(sys.argv[1] if len(sys.argv) > 1 else "lwa4p-paper")
    boxes = [uncertain_everywhere(robot, com) for com in BOXES]
    for method in ("hull", "ianea"):
        subjects = [Subject(f"{com:g}", "command", k, method) for k, com in enumerate(BOXES)]
        least = []
        for speed in SPEEDS:
            states = random_states(robot, STATES, speed=speed)
            answer = measure(boxes, states, subjects, rounds=1, singles=30)
            least.append([np.min(item.alone, axis=0) for item in answer.timings])
        typical = float(np.median(least[SPEEDS.index(1.0)][0]))
        print(f"\n{method}: typical {typical * 1e6:.3g} us; slowest state over typical")
        print(f"{'[rad/s]':>10}" + "".join(f"{f'{com:g} m':>10}" for com in BOXES))
        for speed, row in zip(SPEEDS, least, strict=True):
            print(f"{speed:10g}" + "".join(f"{x.max() / typical:10.2f}" for x in row))
        worst = max(x.max() for row in least for x in row)
        print(f"largest: {worst / typical:.2f} ({worst * 1e6:.3g} us)")


if __name__ == "__main__":
    main()
