"""Bounds of many states at once against one call after the other, every body uncertain.

    python benchmarks/batch.py [ROBOT ...]

In C: a loop of single calls against the batch, one thread, native flags. From Python: the
installed extension with one thread and with two; times are a state and core. Target: 0.25 us with
6 joints.
"""

from functools import partial

from common import main

import modrobust as mr
from modrobust.bench.peers.cases import random_states, uncertain_everywhere
from modrobust.bench.peers.native import Subject, measure
from modrobust.bench.peers.timing import Comparison, Timing, interleaved
from modrobust.model import Robot

STATES = 4_000
THREADS = (1, 2)


def in_c(robot: Robot) -> Comparison:
    """The batch of the kernel against a loop."""
    subjects = [
        Subject(f"{name}, {bound}", kind, 0, bound)
        for bound in ("hull", "ianea")
        for name, kind in (("loop", "bounds"), ("batch", "batch"))
    ]
    everywhere, states = uncertain_everywhere(robot), random_states(robot, 1000)
    answer = measure([everywhere], states, subjects, singles=0)
    return Comparison("in C, native flags, one thread", answer.timings, "loop, hull")


def from_python(robot: Robot) -> Comparison:
    """The batch of the installed extension; times are a state and core."""
    everywhere, s = uncertain_everywhere(robot), random_states(robot, STATES)
    inputs = (s.q, s.dq, s.dq_des, s.ddq_des)
    run = mr.inverse_dynamics_bounds_batch
    subjects = {
        f"{bound}, threads {threads}": partial(
            run, everywhere, *inputs, bound=bound, threads=threads
        )
        for bound in ("hull", "ianea")
        for threads in THREADS
    }
    timings = tuple(
        Timing(item.name, item.rounds * int(item.name.split()[-1]))
        for item in interleaved(subjects, STATES, 101)
    )
    return Comparison(f"from Python, {STATES} states, a state and core", timings, "hull, threads 1")


if __name__ == "__main__":
    main("batch", in_c)
    main("batch", from_python)
