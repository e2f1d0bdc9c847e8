"""How the time of a command grows with the joints of synthetic chains.

    python benchmarks/growth.py

`ianea` with every body uncertain; target: a fitted exponent of at most 1.1 up to 256 joints. `hull`
with one uncertain body at the tip, less the same chain with none: linear in the joints, so at most
1.1 too; `hull` with every body uncertain: the square.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from common import machine

from modrobust.bench.benchmark import SIZES, Growth, chain_times
from modrobust.bench.peers.cases import random_states
from modrobust.control import RobustController
from modrobust.model import Parameters, Robot, synthetic_chain

COMMANDS = 200
ROUNDS = 25


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


def cost_of_one_body(n: int) -> float:
    """Time of a command, `hull`, with one uncertain body at the tip less that with none [s].

    The two are timed in turn, each state by its minimum time: the difference is small.
    """
    robots = [uncertain_at_the_tip(n, bodies) for bodies in (1, 0)]
    controllers = [RobustController(robot, bound="hull") for robot in robots]
    s = random_states(robots[0], COMMANDS, seed=n, speed=0.1)
    inputs = (np.arange(COMMANDS) * 1e-3, s.q, s.dq, s.q_des, s.dq_des, s.ddq_des)
    times = [[c.time_commands(*inputs) for c in controllers] for _ in range(ROUNDS)]
    one, none = np.median(np.min(times, axis=0), axis=1)
    return float(one - none)


def measured() -> dict[str, Growth]:
    """The three columns, over all sizes."""
    columns = {name: Growth(name) for name in ("ianea, all", "hull, all", "hull, one body")}
    for n in SIZES:
        found = (
            chain_times(n, "ianea", 3),
            chain_times(n, "hull", 3),
            cost_of_one_body(n),
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
