"""How the time of a command grows with the joints of synthetic chains.

    python benchmarks/growth.py

`ianea` with every body uncertain, sought: a fitted exponent of at most 1.1 up to 256 joints. `hull`
with one uncertain body at the tip, less the same chain with none: linear in the joints, so at most
1.1 too; `hull` with every body uncertain: the square.
"""

from collections.abc import Iterator
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


def measured() -> dict[str, Growth]:
    """The three columns, over all sizes."""
    columns = {name: Growth(name) for name in ("ianea, all", "hull, all", "hull, one body")}
    for n in SIZES:
        found = (
            chain_times(n, "ianea", 3),
            chain_times(n, "hull", 3),
            max(seconds(n, 1) - seconds(n, 0), 1e-12),  # [s]; a logarithm is taken of it
        )
        for growth, time in zip(columns.values(), found, strict=True):
            growth.joints.append(n)
            growth.seconds.append(time)
    return columns


def rows(columns: dict[str, Growth]) -> Iterator[list[str]]:
    """Microseconds a command, then the fitted exponents."""
    for k, n in enumerate(SIZES):
        yield [str(n), *(f"{growth.seconds[k] * 1e6:.3g}" for growth in columns.values())]
    yield ["exponent", *(f"{growth.exponent or 0.0:.3f}" for growth in columns.values())]


def main() -> None:
    """Measure and print."""
    print(machine())
    columns = measured()
    for row in (["joints", *(f"{name} [us]" for name in columns)], *rows(columns)):
        print("".join(f"{cell:>20}" for cell in row))


if __name__ == "__main__":
    main()
