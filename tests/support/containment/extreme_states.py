"""States of every size: at rest, usual, fast, far, tiny, huge, mixed, with torques that cancel."""

from __future__ import annotations

from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

import modrobust as mr
from modrobust.model import Robot

SHARES = {
    "usual": 0.27,
    "rest": 0.08,
    "right angles": 0.1,
    "fast": 0.12,
    "far": 0.1,
    "tiny": 0.08,
    "huge": 0.05,
    "mixed": 0.05,
    "weightless": 0.1,
    "apart": 0.05,
}
TINY = (0.0, 5e-324, 1e-320, 2.3e-308, 1e-300, 1e-160, 1e-100, 1e-30, 1e-9)


class Signals(NamedTuple):
    """What the controller is given, each (n,)."""

    q: Any
    dq: Any
    q_des: Any
    dq_des: Any
    ddq_des: Any


def signed(rng: np.random.Generator, low: float, high: float, n: int) -> Any:
    """Numbers of either sign, their decimal logarithms uniform."""
    return rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(low, high, n)


def random_signals(
    rng: np.random.Generator, robot: Robot, sparse: bool = False
) -> tuple[str, Signals]:
    """The kind, and a state of it; sparse: most rates are 0, the others of any size."""
    n = robot.n
    kind = str(rng.choice(list(SHARES), p=list(SHARES.values())))
    slides = np.array([joint == "prismatic" for joint in robot.free_types])
    reach = np.where(slides, np.inf, 1e5)  # the kernel refuses angles beyond
    q = rng.uniform(-np.pi, np.pi, n)
    dq, dq_des, ddq_des = rng.normal(size=(3, n)) * 2.0
    if kind in ("rest", "right angles"):
        dq = dq_des = np.zeros(n)
        ddq_des = ddq_des * (rng.random(n) < 0.5) * (rng.random() < 0.5)
    if kind == "right angles":
        off = rng.choice([0.0, 0.0, 1e-16, 1e-12, 1e-8], n) * rng.choice([-1, 1], n)
        q = rng.integers(-40, 41, n) * (np.pi / 2) + off
    if kind == "fast":
        dq, dq_des, ddq_des = (signed(rng, 0, 6, n) for _ in range(3))
    if kind == "far":
        q = signed(rng, 0, 5, n)
    if kind == "tiny":
        q, dq, dq_des, ddq_des = (
            rng.choice(TINY, n) * rng.choice([-1.0, 1.0], n) for _ in range(4)
        )
    if kind == "huge":
        top = float(rng.choice([30.0, 60.0, 100.0]))
        dq, dq_des, ddq_des = (signed(rng, -3, top, n) for _ in range(3))
        far = signed(rng, 0, top, n)
        q = np.where(slides, far, q)
    if kind == "mixed":
        q, dq, dq_des, ddq_des = (signed(rng, -200, 4, n) for _ in range(4))
        for vector in (q, dq, dq_des, ddq_des):
            vector[rng.random(n) < 0.2] = 0.0
    if sparse and kind not in ("tiny", "apart"):
        kind = "sparse"
        dq, dq_des, ddq_des = (
            signed(rng, -12, 12, n) * (rng.random(n) < 0.6) * (rng.random() < 0.6) for _ in range(3)
        )
    if kind == "apart":  # products of rates underflow, or do not, by their order
        dq, dq_des, ddq_des = (signed(rng, -320, 60, n) for _ in range(3))
    if rng.random() < 0.1:  # one joint moves, the rest stand: near-singular quadratics
        keep = np.arange(n) == rng.integers(n)
        dq, dq_des, ddq_des = (x * keep for x in (dq, dq_des, ddq_des))
    q = np.clip(q, -reach, reach)
    q_des = q.copy()
    if rng.random() < (0.2 if sparse else 0.5):
        q_des = np.clip(q + rng.normal(size=n) * 10.0 ** rng.uniform(-9, 0), -reach, reach)
    if sparse and kind != "weightless" and rng.random() < 0.6:
        if rng.random() < 0.5:  # no feedback of velocity in ddq_a
            dq_des = dq
        else:  # the feedback is cancelled, ddq_a is 0 while dq_a is not dq
            ddq_des = -np.array(robot.controller.K_r) * (dq_des - dq)
    if kind == "weightless":  # the nominal torque cancels, down to its rounding
        q_des, dq_des = q, dq
        with suppress(mr.ModrobustError):  # random tensors need not be those of bodies
            ddq_des = mr.forward_dynamics(robot, q, dq, np.zeros(n))
    return kind, Signals(q, dq, q_des, dq_des, ddq_des)


def some_turns_off(rng: np.random.Generator, robot: Robot, signals: Signals) -> Signals:
    """The desired angles of joints that wrap by up to 15,000 turns off, to the nearest double."""
    turns = rng.choice([0, 0, 1, -1, 2, -17, int(rng.integers(-15000, 15001))], robot.n)
    q_des = np.where(robot.wraps, signals.q_des + 2.0 * np.pi * turns, signals.q_des)
    inside = np.where(robot.wraps, np.clip(q_des, -1e5, 1e5), q_des)
    return signals._replace(q_des=inside)


def auxiliary(robot: Robot, signals: Signals) -> tuple[Any, Any]:
    """dq_a and ddq_a of (4) in doubles, the operations of the kernel in its order."""
    K_r = np.array(robot.controller.K_r)
    return (
        signals.dq_des + K_r * robot.tracking_error(signals.q, signals.q_des),
        signals.ddq_des + K_r * (signals.dq_des - signals.dq),
    )
