"""How much the norm of rho over-estimates the largest Euclidean norm of the perturbation w.

    python benchmarks/rho.py [STATES]

Each rho_i is the largest |w_i| that some parameters make, but rarely the same parameters for all
joints, so that the norm of rho is at least the largest norm of w over the box of parameters. That
one is hard to have exactly; here it is searched for at states of the paper's motion (13), so that
what is printed is at least the true over-estimate.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any

import numpy as np

import modrobust as mr
from modrobust import _kernel
from modrobust.motion import make_trajectory

STARTS = 30


def paper_robot() -> mr.Robot:
    """The paper's arm with the bounds of Table II: one body uncertain."""
    return mr.load_robot("lwa4p-paper")


def uncertain_robot(share: float = 0.05) -> mr.Robot:
    """The paper's arm with every body uncertain: masses, centres and tensor entries by a share."""
    robot = paper_robot()
    point = robot.nominal

    def moved(sign: float) -> mr.Parameters:
        entries = {name: getattr(point, name) for name in ("mass", "com", "inertia")}
        return replace(point, **{name: x + sign * share * np.abs(x) for name, x in entries.items()})

    return replace(robot, lower=moved(-1.0), upper=moved(1.0))


State = tuple[Any, Any, Any, Any]


def states(count: int) -> list[State]:
    """(q, dq, dq_a, ddq_a) evenly spaced along the desired motion of 10 s, without error."""
    trajectory = make_trajectory(paper_robot())
    q, dq, ddq = trajectory.sample(10.0 * (np.arange(count) + 0.5) / count)
    return [(q[k], dq[k], dq[k], ddq[k]) for k in range(count)]


def rho_norm(robot: mr.Robot, state: State) -> float:
    """Norm of rho, (8), by the hull."""
    lo, hi = mr.perturbation_bounds(robot, *state)
    return float(np.linalg.norm(np.maximum(np.abs(lo), np.abs(hi))))


def found_norm(robot: mr.Robot, state: State, seed: int = 0) -> float:
    """Largest norm of w that ascent over the vertices of the box finds from random ones.

    w is linear in each mass and tensor entry, so that its norm is convex there and largest at an
    end; for a centre of mass the middle is tried too.
    """
    rng = np.random.default_rng(seed)
    lower, upper = robot.lower.packed, robot.upper.packed
    free = np.flatnonzero(lower < upper)
    ends = [lower, upper, (lower + upper) / 2]
    b = robot.b
    nominal = _kernel.inverse_dynamics(robot.model, robot.nominal.packed, *state, True)

    def norm(point: Any) -> float:
        w = _kernel.inverse_dynamics(robot.model, point, *state, True) - nominal
        return float(w @ w)

    best = 0.0
    for _ in range(STARTS):
        point = np.where(rng.random(lower.shape) < 0.5, lower, upper)
        height, before = norm(point), -1.0
        while height > before:
            before = height
            for i in rng.permutation(free):
                old = point[i]
                for end in ends[: 3 if b <= i < 4 * b else 2]:
                    point[i] = end[i]
                    if (value := norm(point)) > height:
                        height, old = value, end[i]
                point[i] = old
        best = max(best, height)
    return float(np.sqrt(best))


def over_estimates(robot: mr.Robot, count: int) -> Any:
    """Norm of rho over the largest norm of w found, at each of so many states."""
    return np.array([rho_norm(robot, s) / found_norm(robot, s) for s in states(count)])


if __name__ == "__main__":
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    for label, robot in (("Table II", paper_robot()), ("every body 5 %", uncertain_robot())):
        ratio = over_estimates(robot, number)
        print(
            f"{label}, {number} states: norm of rho over the largest norm of w found: "
            f"mean {ratio.mean():.4f}, median {np.median(ratio):.4f}, "
            f"least {ratio.min():.4f}, largest {ratio.max():.4f}"
        )
