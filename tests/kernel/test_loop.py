"""The closed loop in C equals the same loop written out in NumPy with the oracle's torques."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Robot
from modrobust.reference import box, mass_matrix, newton_euler
from support.loops import make_loop
from support.random_robots import random_robot

GAINS: dict[str, Any] = {
    "kappa_P": 2.0,
    "kappa_I": 100.0,
    "phi_P": 1.0,
    "phi_I": 200.0,
    "epsilon": 0.0937,
}
TICKS, DT, SUBSTEPS = 40, 3e-4, 2


def reference_motion(n: int) -> tuple[Any, Any, Any]:
    """A sine on each joint, sampled at the ticks."""
    t = np.arange(TICKS)[:, None] * DT
    rate = 3.0 + np.arange(n)
    return np.sin(rate * t), rate * np.cos(rate * t), -(rate**2) * np.sin(rate * t)


def cut(motion: tuple[Any, Any, Any], start: int, end: int) -> tuple[Any, Any, Any]:
    """A part of the motion, as the kernel takes it."""
    q, dq, ddq = (np.ascontiguousarray(x[start:end]) for x in motion)
    return q, dq, ddq


def plant(robot: Robot, point: Any, q: Any, dq: Any, tau: Any) -> Any:
    zero = np.zeros(robot.n)
    bias = newton_euler(robot, point, q, dq, dq, zero, drives=True)
    rotor = np.diag(robot.gear_ratio**2 * point.rotor_inertia)
    return np.linalg.solve(mass_matrix(robot, point, q) + rotor, tau - bias)


def written_out(robot: Robot, point: Any, d: Any, q: Any, dq: Any, K_r: Any) -> dict[str, Any]:
    """Section V in NumPy: (3), (4), (7), (8), (12) with IANEA*, and RK4 of the plant (23)."""
    rows: dict[str, list[Any]] = {k: [] for k in ("q", "dq", "tau", "w", "phi_lo", "phi_hi")}
    errors, norms, integral, previous = [], [], 0.0, 0.0
    for q_des, dq_des, ddq_des in zip(*reference_motion(robot.n), strict=True):
        error = float(np.linalg.norm(q_des - q))
        dq_a = dq_des + K_r * (q_des - q)
        ddq_a = ddq_des + K_r * (dq_des - dq)
        state = (q, dq, dq_a, ddq_a)
        u0 = newton_euler(robot, robot.nominal, *state, drives=True)
        bounds = newton_euler(robot, box(robot), *state, drives=True)
        phi_lo = bounds.lo - u0 - robot.disturbance.hi
        phi_hi = bounds.hi - u0 - robot.disturbance.lo
        rho = float(np.linalg.norm(np.maximum(np.abs(phi_lo), np.abs(phi_hi))))
        integral += previous * DT
        previous = 0.0 if error < GAINS["epsilon"] else error
        kappa = GAINS["kappa_P"] + GAINS["kappa_I"] * integral
        phi = GAINS["phi_P"] + GAINS["phi_I"] * integral
        tau = u0 + (kappa * rho + phi) * (dq_a - dq)
        w = newton_euler(robot, point, *state, drives=True) - u0 - d
        for name, value in zip(rows, (q, dq, tau, w, phi_lo, phi_hi), strict=True):
            rows[name].append(value)
        errors.append(error)
        norms.append(rho)
        h = DT / SUBSTEPS
        for _ in range(SUBSTEPS):
            x = np.array([q, dq])

            def rate(x: Any, tau: Any = tau) -> Any:
                return np.array([x[1], plant(robot, point, x[0], x[1], tau + d)])

            a = rate(x)
            b = rate(x + h / 2 * a)
            c = rate(x + h / 2 * b)
            q, dq = x + h / 6 * (a + 2 * b + 2 * c + rate(x + h * c))
    out = {name: np.array(values) for name, values in rows.items()}
    return {**out, "errors": np.array(errors), "norms": np.array(norms)}


@pytest.mark.parametrize("types", ["rr", "rp"])
def test_the_loop_in_c_equals_the_loop_written_out(types: str) -> None:
    rng = np.random.default_rng(1)
    robot = random_robot(rng, types=types, simple=True)
    n = robot.n
    K_r = np.array([10.0, 6.0])
    controller = mr.RobustController(robot, law="norm", bound="ianea", K_r=K_r, **GAINS)
    point = robot.sample_parameters(rng)
    d = rng.uniform(robot.disturbance.lo, robot.disturbance.hi)
    q, dq = np.array([0.08, -0.05]), np.array([3.0, 4.1])
    loop = make_loop(controller, point, d, q, dq, dt=DT, substeps=SUBSTEPS)
    chunks = [0, 15, TICKS]  # the chunks must not show
    motion = reference_motion(n)
    logs = [loop.advance(*cut(motion, a, b), 1) for a, b in itertools.pairwise(chunks)]
    expected = written_out(robot, point, d, q, dq, K_r)
    for name in ("q", "dq", "tau", "w", "phi_lo", "phi_hi"):
        ours = np.concatenate([log[name] for log in logs])
        scale = np.abs(expected[name]).max()
        np.testing.assert_allclose(ours, expected[name], rtol=0, atol=1e-9 * scale, err_msg=name)

    outside = np.flatnonzero(expected["errors"] >= GAINS["epsilon"])
    assert 0 < len(outside) < TICKS  # it starts outside and enters
    assert loop.ticks == TICKS
    assert loop.violations == 0
    assert loop.last_outside == pytest.approx(outside[-1] * DT)
    assert loop.error_max_after == pytest.approx(expected["errors"][outside[-1] + 1 :].max())
    assert loop.error_last == pytest.approx(expected["errors"][-1])
    assert loop.rho_sum == pytest.approx(expected["norms"].sum())
    assert loop.rho_max == pytest.approx(expected["norms"].max())
    np.testing.assert_allclose(loop.tau_max, np.abs(expected["tau"]).max(axis=0), rtol=1e-9)
    varied = np.abs(np.diff(expected["tau"], axis=0)).sum(axis=0)
    last = np.concatenate([log["total_variation"] for log in logs])[-1]
    np.testing.assert_allclose(last, varied, rtol=1e-7)


@pytest.mark.parametrize("side", [-1, 1])
def test_every_tick_with_the_perturbation_outside_its_set_is_counted(side: int) -> None:
    rng = np.random.default_rng(2)
    robot = random_robot(rng, types="rr")
    controller = mr.RobustController(robot, law="norm", bound="hull", K_r=10.0, **GAINS)
    d = np.full(2, side * 200.0)  # [N m], far outside [d]
    q = np.zeros(2)
    loop = make_loop(controller, robot.nominal, d, q, q, dt=DT, substeps=SUBSTEPS)
    motion = reference_motion(2)
    log = loop.advance(*cut(motion, 0, 20), 1)
    outside = np.maximum(log["phi_lo"] - log["w"], log["w"] - log["phi_hi"]).max(axis=1)
    assert loop.violations == np.count_nonzero(outside > 0) > 0
    assert loop.violation_max == pytest.approx(outside.max())
