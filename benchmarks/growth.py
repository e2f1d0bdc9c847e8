"""How the time of a command grows with the joints of synthetic chains.

    python benchmarks/growth.py

`ianea` with every body uncertain, sought: a fitted exponent of at most 1.1 up to 256 joints. `hull`
with one uncertain body at the tip, less the same chain with none: linear in the joints, so at most
1.1 too; `hull` with every body uncertain: the square.
"""

from dataclasses import replace

import numpy as np
from common import machine

from modrobust.benchmark import SIZES, Growth, chain_times
from modrobust.control import RobustController
from modrobust.parameters import Parameters
from modrobust.peers.cases import random_states
from modrobust.robot import Robot
from modrobust.synthetic import synthetic_chain

COMMANDS = 200
ROUNDS = 15


def uncertain_at_the_tip(n: int, bodies: int) -> Robot:
    """A chain of which the last bodies are uncertain, the others exact."""
    robot = synthetic_chain(n)
    mask = np.arange(n) >= n - bodies

    def end(own: Parameters) -> Parameters:
        p = robot.nominal
        return replace(
            own,
            mass=np.where(mask, own.mass, p.mass),
            com=np.where(mask[:, None], own.com, p.com),
            inertia=np.where(mask[:, None, None], own.inertia, p.inertia),
        )

    return replace(robot, lower=end(robot.lower), upper=end(robot.upper))


def seconds(n: int, bodies: int) -> float:
    """Least time over rounds of the median command [s], `hull`."""
    controller = RobustController(uncertain_at_the_tip(n, bodies), bound="hull")
    s = random_states(controller.robot, COMMANDS, seed=n, speed=0.1)
    t = np.arange(COMMANDS) * 1e-3
    inputs = (t, s.q, s.dq, s.q_des, s.dq_des, s.ddq_des)
    return min(float(np.median(controller.time_commands(*inputs))) for _ in range(ROUNDS))


def main() -> None:
    """Measure and print."""
    print(machine())
    columns = {
        "ianea, all": Growth("ianea"),
        "hull, all": Growth("hull"),
        "hull, one body": Growth("hull"),
    }
    print(f"{'joints':>8}" + "".join(f"{name:>20}" for name in columns))
    for n in SIZES:
        found = (
            chain_times(n, "ianea", 3),
            chain_times(n, "hull", 3),
            max(seconds(n, 1) - seconds(n, 0), 0.0),
        )
        for growth, time in zip(columns.values(), found, strict=True):
            growth.joints.append(n)
            growth.seconds.append(max(time, 1e-12))
        print(f"{n:8}" + "".join(f"{time * 1e6:17.2f} us" for time in found))
    exponents = "".join(f"{growth.exponent or 0.0:20.3f}" for growth in columns.values())
    print(f"{'exponent':>8}{exponents}")


if __name__ == "__main__":
    main()
