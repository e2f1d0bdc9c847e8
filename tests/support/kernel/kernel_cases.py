"""Robots and states on which two builds of the kernel are compared, and everything they compute."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

import modrobust as mr
from modrobust import _kernel
from modrobust.model import LoopSettings, Robot
from support.kernel.native import BOUNDS, GAINS, LOGGED, TOTALS, Native
from support.loops import make_loop
from support.random_robots import random_robot, random_state, tied

State = tuple[Any, Any, Any, Any]
WIDTHS = ("exact", "narrow", "wide", "mixed")
CEILINGS = {"kappa_max": 2.05, "phi_max": 1.1, "leak": 3.0}
LAWS: dict[str, dict[str, Any]] = {
    **{f"norm {name}": {"law": "norm", "bound": name, **GAINS} for name in BOUNDS},
    "componentwise": {"law": "componentwise", **GAINS, **CEILINGS},
    "hold-aware": {"law": "norm", "bound": "ianea", "hold_aware": True, "delay": 1.0, **GAINS},
    "sampled": {"law": "sampled", "G": 40.0, "blend": 0.05},
    "sampled late": {"law": "sampled", "bound": "ianea", "G": 40.0, "delay": 1.0, "blend": 0.0},
}
LOOPS = {  # law, steps a tick, implicit
    "norm hull": ("norm hull", 1, False),
    "norm ianea": ("norm ianea", 1, False),
    "as a drive runs it": ("sampled late", 3, True),
}


def robots(seed: int, count: int) -> Iterator[Robot]:
    """Chains and trees of 1 to 9 joints, every second one with mimic joints, boxes of every kind.

    Every third one has joints that wrap, unless their mimic joints do not.
    """
    rng = np.random.default_rng(seed)
    for k in range(count):
        robot = random_robot(
            rng,
            int(rng.integers(1, 10)),
            tree=k % 2 == 1,
            simple=k % 5 == 0,
            width=WIDTHS[k % len(WIDTHS)],  # type: ignore[arg-type]
            drives=k % 3 != 0,
        )
        if k % 3 == 1:
            endless = {"revolute": "continuous", "prismatic": "prismatic"}
            robot = replace(
                robot,
                joint_types=tuple(endless[kind] for kind in robot.joint_types),
                effort_limits=np.full(robot.n, 20.0),  # [N m] or [N]
            )
        if k % 2 and robot.n > 1:
            robot = tied(robot, int(rng.integers(1, robot.n)), rng, anywhere=k % 4 == 3)
        yield robot


def states(rng: np.random.Generator, n: int) -> list[State]:
    """An ordinary state, one that is huge, one of subnormals and zeros, one that overflows."""
    q, dq, dq_a, ddq_a = random_state(rng, n)
    tiny = rng.integers(-3, 4, (4, n)) * 5e-324
    return [
        (q, dq, dq_a, ddq_a),
        (rng.uniform(-1e5, 1e5, n), dq * 1e60, dq_a * 1e60, ddq_a * 1e120),
        (tiny[0], tiny[1], tiny[2], tiny[3] * 1e10),
        (q, dq * 1e160, dq_a * 1e160, ddq_a),
    ]


def ticks(state: State) -> list[tuple[float, tuple[Any, ...]]]:
    """Three commands: times and signals q, dq, q_des, dq_des, ddq_des, made without arithmetic."""
    q, dq, dq_a, ddq_a = state
    times = (0.0, 2**-10, 2**-8)
    return [(t, (q, np.roll(dq, k), np.roll(q, 1), dq_a, ddq_a)) for k, t in enumerate(times)]


@cache  # the points that the laws compute with take their time
def controller_of(robot: Robot, law: str) -> mr.RobustController:
    """The controller of `LAWS`, for a loop with everything that a drive does to it if late."""
    if law != "sampled late":
        return mr.RobustController(robot, **LAWS[law])
    loop = LoopSettings(
        noise_position=(1e-4,) * robot.n,
        noise_velocity=(1e-2,) * robot.n,
        quantisation_position=(1e-5,) * robot.n,
        saturation=True,
        disturbance="worst",
    )
    return mr.RobustController(robot, loop=loop, **LAWS[law])


def loop_motion(state: State) -> list[Any]:
    """Four ticks of one desired state: q_des, dq_des, ddq_des."""
    q, dq, _, _ = state
    return [np.tile(x, (4, 1)) for x in (q, dq, np.zeros(len(q)))]


def in_one(status: int, loop: dict[str, Any]) -> Any:
    """Logs and totals of a loop as one array, its status first."""
    names = (*LOGGED, *TOTALS, "q after", "dq after", "ticks_at_limit")
    return np.concatenate([[status], *(np.ravel(loop[name]) for name in names)])


def outcome(call: Callable[..., Any], *arguments: Any) -> Any:
    """(0, result) or (status, None) of a call of the extension."""
    try:
        return 0, call(*arguments)
    except _kernel.KernelError as problem:
        return problem.args[0], None


def by_extension(robot: Robot, state: State, run: Callable[..., Any] = outcome) -> dict[str, Any]:
    """(status, result) of what the installed extension computes; `run` makes each call."""
    q, dq, _, tau = state
    box = robot.nominal.packed, robot.lower.packed, robot.upper.packed
    d = np.stack([robot.disturbance.lo, robot.disturbance.hi])
    at = (robot.model, robot.nominal.packed)
    out = {}
    for drives in (False, True):
        out[f"NE {drives}"] = run(_kernel.inverse_dynamics, *at, *state, drives)
        out[f"M {drives}"] = run(_kernel.mass_matrix, *at, q, drives)
        out[f"error {drives}"] = run(_kernel.inverse_dynamics_rounding, *at, *state, drives)
        out[f"slack {drives}"] = run(_kernel.bounds_slack, robot.model, *box, *state, drives)
        out[f"ddq {drives}"] = run(_kernel.forward_dynamics, *at, q, dq, tau, drives)
    for name, code in BOUNDS.items():
        bounds = _kernel.inverse_dynamics_bounds
        out[f"{name} bare"] = run(bounds, robot.model, *box, *state, code, False)
        out[f"{name} all"] = run(bounds, robot.model, *box, *state, code, True)
        many = [np.array([np.roll(x, k) for k in range(11)]) for x in state]
        batch = _kernel.inverse_dynamics_bounds_batch
        out[f"{name} batch"] = run(batch, robot.model, *box, *many, code, True, 2)
        out[f"{name} phi"] = run(_kernel.perturbation_bounds, robot.model, *box, d, *state, code)
    for law in LAWS:
        _, controller = run(lambda law=law: controller_of(robot, law).kernel)
        controller.reset()
        for k, (t, signals) in enumerate(ticks(state)):
            out[f"{law} u{k}"] = run(controller.command, t, *signals)
    for name, (law, substeps, implicit) in LOOPS.items():
        made = controller_of(robot, law)
        loop = make_loop(made, robot.nominal, q=q, dq=dq, substeps=substeps, implicit=implicit)
        _, log = run(loop.advance, *loop_motion(state), 1)
        totals = {total: getattr(loop, total) for total in (*TOTALS, "ticks_at_limit")}
        after = {"q after": loop.q, "dq after": loop.dq}
        out[f"loop {name}"] = 0, in_one(loop.status, {**log, **totals, **after})
    status, T = run(_kernel.forward_kinematics, robot.model, q)
    rows = None if T is None else np.concatenate([T[:, :3, :3].reshape(-1, 9), T[:, :3, 3]], axis=1)
    out["frames"] = status, rows
    return out


def by_native(native: Native, state: State) -> dict[str, Any]:
    """The same of a compiled kernel."""
    q, dq, _, tau = state
    out = {}
    for drives in (False, True):
        out[f"NE {drives}"] = native.inverse_dynamics(state, drives)
        out[f"M {drives}"] = native.mass_matrix(q, drives)
        out[f"error {drives}"] = native.rounding(state, drives)
        out[f"slack {drives}"] = native.slack(state, drives)
        out[f"ddq {drives}"] = native.forward_dynamics(q, dq, tau, drives)
    for name in BOUNDS:
        out[f"{name} bare"] = native.bounds(name, state, False)
        out[f"{name} all"] = native.bounds(name, state, True)
        many = [[np.roll(x, k) for x in state] for k in range(11)]
        out[f"{name} batch"] = native.batch(name, many, True)
        status, rows = native.perturbation(name, state)
        out[f"{name} phi"] = status, rows[1:]
    for law in LAWS:
        commands = native.commands(controller_of(native.robot, law), ticks(state))
        out |= {f"{law} u{k}": answer for k, answer in enumerate(commands)}
    for name, (law, *how) in LOOPS.items():
        made = controller_of(native.robot, law)
        loop: Any = native.loop
        status, found = loop(made, (q, dq), loop_motion(state), *how)
        out[f"loop {name}"] = 0, in_one(status, found)
    out["frames"] = native.forward_kinematics(q)
    return out


def differences(expected: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """Names of the results that are not the same, bit for bit, or not left alone on an error."""
    wrong = [name for name in expected if found[name][0] != expected[name][0]]
    for name, (status, values) in expected.items():
        if status == 0:
            same = np.ravel(values).tobytes() == np.ravel(found[name][1]).tobytes()
        elif "batch" in name:  # rows before the first bad one may be written
            continue
        else:
            left = found[name][1]
            same = left is None or bool(np.isnan(left).all())
        if not same and name not in wrong:
            wrong.append(name)
    return wrong
