"""Comparisons in C and C++: a job for the measuring program, and what it answers."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from modrobust.bench.peers.cases import States, random_states, uncertain_everywhere
from modrobust.bench.peers.compile import Announce, CompilerError, program, toolchain
from modrobust.bench.peers.timing import Comparison, Timing
from modrobust.checks.types import Array
from modrobust.errors import ValueRangeError
from modrobust.kernel import BOUNDS
from modrobust.model import Robot

KINDS = ("peer", "sincos", "nominal", "bounds", "command", "batch")  # the order of program.c
PEER = "Pinocchio, rnea"
DISAGREEMENT = 1e-9
"""Largest difference of the two libraries' torques, over the largest torque."""


@dataclass(frozen=True)
class Subject:
    """What the program runs on every state."""

    name: str
    kind: str
    box: int = 0
    bound: str = "hull"


@dataclass(frozen=True)
class Answer:
    """What the program measured [s]; clock is the cost of reading it, (k,)."""

    timings: tuple[Timing, ...]
    disagreement: float | None
    clock: Array


def measure(
    boxes: Sequence[Robot],
    states: States,
    subjects: Sequence[Subject],
    *,
    flags: str = "native",
    rounds: int = 101,
    singles: int = 10,
    announce: Announce | None = None,
) -> Answer:
    """Run the program.

    Args:
        boxes: One robot with different bounds; nominal values are those of the first.
        states: What the subjects run on, k states.
        subjects: What is measured.
        flags: How the kernel is compiled, a key of `FLAGS`.
        rounds: How often every subject is run over all states, in turn.
        singles: How often each call is timed by itself; 0 for not at all.
        announce: Told when a compilation of minutes begins.

    Raises:
        MissingExtraError: A compiler or a header is missing.
        CompilerError: The program does not compile, or fails.
    """
    peer = any(subject.kind == "peer" for subject in subjects)
    path = program(toolchain(), flags, peer, announce)
    job = "\n".join(_job(boxes, states, subjects, (rounds, singles)))
    done = subprocess.run([path], input=job, capture_output=True, text=True, check=False)
    if done.returncode:
        said = done.stderr.strip() or f"status {done.returncode}"
        raise CompilerError(f"the measuring program failed: {said}")
    found: dict[tuple[str, int], Array] = {}
    for line in done.stdout.splitlines():
        name, which, *values = line.split()
        found[name, int(which)] = np.array([float.fromhex(value) for value in values])
    timings = []
    for k, subject in enumerate(subjects):
        alone = found.get(("singles", k), np.empty(0))
        shaped = alone.reshape(singles, -1) if alone.size else None
        timings.append(Timing(subject.name, found["rounds", k], shaped))
    differs = found.get(("disagreement", 0))
    return Answer(tuple(timings), None if differs is None else float(differs[0]), found["clock", 0])


def pinocchio_cpp(
    robot: Robot, flags: str = "native", states: int = 1000, announce: Announce | None = None
) -> Comparison:
    """Our whole command against one inverse dynamics of Pinocchio, in one process.

    Raises:
        MissingExtraError: A compiler, Pinocchio or Eigen is missing.
        ValueRangeError: The robot has mimic joints, which Pinocchio's algorithm
            does not know; or the two libraries do not agree.
    """
    require_comparable(robot)
    subjects = [
        Subject(PEER, "peer"),
        Subject("sine, cosine", "sincos"),
        Subject("NE*", "nominal"),
        Subject("own bounds, hull", "command"),
        Subject("own bounds, ianea", "command", 0, "ianea"),
        Subject("all bodies, hull", "command", 1),
        Subject("all bodies, ianea", "command", 1, "ianea"),
    ]
    boxes = [robot, uncertain_everywhere(robot)]
    inputs = random_states(robot, states)
    answer = measure(boxes, inputs, subjects, flags=flags, announce=announce)
    if answer.disagreement is None or not answer.disagreement <= DISAGREEMENT:
        raise ValueRangeError(
            f"{robot.name}: our torques and Pinocchio's differ by {answer.disagreement} of the "
            f"largest; {DISAGREEMENT:g} is allowed. Their times cannot be compared"
        )
    clock = float(np.median(answer.clock))
    return Comparison(
        f"one nominal pass against our whole commands, {flags} flags, {toolchain().version}",
        answer.timings,
        PEER,
        answer.disagreement,
        (f"calls timed by themselves include {clock * 1e9:.0f} ns of the clock",),
    )


def require_comparable(robot: Robot) -> None:
    """Refuse mimic joints: Pinocchio's algorithm leaves them free."""
    if robot.j != robot.n:
        raise ValueRangeError(
            f"{robot.name} has {robot.j - robot.n} mimic joints; other libraries take them as "
            "free, so that times cannot be compared. Lock them or choose a tip before them"
        )


def depth_first(robot: Robot) -> list[int]:
    """Joints in an order in which each subtree is contiguous, as Pinocchio wants them."""
    children: dict[int, list[int]] = {}
    for i, parent in enumerate(robot.parents.tolist()):
        children.setdefault(parent, []).append(i)
    order, waiting = [], children.get(-1, [])[::-1]
    while waiting:
        i = waiting.pop()
        order.append(i)
        waiting += children.get(i, [])[::-1]
    return order


def _job(
    boxes: Sequence[Robot], states: States, subjects: Sequence[Subject], counts: tuple[int, ...]
) -> Iterator[str]:
    """The job in the order in which program.c reads it."""
    robot, *_ = boxes
    f, c = robot.mimic, robot.controller
    yield _integers([robot.n, robot.j, robot.b])
    yield _integers([kind == "prismatic" for kind in robot.joint_types])
    yield _integers(robot.parents)
    yield from map(_transforms, (robot.before, robot.after))
    yield from map(_doubles, (robot.gear_ratio, robot.coulomb_speed))
    yield _integers(robot.moves)
    yield _integers(f.leaders)
    yield from map(_doubles, (f.multiplier, f.offset))
    yield _integers(robot.body_joints)
    yield _transforms(robot.placement)
    yield _integers(robot.framed)
    yield _doubles(robot.base[:3, :3].T @ robot.gravity)
    yield _integers(depth_first(robot))
    yield _integers([len(boxes)])
    for box in boxes:
        d = box.disturbance
        for array in (box.nominal.packed, box.lower.packed, box.upper.packed, d.lo, d.hi):
            yield _doubles(array)
    yield _doubles([*c.K_r, c.kappa_P, c.kappa_I, c.phi_P, c.phi_I, c.epsilon])
    yield _integers([len(states.q)])
    for array in (states.q, states.dq, states.q_des, states.dq_des, states.ddq_des):
        yield _doubles(array)
    yield _integers([len(subjects)])
    for subject in subjects:
        yield _integers([KINDS.index(subject.kind), subject.box, BOUNDS[subject.bound]])
    yield _integers(counts)


def _integers(values: ArrayLike) -> str:
    return " ".join(str(int(value)) for value in np.ravel(values))


def _doubles(values: ArrayLike) -> str:
    return " ".join(float(value).hex() for value in np.ravel(values))


def _transforms(T: Array) -> str:
    return _doubles([[*t[:3, :3].ravel(), *t[:3, 3]] for t in T])
