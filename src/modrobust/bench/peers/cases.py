"""What is measured: random states, and a robot of which every body is uncertain."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from modrobust.checks.types import Array
from modrobust.model import Parameters, Robot

MASS = 0.05  # of the nominal mass
COM = 5e-3  # [m], in every direction
INERTIA = 0.10  # of the largest principal moment, on every entry
BESIDE = 0.02  # [rad] or [m], how far the desired position may lie from the measured one


@dataclass(frozen=True, eq=False)
class States:
    """Inputs of a command, ``(k, n)`` each: [rad], [rad/s], [rad/s^2], [m] for prismatic joints."""

    q: Array
    dq: Array
    q_des: Array
    dq_des: Array
    ddq_des: Array


def random_states(robot: Robot, count: int, seed: int = 0, speed: float = 1.0) -> States:
    """Positions over a whole turn (+-0.5 m), velocities and accelerations within +-``speed``."""
    rng = np.random.default_rng(seed)
    shape = (count, robot.n)
    turns = robot.free_turns
    q = rng.uniform(-1.0, 1.0, shape) * np.where(turns, np.pi, 0.5)  # [rad], [m]
    dq, dq_des, ddq_des = (rng.uniform(-speed, speed, shape) for _ in range(3))
    return States(q, dq, q + rng.uniform(-BESIDE, BESIDE, shape), dq_des, ddq_des)


def uncertain_everywhere(robot: Robot, com: float = COM) -> Robot:
    """The robot with 5 % on every mass, 5 mm on every COM and 10 % on every inertia.

    Args:
        robot: Its nominal parameters are the centre; its drives keep their own bounds.
        com: Half-width of every entry of every COM [m].
    """
    p = robot.nominal
    moment = np.linalg.eigvalsh(p.inertia)[:, -1] if robot.b else np.zeros(0)

    def end(sign: float, own: Parameters) -> Parameters:
        return replace(
            own,
            mass=p.mass * (1.0 + sign * MASS),
            com=p.com + sign * com,
            inertia=p.inertia + sign * INERTIA * moment[:, None, None],
        )

    return replace(robot, lower=end(-1.0, robot.lower), upper=end(1.0, robot.upper))
