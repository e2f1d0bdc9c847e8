"""Robots, boxes and states over which the hull's width is compared with the true range.

Run as a program it prints what the tests assert, over as many robots as asked:
``python tests/support/tightness_population.py 1000``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

import modrobust as mr
from modrobust.model import Parameters, Robot
from support.exact_range import exact_range
from support.random_robots import random_robot, random_state, symmetric
from support.states import State

THRESHOLD = 1e-9  # of the largest torque: narrower true widths are not judged


@dataclass(frozen=True, eq=False)
class Case:
    """One robot, box and state: the hull, the true range, and where it comes from."""

    robot: Robot
    state: State
    drives: bool
    label: str
    rate: float = 0.0

    def judged(self) -> tuple[Any, Any, Any]:
        """Per joint, three figures of the hull.

        Width of the hull over the true one, true width over the largest torque, and the larger
        overlap by which the hull falls short of the true range (0 if it holds).
        """
        lo, hi = mr.inverse_dynamics_bounds(self.robot, *self.state, drives=self.drives)
        true_lo, true_hi = exact_range(self.robot, self.state, self.drives)
        size = max(np.abs(true_lo).max(), np.abs(true_hi).max())
        width = true_hi - true_lo
        short = np.maximum(0, np.maximum(lo - true_lo, true_hi - hi)) / size
        with np.errstate(divide="ignore", invalid="ignore"):
            return (hi - lo) / width, width / size, short


def boxed(robot: Robot, uncertainty: float, rng: np.random.Generator, share: float = 1.0) -> Robot:
    """The robot with that relative uncertainty on a share of its parameters, nominal off-centre.

    A centre of mass is uncertain by its distance from the body's origin, an inertia by its largest
    entry, as tolerances on bodies read from a file are; or each entry by itself.
    """
    own = rng.random() < 0.5
    sides = {}
    for field in fields(Parameters):
        nominal = getattr(robot.nominal, field.name)
        scale = np.abs(nominal)
        if not own and nominal.ndim > 1:
            axes = tuple(range(1, nominal.ndim))
            scale = np.broadcast_to(scale.max(axis=axes, keepdims=True), nominal.shape)
        down, up = rng.uniform(0.3, 1.0, (2, *nominal.shape)) * uncertainty * scale
        if share < 1.0:
            down, up = np.where(rng.random(nominal.shape) < share, (down, up), 0.0)
        if field.name == "inertia":
            down, up = symmetric(down), symmetric(up)
        sides[field.name] = (nominal - down, nominal + up)
    return replace(
        robot,
        lower=Parameters(**{name: side[0] for name, side in sides.items()}),
        upper=Parameters(**{name: side[1] for name, side in sides.items()}),
    )


def cases(
    uncertainty: float, robots: int, seed: int, joints: int | None = None, share: float = 1.0
) -> Iterable[Case]:
    """Two states, at two speeds, of each of so many random robots of 1 to 12 joints."""
    for k in range(robots):
        rng = np.random.default_rng([seed, k])
        n = joints or 1 + k % 12
        simple, tree, drives = (bool(flag) for flag in rng.random(3) < (0.25, 0.25, 0.5))
        # a single joint along gravity asks for no torque at rest: nothing to judge by
        simple = simple and n > 1
        robot = random_robot(
            rng, n, simple=simple, tree=tree and not simple, width="exact", drives=drives
        )
        robot = boxed(robot, uncertainty, rng, share)
        for rate in (rng.choice([0.0, 0.1]), rng.choice([1.0, 10.0])):
            label = f"seed {seed}, robot {k}, n {n}, rate {rate}, {simple=}, {tree=}, {drives=}"
            yield Case(robot, random_state(rng, n, rate), drives, label, float(rate))


@dataclass
class Summary:
    """Ratios of the judged joints of many cases."""

    ratios: Any
    short: float
    worst: str


def summary(many: Iterable[Case], narrowest: float = THRESHOLD, widest: float = np.inf) -> Summary:
    """Ratios over all joints whose true width is within (narrowest, widest) of the largest."""
    kept, short, worst, top = [], 0.0, "", 0.0
    for case in many:
        ratio, relative, falls_short = case.judged()
        short = max(short, float(falls_short.max()))
        judged = (relative > narrowest) & (relative < widest)
        kept.append(ratio[judged].astype(float))
        if judged.any() and kept[-1].max() > top:
            top = kept[-1].max()
            joint = int(np.flatnonzero(judged)[kept[-1].argmax()])
            worst = f"{case.label}, joint {joint}, true width {relative[joint]:.3g} of the largest"
    return Summary(np.concatenate(kept), short, worst)


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for uncertainty, share in (
        *((u, share) for u in (0.5, 0.1, 0.05, 0.01) for share in (1.0, 0.05)),
        *((u, 1.0) for u in (1e-7, 1e-8, 1e-9)),
    ):
        for joints, robots in ((None, count), (30, max(1, count // 20))):
            found = summary(cases(uncertainty, robots, 1, joints, share))
            print(
                f"{uncertainty:g} on {share:.0%} of the parameters, {joints or '1 to 12'} joints, "
                f"{len(found.ratios)} ratios: mean 1 + {found.ratios.mean() - 1:.3g}, largest 1 + "
                f"{found.ratios.max() - 1:.3g}, least 1 + {found.ratios.min() - 1:.3g}, "
                f"short by {found.short:.3g}\n    largest at {found.worst}"
            )
