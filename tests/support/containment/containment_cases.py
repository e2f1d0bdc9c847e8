"""Containment cases by seed: a random robot, a few states, many parameter points.

A case is one robot, state and parameter point; of points that coincide one counts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from flint import ctx

from modrobust.model import Robot
from support.containment.ball_comparison import PRECISION, Change, Outcome, check_state
from support.containment.extreme_states import random_signals, some_turns_off
from support.containment.kinds import kinds_of_robot, kinds_of_state
from support.containment.parameter_boxes import endless, make_robot, skewed
from support.containment.written_robots import Written, random_written

STATES = 3  # a robot


class Case(NamedTuple):
    """The robot of a seed."""

    rng: np.random.Generator
    written: Written
    robot: Robot
    skew: bool  # rotations a little off: only the reading by doubles holds for it
    sparse: bool


def robot_of(seed: int) -> Case:
    """Of one to thirty joints, most with four to eight."""
    ctx.prec = PRECISION  # the nearest doubles are taken from balls
    rng = np.random.default_rng([4, seed])
    size = rng.random()
    n = int(rng.integers(1, 4) if size < 0.3 else rng.integers(4, 9))
    if size > 0.95:
        n = int(rng.integers(9, 31) if size > 0.99 else rng.integers(9, 15))
    mimic_joints = int(rng.integers(1, 3)) if rng.random() < 0.2 else 0
    sparse = bool(rng.random() < 0.25)
    written = random_written(rng, n, mimic_joints, sparse)
    robot = make_robot(rng, written, sparse)
    skew = rng.random() < 0.1
    robot = skewed(rng, robot) if skew else robot
    return Case(rng, written, endless(apart(seed), robot), skew, sparse)


def apart(seed: int) -> np.random.Generator:
    """What decides on turns, so that all else of a seed stays as it is without them."""
    return np.random.default_rng([5, seed])


def run_seed(seed: int, change: Change | None = None) -> Outcome:
    """All cases of one robot; `change` alters the kernel's answers, to see a check fail."""
    rng, written, robot, skew, sparse = robot_of(seed)
    outcome = Outcome()
    robots = kinds_of_robot(robot, written)
    for number in range(STATES):
        exact = not skew and rng.random() < 0.5
        kind, signals = random_signals(rng, robot, sparse)
        signals = some_turns_off(apart(STATES * seed + number), robot, signals)
        as_given = bool(rng.random() < 0.2)  # (4) in real arithmetic too
        label = f"seed {seed} state {number} ({kind}, {'written' if exact else 'doubles'})"
        model = written if exact else None
        found = check_state(robot, signals, rng, label, model, as_given, change)
        if not found.refused:
            reading = {"exact rotations" if exact else "doubles", "(4)" if as_given else "given"}
            names = robots | kinds_of_state(robot, signals) | {f"read as {x}" for x in reading}
            found.kinds |= dict.fromkeys(names, 1)
        outcome.add(found)
    return outcome
