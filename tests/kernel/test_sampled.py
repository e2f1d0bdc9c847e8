"""The laws for a held command equal the same laws written out in NumPy, tick by tick.

Torques, mass matrices and their bounds come from the functions that other tests hold against
references; what is written out here is (29) to (34): the law.
"""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.design.points import central_parameters, light_parameters
from modrobust.errors import ModrobustError, ValueRangeError
from modrobust.model import Robot
from support.loops import make_loop
from support.random_robots import random_robot, tied

RATE, TICKS = 500.0, 50  # [Hz]
T = 1.0 / RATE
G = 30.0  # [1/s]
OPTIONS: dict[str, Any] = {"law": "sampled", "G": G, "L_i": 400.0, "blend": 0.06}
PARTS = ("all", "integral", "predictor", "vector_saturation", "blend")  # what is left out


def robot_of(kind: str) -> Robot:
    """Tensors about the frame among them, and limits that cut some torques and not others."""
    rng = np.random.default_rng(sum(map(ord, kind)))
    if kind == "revolute":
        robot = random_robot(rng, types="rrrr", width="narrow")
    elif kind == "prismatic":
        robot = random_robot(rng, types="prp")
    elif kind == "mimic":
        robot = tied(random_robot(rng, types="rrprr", tree=True), 3, rng, anywhere=True)
    elif kind == "wraps":
        robot = random_robot(rng, types="rrr", drives=False)
        robot = replace(robot, joint_types=("continuous",) * 3)
    else:
        robot = random_robot(rng, types="rrp", width="mixed", drives=False)
    zero = np.zeros(robot.n)
    holding = np.abs(mr.inverse_dynamics(robot, zero, zero, zero, zero)) + 20.0
    return replace(robot, name=kind, effort_limits=1.5 * holding)


KINDS = ("revolute", "prismatic", "mimic", "wraps", "mixed")
ROBOTS = {kind: robot_of(kind) for kind in KINDS}


def signals(robot: Robot, seed: int) -> Iterator[tuple[float, tuple[Any, ...]]]:
    """Ticks of a motion, and a state that is far off at first and then near by, each at random."""
    rng = np.random.default_rng(seed)
    rate = rng.uniform(1.0, 3.0, robot.n)
    phase = rng.uniform(-3.0, 3.0, robot.n)
    for k in range(TICKS):
        t = k * T
        q_des, dq_des = np.sin(rate * t + phase), rate * np.cos(rate * t + phase)
        # large and small offsets, so that limits and [Phi] bind at some ticks and not at others
        size = 0.3 if k == 0 else 10.0 ** rng.uniform(-6.0, -1.5)
        q = q_des + size * rng.normal(size=robot.n)
        q = q + np.where(robot.wraps, 2.0 * np.pi * rng.integers(-3, 4, robot.n), 0.0)
        dq = dq_des + 10.0 * size * rng.normal(size=robot.n)
        yield t, (q, dq, q_des, dq_des, -(rate**2) * q_des)


def quintic(x: float, blend: float) -> Any:
    """Position, velocity and acceleration at x of two polynomials to rest at 0, rows; ``(3, 2)``.

    They go from 1, 0, 0 and from 0, 1, 0 in the time `blend`, by the six conditions at their ends.
    """
    if not x < blend:
        return np.zeros((3, 2))

    def rows(s: float) -> Any:
        powers = np.arange(6)
        d = powers * s ** np.maximum(powers - 1, 0)
        dd = powers * (powers - 1) * s ** np.maximum(powers - 2, 0)
        return np.array([s**powers, d, dd])

    # In units of `blend`, or the matrix would be badly conditioned.
    ends = np.concatenate([rows(0.0), rows(1.0)])
    a, b = np.linalg.solve(ends, np.eye(6)[:, :2]).T
    scale = blend ** -np.arange(3.0)
    now = rows(x / blend)
    return np.stack([scale * (now @ a), scale * blend * (now @ b)], axis=1)


@dataclass
class WrittenOut:
    """The law `sampled` for one robot: (30) to (34), with what it remembers."""

    robot: Robot
    delay: float
    blend: float = OPTIONS["blend"]
    bound: str = "hull"
    integral: bool = True
    predictor: bool = True
    vector_saturation: bool = True
    Lambda: float = G / 2.0
    L_i: float = OPTIONS["L_i"]
    sigma: Any = None
    past: Any = None
    start: Any = None
    primed: Any = field(default=None)

    def __post_init__(self) -> None:
        self.centre = central_parameters(self.robot)
        self.light = light_parameters(self.robot, self.centre)

    def command(
        self, t: float, q: Any, dq: Any, q_des: Any, dq_des: Any, ddq_des: Any
    ) -> dict[str, Any]:
        robot, n = self.robot, self.robot.n
        e = q_des - q
        e = np.where(robot.wraps, np.arctan2(np.sin(e), np.cos(e)), e)
        de = dq_des - dq
        first = self.start is None
        if first:
            self.sigma, self.past = np.zeros((2, n))
            self.start = (t, np.stack([-e, -de]))
        t0, offset = self.start
        way = quintic(t - t0, self.blend) @ offset  # the reference's detour
        e, de = e + way[0], de + way[1]
        if self.predictor and not first:
            late = self.delay * T
            e = e + late * de - late**2 / 2.0 * self.past
            de = de - late * self.past
        s = (self.delay + 0.5) * T
        way = quintic(t - t0 + s, self.blend) @ offset
        given = (q_des + s * dq_des + s**2 / 2.0 * ddq_des, dq_des + s * ddq_des, ddq_des)
        q1, dq1, ddq1 = (x + y for x, y in zip(given, way, strict=True))
        self.primed = (q1, dq1, dq1, ddq1)
        q1, dq1, dq1_a, ddq1 = self.primed
        nominal = mr.inverse_dynamics(robot, q1, dq1, dq1_a, ddq1, self.centre)
        lo, hi = mr.inverse_dynamics_bounds(robot, q1, dq1, dq1_a, ddq1, self.bound)
        phi = lo - nominal - robot.disturbance.hi, hi - nominal - robot.disturbance.lo
        M_s = mr.mass_matrix(robot, q1, self.light)
        r = de + self.Lambda * e
        feedback = M_s @ ((G + self.Lambda) * de + G * self.Lambda * e)
        alpha = 1.0
        if self.vector_saturation:  # the share of the feedback that no torque has to be cut for
            along = np.sign(feedback) * (nominal + self.sigma)
            room = np.maximum(robot.effort_limits - along, 0.0)
            some = feedback != 0.0
            share = (room[some] / np.abs(feedback[some])).min(initial=1.0)
            alpha = float(np.clip(share, 0.02, 1.0))
        if self.integral:
            if alpha == 1.0:
                self.sigma = self.sigma + T * self.L_i * M_s @ r
            self.sigma = np.clip(self.sigma, *phi)
        v = alpha * feedback + self.sigma
        tau = nominal + v
        if self.vector_saturation:
            tau = np.clip(tau, -robot.effort_limits, robot.effort_limits)
        self.past = alpha * np.linalg.solve(mr.mass_matrix(robot, q1, self.centre), feedback)
        return {
            "tau": tau,
            "nominal": nominal,
            "v": v,
            "phi_lo": phi[0],
            "phi_hi": phi[1],
            "rho": np.maximum(np.abs(phi[0]), np.abs(phi[1])),
            "alpha": alpha,
        }


def both(
    robot: Robot, delay: float, left_out: str = "all", bound: str = "hull"
) -> tuple[mr.RobustController, WrittenOut]:
    options: dict[str, Any] = {"bound": bound}
    if left_out == "blend":
        options["blend"] = 0.0
    elif left_out != "all":
        options[left_out] = False
    ours = mr.RobustController(robot, rate=RATE, delay=delay, **{**OPTIONS, **options})
    return ours, WrittenOut(robot, delay, **options)


@pytest.mark.parametrize("left_out", PARTS)
@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("kind", KINDS)
def test_the_command_equals_the_law_written_out(kind: str, delay: float, left_out: str) -> None:
    robot = ROBOTS[kind]
    bound = "ianea" if delay == 0.3 else "hull"
    ours, written = both(robot, delay, left_out, bound)
    seen: set[str] = set()
    for k, (t, given) in enumerate(signals(robot, seed=7)):
        command, expected = ours.command(t, *given), written.command(t, *given)
        for name, value in expected.items():
            size = np.abs(value).max()
            found = getattr(command, name)
            np.testing.assert_allclose(
                found, value, rtol=0, atol=1e-9 * size, err_msg=f"{name} at tick {k}"
            )
        seen |= {"cut"} if expected["alpha"] < 1.0 else {"whole"}
        sigma = written.sigma
        at_end = (sigma == expected["phi_lo"]) | (sigma == expected["phi_hi"])
        seen |= {"clipped"} if at_end.any() else {"free"}
    # Every branch of the law has been taken.
    assert "whole" in seen
    assert ("cut" in seen) == (left_out != "vector_saturation")
    assert "free" in seen
    assert "clipped" in seen or left_out in ("integral", "blend")


@pytest.mark.parametrize("kind", KINDS)
def test_the_way_from_the_start_begins_in_the_state_and_ends_on_the_motion(kind: str) -> None:
    """No feedback at the first command, however far off; after the blend the reference's own."""
    robot = ROBOTS[kind]
    ours, written = both(robot, 0.3)
    ticks = list(signals(robot, seed=3))
    first = ours.command(ticks[0][0], *ticks[0][1])
    np.testing.assert_array_equal(first.v, 0.0)
    for t, given in ticks:
        written.command(t, *given)
        *_, ddq_des = given
        if t + 0.8 * T >= OPTIONS["blend"]:
            np.testing.assert_array_equal(written.primed[3], ddq_des)
    assert t > OPTIONS["blend"]


@cache
def physical_points(kind: str) -> list[Any]:
    """200 of the box: drawn, and at its corners as far as they are physical."""
    robot, rng = ROBOTS[kind], np.random.default_rng(1)
    points = [robot.sample_parameters(rng) for _ in range(188)]
    points += [robot.physical_corner("corner", rng)[0] for _ in range(10)]
    return points + [robot.physical_corner(side)[0] for side in ("lower", "upper")]


@pytest.mark.parametrize("bound", ["hull", "ianea"])
@pytest.mark.parametrize("kind", KINDS)
def test_the_set_holds_every_perturbation_and_sigma_never_leaves_it(kind: str, bound: str) -> None:
    """W = NE(primed state; Delta) - d - nominal, for 200 physical points of the box."""
    robot = ROBOTS[kind]
    rng = np.random.default_rng(5)
    ours, written = both(robot, 1.0, bound=bound)
    points = physical_points(kind)
    d = robot.disturbance
    for k, (t, given) in enumerate(signals(robot, seed=11)):
        command = ours.command(t, *given)
        written.command(t, *given)
        sigma = ours.kernel.memory()[5][: robot.n]
        assert (command.phi_lo <= sigma).all()
        assert (sigma <= command.phi_hi).all()
        for point in points[k::10]:
            q1, dq1, dq1_a, ddq1 = written.primed
            tau = mr.inverse_dynamics(robot, q1, dq1, dq1_a, ddq1, point)
            ends = np.where(rng.integers(0, 2, robot.n) == 1, d.lo, d.hi)
            w = tau - ends - command.nominal
            rounding = 1e-13 * (np.abs(tau) + np.abs(command.nominal)).max()
            assert (command.phi_lo - rounding <= w).all()
            assert (w <= command.phi_hi + rounding).all()


def bits(command: Any) -> list[Any]:
    """Everything that a command says."""
    arrays = (np.asarray(value).tobytes() for value in vars(command).values())
    return [*arrays]


def remembered(controller: mr.RobustController) -> list[Any]:
    return [np.asarray(value).tobytes() for value in controller.kernel.memory()]


@pytest.mark.parametrize(
    "spoil",
    [
        lambda t, x: (np.nan, x),
        lambda t, x: (t - 2.5 * T, x),
        *(
            lambda t, x, at=at, value=value: (t, [*x[:at], x[at] + value, *x[at + 1 :]])
            for at in range(5)
            for value in (np.nan, 1e300)
            if (at, value) != (1, 1e300)  # a velocity with a finite torque, cut at the limits
        ),
    ],
)
def test_an_error_leaves_the_law_as_it_was(spoil: Callable[[float, Any], Any]) -> None:
    robot = ROBOTS["wraps"]
    (ours, _), (other, _) = both(robot, 1.0), both(robot, 1.0)
    for k, (t, given) in enumerate(signals(robot, seed=13)):
        if k % 7 == 3:
            before = remembered(ours)
            wrong_time, wrong = spoil(t, given)
            with pytest.raises(ModrobustError):
                ours.command(wrong_time, *wrong)
            assert remembered(ours) == before
        assert bits(ours.command(t, *given)) == bits(other.command(t, *given))


@pytest.mark.parametrize("kind", ["revolute", "wraps"])
def test_a_measured_angle_beyond_the_range_is_refused(kind: str) -> None:
    """At any tick: the header says so of every joint angle, and a wrap could not be reduced."""
    robot = ROBOTS[kind]
    ours, _ = both(robot, 0.0)
    for k, (t, given) in enumerate(signals(robot, seed=17)):
        if k in (0, 5):
            far = given[0].copy()
            far[1] = 100001.0
            with pytest.raises(ValueRangeError, match=r"^q\[1\] = 100001: a joint angle is beyond"):
                ours.command(t, far, *given[1:])
        ours.command(t, *given)


def test_reset_forgets_everything() -> None:
    robot = ROBOTS["mimic"]
    ours, _ = both(robot, 1.0)
    ticks = list(signals(robot, seed=19))
    first = [bits(ours.command(t, *given)) for t, given in ticks]
    ours.reset()
    assert [bits(ours.command(t, *given)) for t, given in ticks] == first
    ours.reset()
    later = [bits(ours.command(t + 8.0, *given)) for t, given in ticks]
    assert later[:1] == first[:1]  # the blend starts with the first command, not at t = 0


@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
@pytest.mark.parametrize("delay", [0.0, 1.0])
def test_a_copy_goes_on_where_the_original_stood(delay: float, how: Callable[[Any], Any]) -> None:
    robot = ROBOTS["revolute"]
    ours, _ = both(robot, delay)
    ticks = list(signals(robot, seed=23))
    for t, given in ticks[:20]:
        ours.command(t, *given)
    other = how(ours)
    assert remembered(other) == remembered(ours)
    mine = [bits(ours.command(t, *given)) for t, given in ticks[20:]]
    assert [bits(other.command(t, *given)) for t, given in ticks[20:]] == mine


@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("kind", KINDS)
def test_the_loop_in_c_and_commands_from_python_give_the_same_bits(kind: str, delay: float) -> None:
    robot = ROBOTS[kind]
    rng = np.random.default_rng(29)
    ours, _ = both(robot, delay)
    other, _ = both(robot, delay)
    t = np.arange(TICKS)[:, None] * T
    rate, phase = rng.uniform(1.0, 3.0, (2, robot.n))
    motion = [
        np.sin(rate * t + phase),
        rate * np.cos(rate * t + phase),
        -(rate**2) * np.sin(rate * t + phase),
    ]
    start = motion[0][0] + 1e-3, motion[1][0]
    loop = make_loop(ours, robot.sample_parameters(rng), None, *start, substeps=4, implicit=True)
    log = loop.advance(*motion, 1)
    assert loop.ticks == len(log["t"]) == TICKS
    for k in range(TICKS):
        command = other.command(log["t"][k], log["q"][k], log["dq"][k], *(x[k] for x in motion))
        for name in ("tau", "nominal", "phi_lo", "phi_hi", "rho"):
            assert getattr(command, name).tobytes() == log[name][k].tobytes(), (name, k)
        cut = np.abs(command.tau) == robot.effort_limits
        assert (np.abs(command.tau) <= robot.effort_limits).all(), cut


@pytest.mark.parametrize("law", ["norm", "componentwise"])
@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_law_that_allows_for_the_hold_equals_29(kind: str, delay: float, law: str) -> None:
    """V = (K^-1 + T (1 + 2 D) M_s^-1)^-1 r, by the inverses that the formula names."""
    robot = ROBOTS[kind]
    own: dict[str, Any] = {"kappa_P": 1.5, "phi_P": 3.0, "kappa_I": 40.0, "phi_I": 20.0}
    ours = mr.RobustController(robot, law=law, hold_aware=True, rate=RATE, delay=delay, **own)
    light = light_parameters(robot, central_parameters(robot))
    K_r = np.array(ours.settings.K_r)
    for t, (q, dq, q_des, dq_des, ddq_des) in signals(robot, seed=31):
        command = ours.command(t, q, dq, q_des, dq_des, ddq_des)
        e = q_des - q
        e = np.where(robot.wraps, np.arctan2(np.sin(e), np.cos(e)), e)
        r = dq_des - dq + K_r * e
        rho = command.rho if law == "componentwise" else np.linalg.norm(command.rho)
        K = (ours.kappa * rho + ours.phi) * np.ones(robot.n)
        M_s = mr.mass_matrix(robot, q, light)
        slow = np.diag(1.0 / K) + T * (1.0 + 2.0 * delay) * np.linalg.inv(M_s)
        expected = np.linalg.solve(slow, r)
        size = np.abs(expected).max()
        np.testing.assert_allclose(command.v, expected, rtol=0, atol=1e-9 * size)
        np.testing.assert_array_equal(command.tau, command.nominal + command.v)


def test_componentwise_takes_each_joint_s_own_bound() -> None:
    robot = ROBOTS["prismatic"]
    ours = mr.RobustController(robot, law="componentwise", kappa_P=1.5, phi_P=3.0)
    K_r = np.array(ours.settings.K_r)
    for t, (q, dq, q_des, dq_des, ddq_des) in signals(robot, seed=37):
        command = ours.command(t, q, dq, q_des, dq_des, ddq_des)
        r = dq_des - dq + K_r * (q_des - q)
        expected = (ours.kappa * command.rho + ours.phi) * r
        terms = np.abs(dq_des) + np.abs(dq) + K_r * (np.abs(q_des) + np.abs(q))  # that r cancels
        size = ((ours.kappa * command.rho + ours.phi) * terms).max()
        np.testing.assert_allclose(command.v, expected, rtol=0, atol=1e-14 * size)
        assert np.ptp(command.rho) > 0.0


@pytest.mark.parametrize("law", ["norm", "componentwise"])
@pytest.mark.parametrize("ceilings", [{}, {"kappa_max": 2.6}, {"kappa_max": 2.6, "phi_max": 1.9}])
@pytest.mark.parametrize("leak", [0.0, 5.0, 900.0])
def test_kappa_and_phi_rest_at_their_ceilings_and_decay(
    leak: float, ceilings: dict[str, Any], law: str
) -> None:
    """The integral I of f(|e|) loses `leak` I dt a tick; all of it where that is more than I."""
    robot = ROBOTS["revolute"]
    own: dict[str, Any] = {"kappa_P": 2.0, "phi_P": 1.0, "kappa_I": 2e3, "phi_I": 3e3}
    ours = mr.RobustController(robot, law=law, leak=leak, **own, **ceilings)
    integral, previous, last = 0.0, 0.0, 0.0
    tops = []
    for t, given in signals(robot, seed=41):
        ours.command(t, *given)
        elapsed, last = t - last, t
        integral = integral * max(1.0 - leak * elapsed, 0.0) + previous * elapsed
        error = float(np.linalg.norm(given[2] - given[0]))
        previous = error if error >= ours.settings.epsilon else 0.0
        for name, found in (("kappa", ours.kappa), ("phi", ours.phi)):
            value = own[f"{name}_P"] + own[f"{name}_I"] * integral
            ceiling = ceilings.get(f"{name}_max", np.inf)
            assert found == pytest.approx(min(value, ceiling), rel=1e-12)
            tops.append(value > ceiling)
    assert not ceilings or leak > 100.0 or any(tops)
    assert not all(tops)
