"""What happens between two commands: the plant's integration, the delay, sensors, disturbances.

The law `norm` with a known gain and a plant in Python that does as it is told show what the loop
measures and applies.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import modrobust as mr
from modrobust import _kernel
from modrobust.model import Bounded, LoopSettings, Parameters, Robot
from modrobust.simulation.plants import runge_kutta
from support.loops import make_loop
from support.random_robots import point_robot, random_robot, tied

DT = 1e-3  # [s], the default tick
FREE: dict[str, Any] = {"saturation": 1}  # with limits of 0: no torque but the disturbance


def unactuated(robot: Robot) -> mr.RobustController:
    """A controller whose torques are all cut to 0."""
    return mr.RobustController(replace(robot, effort_limits=np.zeros(robot.n)), law="norm")


def without_coulomb(point: Parameters) -> Parameters:
    return replace(point, coulomb=0.0 * point.coulomb)


def rest(robot: Robot, ticks: int) -> list[Any]:
    return [np.zeros((ticks, robot.n))] * 3


@pytest.mark.parametrize("kind", ["chain", "mimic"])
def test_the_implicit_step_is_of_second_order(kind: str) -> None:
    """On a smooth case, against Runge-Kutta at 1e-7 s: half the step, a quarter of the error."""
    rng = np.random.default_rng(3)
    robot = random_robot(rng, types="rrp") if kind == "chain" else random_robot(rng, types="rrpr")
    robot = robot if kind == "chain" else tied(robot, 2, rng)
    point = without_coulomb(robot.sample_parameters(rng))
    q, dq, d = rng.normal(size=(3, robot.n))
    span = 0.01  # [s], one tick

    def after(substeps: int, implicit: bool) -> Any:
        loop = make_loop(
            *(unactuated(robot), point, 20.0 * d, q, 3.0 * dq),
            **{"dt": span, "substeps": substeps, "implicit": implicit, **FREE},
        )
        loop.advance(*rest(robot, 1), 1)
        return np.concatenate([loop.q, loop.dq])

    exact = after(round(span / 1e-7), False)
    assert np.abs(exact[: robot.n] - q).max() > 5e-3
    errors = [np.abs(after(steps, True) - exact).max() for steps in (4, 8, 16, 32)]
    for one, half in itertools.pairwise(errors):
        assert 3.5 < one / half < 4.5, errors
    assert errors[-1] < 1e-5
    # and the explicit one is far nearer: of fourth order
    assert np.abs(after(4, False) - exact).max() < 0.01 * errors[0]


COULOMB, SPEED, INERTIA = 1.0, 1e-4, 1e-4  # [N m], [rad/s], [kg m^2]


def light_link() -> tuple[Robot, Parameters]:
    """One joint without rotor or gravity whose friction no explicit step can take."""
    robot = point_robot(
        "r", after=[np.eye(4)], mass=[1.0], com=[[0, 0, 0]], inertia=[INERTIA * np.eye(3)]
    )
    robot = replace(robot, coulomb_speed=np.full(1, SPEED))
    return robot, replace(robot.nominal, coulomb=np.full(1, COULOMB))


def smooth_law(drive: float, speed: float, span: float) -> Any:
    """Position and velocity after a time by a solver for stiff equations."""

    def slope(t: float, y: Any) -> list[float]:
        friction = COULOMB * y[1] / np.hypot(y[1], SPEED)
        return [y[1], (drive - friction) / INERTIA]

    found = solve_ivp(slope, (0.0, span), [0.0, speed], method="Radau", rtol=1e-10, atol=1e-14)
    return found.y[:, -1]


def stiff_loop(drive: float, speed: float, step: float) -> Any:
    robot, point = light_link()
    substeps = round(DT / step)
    given = (unactuated(robot), point, [drive], [0.0], [speed])
    return make_loop(*given, substeps=substeps, implicit=True, **FREE)


@pytest.mark.parametrize("speed", [1.0, -30.0, 1e-3])
def test_stiff_friction_brings_a_light_link_to_rest(speed: float) -> None:
    """Friction over inertia is 1e8 1/s here; an explicit step of 0.2 ms would blow up."""
    loop = stiff_loop(0.0, speed, 2e-4)
    robot, _ = light_link()
    log = loop.advance(*rest(robot, 30), 1)
    assert np.abs(log["dq"]).max() == abs(speed)  # never faster than at the start
    assert abs(loop.dq[0]) < 1e-12
    stopping = 0.5 * speed**2 * INERTIA / COULOMB
    # a step that stops within its first part knows the way to within a step's first order
    assert abs(loop.q[0]) <= 1.5 * stopping + 2e-4 * abs(speed)
    assert loop.q[0] * speed >= 0.0


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, -0.9])
def test_a_joint_that_sticks_drifts_no_faster_than_the_smooth_law_says(share: float) -> None:
    """Under a share s of the Coulomb torque: v_c s / sqrt(1 - s^2), the root of (20)."""
    loop = stiff_loop(share * COULOMB, 0.0, 2e-4)
    robot, _ = light_link()
    loop.advance(*rest(robot, 100), 1)
    drift = SPEED * share / np.sqrt(1.0 - share**2)
    assert abs(loop.q[0]) <= abs(drift) * 0.1 * (1.0 + 1e-9)
    assert loop.dq[0] == pytest.approx(drift, rel=1e-6)


@pytest.mark.parametrize(
    ("drive", "speed", "span"),
    [(1.05, 0.0, 2e-3), (1.01, 0.0, 2e-3), (1.001, 0.0, 1e-2), (1.0, 1e-2, 2e-3)],
)
def test_a_light_link_that_breaks_loose_accelerates_as_the_smooth_law_says(
    drive: float, speed: float, span: float
) -> None:
    loop = stiff_loop(drive * COULOMB, speed, 2e-4)
    robot, _ = light_link()
    loop.advance(*rest(robot, round(span / DT)), 1)
    q, dq = smooth_law(drive * COULOMB, speed, span)
    assert loop.dq[0] == pytest.approx(dq, rel=0.01)
    assert loop.q[0] == pytest.approx(q, rel=0.02)


@pytest.mark.parametrize("first", [1e-4, 10.0])
def test_every_joint_s_own_coulomb_speed_counts(first: float) -> None:
    """The light link beside a joint whose Coulomb speed is another, and that stands still."""
    robot = point_robot(
        "pr",
        after=[np.eye(4)] * 2,
        mass=[1e3, 1.0],
        com=[[0, 0, 0]] * 2,
        inertia=[INERTIA * np.eye(3)] * 2,
    )
    robot = replace(robot, gravity=np.zeros(3), coulomb_speed=np.array([first, SPEED]))
    point = replace(robot.nominal, coulomb=np.array([1.0, COULOMB]))
    start = (unactuated(robot), point, [0.0, 1.01 * COULOMB], [0.0, 0.0], [0.0, 0.0])
    loop = make_loop(*start, substeps=5, implicit=True, **FREE)
    loop.advance(*rest(robot, 2), 1)
    q, dq = smooth_law(1.01 * COULOMB, 0.0, 2e-3)
    assert loop.dq[1] == pytest.approx(dq, rel=0.01)
    assert loop.q[1] == pytest.approx(q, rel=0.02)


class Recorder:
    """A plant that moves as it is told and remembers what drove it."""

    def __init__(self, rows: Any = None, n: int = 0, steps: int = 1) -> None:
        self._rows = iter(rows) if rows is not None else itertools.repeat((np.zeros(n),) * 2)
        self._steps = steps
        self.calls: list[tuple[Any, Any, Any, float]] = []

    def step(self, q: Any, dq: Any, drive: Any, h: float) -> Any:
        self.calls.append((q, dq, drive, h))
        if len(self.calls) % self._steps:
            return q, dq
        after = next(self._rows)
        return tuple(np.array(x, dtype=float) for x in after)


def slides(n: int = 2) -> Robot:
    """Masses on prismatic joints, without gravity or friction: torques are linear in dq and q."""
    robot = point_robot(
        "p" * n,
        after=[np.eye(4)] * n,
        mass=np.arange(1.0, n + 1.0),
        com=np.zeros((n, 3)),
        inertia=[np.eye(3)] * n,
    )
    d = np.arange(1.0, n + 1.0)
    return replace(robot, gravity=np.zeros(3), disturbance=Bounded(np.zeros(n), -0.5 * d, 1.5 * d))


GAIN, K_R = 3.0, 10.0


def proportional(robot: Robot, **loop: Any) -> mr.RobustController:
    """V = GAIN r, with nothing that grows."""
    options: dict[str, Any] = {"kappa_P": 0.0, "kappa_I": 0.0, "phi_I": 0.0, "phi_P": GAIN}
    return mr.RobustController(robot, loop=LoopSettings(**loop), law="norm", K_r=K_R, **options)


def measured(robot: Robot, log: dict[str, Any]) -> tuple[Any, Any]:
    """Q and dq that the controller has seen, from its torques; the motion is at rest at 0."""
    M = mr.mass_matrix(robot, np.zeros(robot.n))
    dq = -np.linalg.solve(M, log["nominal"].T).T / K_R  # nominal = M K_r (0 - dq)
    r = (log["tau"] - log["nominal"]) / GAIN  # (0 - dq) + K_r (0 - q)
    return -(r + dq) / K_R, dq


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0])
def test_a_command_acts_as_late_as_it_is_said_to(delay: float) -> None:
    """The one before acts for D T, then the new one; the first from the beginning."""
    robot = slides()
    ticks, substeps = 6, 5
    rng = np.random.default_rng(1)
    plant = Recorder(rng.normal(size=(100, 2, 2)))
    controller = proportional(robot, delay=delay)
    loop = make_loop(controller, d=[0.25, -0.5], plant=plant, substeps=substeps)
    log = loop.advance(*rest(robot, ticks), 1)
    old, new = {0.0: (0, 5), 0.4: (2, 3), 1.0: (5, 0)}[delay]
    expected = []
    for k in range(ticks):
        before = log["tau"][max(k - 1, 0)]
        expected += [(before, delay * DT / max(old, 1))] * old
        expected += [(log["tau"][k], (1.0 - delay) * DT / max(new, 1))] * new
    assert len(plant.calls) == len(expected)
    for (_, _, drive, h), (tau, step) in zip(plant.calls, expected, strict=True):
        np.testing.assert_array_equal(drive, tau + np.array([0.25, -0.5]))
        assert h == pytest.approx(step, rel=1e-12)
    assert sum(h for *_, h in plant.calls) == pytest.approx(ticks * DT, rel=1e-12)


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0])
def test_the_loop_equals_the_loop_written_out(delay: float) -> None:
    """Torques of the log, held and late as above, through our forward dynamics in Python."""
    rng = np.random.default_rng(8)
    robot = random_robot(rng, types="rpr")
    point = robot.sample_parameters(rng)
    controller = mr.RobustController(robot, loop=LoopSettings(delay=delay), law="norm")
    q, dq, d = 0.1 * rng.normal(size=(3, robot.n))
    loop = make_loop(controller, point, d, q, dq, substeps=5)
    log = loop.advance(*rest(robot, 20), 1)
    old, new = {0.0: (0, 5), 0.4: (2, 3), 1.0: (5, 0)}[delay]

    def acceleration(q: Any, dq: Any, drive: Any) -> Any:
        return mr.forward_dynamics(robot, q, dq, drive, point)

    for k in range(20):
        np.testing.assert_allclose(log["q"][k], q, rtol=0, atol=1e-12 * (1 + k))
        np.testing.assert_allclose(log["dq"][k], dq, rtol=0, atol=1e-10 * (1 + k))
        for tau, part, steps in (
            (log["tau"][max(k - 1, 0)], delay, old),
            (log["tau"][k], 1.0 - delay, new),
        ):
            for _ in range(steps):
                q, dq = runge_kutta(acceleration, q, dq, tau + d, part * DT / steps)


def test_measured_is_what_is_there_where_nothing_is_said_of_noise() -> None:
    robot = slides()
    rows = np.random.default_rng(2).normal(size=(10, 2, 2))
    loop = make_loop(proportional(robot), plant=Recorder(rows))
    log = loop.advance(*rest(robot, 10), 1)
    q, dq = measured(robot, log)
    np.testing.assert_allclose(q, log["q"], atol=1e-13)
    np.testing.assert_allclose(dq, log["dq"], atol=1e-13)
    np.testing.assert_array_equal(log["q"][1:], rows[:9, 0])


def test_noise_is_uniform_in_its_box_and_each_measurement_s_own() -> None:
    robot, count = slides(), 6000
    wide_q, wide_dq = np.array([1e-3, 2e-2]), np.array([0.3, 0.05])
    noise: dict[str, Any] = {"noise_position": tuple(wide_q), "noise_velocity": tuple(wide_dq)}

    def errors(seed: int) -> Any:
        loop = make_loop(proportional(robot, **noise), plant=Recorder(n=2), seed=seed)
        q, dq = measured(robot, loop.advance(*rest(robot, count), 1))
        return np.concatenate([q / wide_q, dq / wide_dq], axis=1)

    found = errors(0)
    assert np.abs(found).max() <= 1.0 + 1e-10
    assert np.abs(found).max(axis=0).min() > 0.995
    sigma = 1.0 / np.sqrt(3.0)
    np.testing.assert_allclose(found.mean(axis=0), 0.0, atol=4.0 * sigma / np.sqrt(count))
    np.testing.assert_allclose(found.std(axis=0), sigma, rtol=0.03)
    fractions = [np.mean(np.abs(found) < x, axis=0) for x in (0.25, 0.5, 0.75)]
    np.testing.assert_allclose(fractions, np.array([[0.25], [0.5], [0.75]]) * np.ones(4), atol=0.03)
    apart = np.corrcoef(np.concatenate([found[1:], found[:-1]], axis=1).T) - np.eye(8)
    assert np.abs(apart).max() < 0.06  # neither joint knows of another, nor a tick of the last
    np.testing.assert_array_equal(errors(0), found)
    assert np.abs(errors(1) - found).max() > 0.5


def test_the_worst_noise_hides_r() -> None:
    """At the end of the box that makes r look smaller, whatever its sign; none where it is 0."""
    robot = slides(3)
    wide_q, wide_dq = np.array([1e-3, 2e-3, 3e-3]), np.array([0.1, 0.2, 0.3])
    at = {"noise_position": tuple(wide_q), "noise_velocity": tuple(wide_dq), "noise": "worst"}
    rng = np.random.default_rng(4)
    rows = np.array([[[*q, 0.0], [*dq, 0.0]] for q, dq in rng.normal(size=(40, 2, 2))])
    loop = make_loop(proportional(robot, **at), plant=Recorder(rows))
    log = loop.advance(*rest(robot, 40), 1)
    q, dq = measured(robot, log)
    r = -log["dq"] - K_R * log["q"]
    assert (np.count_nonzero(r[:, :2] > 0.0, axis=0) > 5).all()
    np.testing.assert_allclose(q - log["q"], np.sign(r) * wide_q, atol=1e-12)
    np.testing.assert_allclose(dq - log["dq"], np.sign(r) * wide_dq, atol=1e-12)
    np.testing.assert_array_equal(r[:, 2], 0.0)
    seen = -dq - K_R * q
    np.testing.assert_allclose(seen[:, :2], (r - np.sign(r) * (wide_dq + K_R * wide_q))[:, :2])


def test_quantised_measurements_are_the_nearest_steps() -> None:
    robot = slides()
    step_q, step_dq = np.array([1e-2, 0.0]), np.array([0.0, 0.25])
    steps = {"quantisation_position": tuple(step_q), "quantisation_velocity": tuple(step_dq)}
    rows = np.random.default_rng(5).normal(size=(50, 2, 2))
    rows[7, 0, 0], rows[8, 1, 1] = -0.015, 0.375  # half-way: up
    loop = make_loop(proportional(robot, **steps), plant=Recorder(rows))
    log = loop.advance(*rest(robot, 50), 1)
    q, dq = measured(robot, log)
    np.testing.assert_allclose(q[:, 0], 1e-2 * np.floor(log["q"][:, 0] / 1e-2 + 0.5), atol=1e-12)
    np.testing.assert_allclose(dq[:, 1], 0.25 * np.floor(log["dq"][:, 1] / 0.25 + 0.5), atol=1e-12)
    np.testing.assert_allclose(q[:, 1], log["q"][:, 1], atol=1e-12)
    np.testing.assert_allclose(dq[:, 0], log["dq"][:, 0], atol=1e-12)


@pytest.mark.parametrize("step", [0.0, 1e-2])
def test_a_differentiated_velocity_is_the_filtered_slope_of_the_measured_position(
    step: float,
) -> None:
    """It starts from the true one; noise of a measured velocity has no part in it."""
    robot, corner = slides(), 40.0
    settings: dict[str, Any] = {"velocity": "differentiated", "filter": corner}
    settings |= {"quantisation_position": (step, step), "noise_velocity": (9.0, 9.0)}
    rows = np.random.default_rng(6).normal(size=(50, 2, 2))
    loop = make_loop(proportional(robot, **settings), dq=[0.5, -0.25], plant=Recorder(rows))
    parts = [loop.advance(*rest(robot, 25), 1) for _ in range(2)]  # the filter goes on
    log = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    _, dq = measured(robot, log)
    seen = step * np.floor(log["q"] / step + 0.5) if step else log["q"]
    share = 1.0 - np.exp(-2.0 * np.pi * corner * DT)
    rate = np.array([0.5, -0.25])
    for k in range(50):
        if k:
            rate = rate + share * ((seen[k] - seen[k - 1]) / DT - rate)
        np.testing.assert_allclose(dq[k], rate, rtol=1e-9, atol=1e-9)


def disturbances(kind: str, ticks: int, **settings: Any) -> tuple[Robot, Any, Recorder]:
    """D at each step, of a robot that stands still off the motion."""
    robot = slides()
    plant = Recorder(n=2)
    loop = make_loop(proportional(robot, disturbance=kind), d=[0.4, -0.3], plant=plant, **settings)
    log = loop.advance(*rest(robot, ticks), 1)
    tau = np.repeat(log["tau"], len(plant.calls) // ticks, axis=0)
    return robot, np.array([drive for _, _, drive, _ in plant.calls]) - tau, plant


def test_a_constant_disturbance_is_the_one_given() -> None:
    _, d, _ = disturbances("constant", 5)
    np.testing.assert_allclose(d, [[0.4, -0.3]] * 5, atol=1e-15)


def test_a_sine_swings_over_the_whole_box_with_its_frequency() -> None:
    robot, d, _ = disturbances("sine", 2000, frequency=2.0)
    box = robot.disturbance
    assert (box.lo <= d).all()
    assert (d <= box.hi).all()
    np.testing.assert_allclose(d.min(axis=0), box.lo, atol=1e-3)
    np.testing.assert_allclose(d.max(axis=0), box.hi, atol=1e-3)
    share = (d - 0.5 * (box.lo + box.hi)) / (0.5 * (box.hi - box.lo))
    np.testing.assert_allclose(share[500:], share[:-500], atol=1e-9)  # half a second, a period
    np.testing.assert_allclose(share[250:], -share[:-250], atol=1e-9)
    np.testing.assert_allclose(share[1:-1] * 2.0 * np.cos(4e-3 * np.pi), share[2:] + share[:-2],
                               atol=1e-9)  # fmt: skip
    assert abs(np.corrcoef(share.T)[0, 1]) < 0.95  # out of step


def test_a_random_disturbance_is_drawn_in_the_box_once_a_tick() -> None:
    robot, d, plant = disturbances("random", 4000, substeps=2)
    box = robot.disturbance
    assert len(plant.calls) == 8000
    np.testing.assert_allclose(d[::2], d[1::2], atol=1e-14)
    share = (d[::2] - 0.5 * (box.lo + box.hi)) / (0.5 * (box.hi - box.lo))
    assert np.abs(share).max() <= 1.0 + 1e-12
    assert np.abs(share).max(axis=0).min() > 0.99
    np.testing.assert_allclose(share.mean(axis=0), 0.0, atol=0.04)
    np.testing.assert_allclose(share.std(axis=0), 1.0 / np.sqrt(3.0), rtol=0.04)
    assert abs(np.corrcoef(share.T)[0, 1]) < 0.06
    assert np.unique(share[:, 0]).size == 4000


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0])
def test_the_worst_disturbance_pushes_away_from_the_motion_at_every_step(delay: float) -> None:
    """The end of [d] that makes r grow, with the motion going on within the tick."""
    robot = slides()
    box = robot.disturbance
    rng = np.random.default_rng(7)
    motion = [rng.normal(size=(20, 2)) for _ in range(3)]
    motion[2] *= 3e3  # [m/s^2], so that r changes sign within ticks
    plant = Recorder(rng.normal(size=(100, 2, 2)))
    loop = make_loop(proportional(robot, disturbance="worst", delay=delay), plant=plant, substeps=5)
    log = loop.advance(*motion, 1)
    changed = 0
    for k in range(20):
        q_des, dq_des, ddq_des = (x[k] for x in motion)
        since, signs = 0.0, []
        for q, dq, drive, h in plant.calls[5 * k : 5 * k + 5]:
            s = since
            e = q_des + s * dq_des + s**2 / 2.0 * ddq_des - q
            r = dq_des + s * ddq_des - dq + K_R * e
            late = since < delay * DT * (1.0 - 1e-9)
            tau = log["tau"][max(k - 1, 0) if late else k]
            np.testing.assert_allclose(drive - tau, np.where(r > 0.0, box.lo, box.hi), atol=1e-9)
            since += h
            signs.append(r > 0.0)
        changed += not all((x == signs[0]).all() for x in signs)
    assert changed > 5


def test_limits_cut_the_torques_and_are_counted_joint_by_joint() -> None:
    limits = np.array([1.0, 4.0])
    robot = replace(slides(), effort_limits=limits)
    rows = np.random.default_rng(9).normal(size=(200, 2, 2)) * 0.05
    plain = make_loop(proportional(robot), plant=Recorder(rows))
    cutting = make_loop(proportional(robot, saturation=True), plant=Recorder(rows))
    given, cut = (loop.advance(*rest(robot, 200), 1)["tau"] for loop in (plain, cutting))
    np.testing.assert_array_equal(cut, np.clip(given, -limits, limits))
    over = np.abs(given) >= limits
    assert (over.sum(axis=0) > 5).all()
    assert (over.all(axis=1) != over.any(axis=1)).any()
    np.testing.assert_array_equal(cutting.ticks_at_limit, over.sum(axis=0))
    assert cutting.limited == np.count_nonzero(over.any(axis=1))
    np.testing.assert_array_equal(plain.ticks_at_limit, 0.0)  # beyond them, but nothing is cut
    assert plain.limited == 0
    np.testing.assert_array_equal(cutting.tau_max, np.minimum(np.abs(given).max(axis=0), limits))


class OurDynamics:
    """A plant in Python that asks our forward dynamics, by Runge-Kutta's method."""

    def __init__(self, robot: Robot, point: Parameters) -> None:
        self.robot, self.point, self.steps = robot, point, 0
        self.fails_at = -1

    def step(self, q: Any, dq: Any, drive: Any, h: float) -> tuple[Any, Any]:
        self.steps += 1
        if self.steps == self.fails_at:
            raise ZeroDivisionError("the plant has had enough")

        def acceleration(q: Any, dq: Any, drive: Any) -> Any:
            return mr.forward_dynamics(self.robot, q, dq, drive, self.point)

        return runge_kutta(acceleration, q, dq, drive, h)


def driven() -> tuple[Robot, Parameters, dict[str, Any]]:
    rng = np.random.default_rng(10)
    robot = tied(random_robot(rng, types="rprr"), 3, rng)
    loop = {
        "delay": 0.4, "disturbance": "random", "velocity": "differentiated", "saturation": True,
        "noise_position": (1e-5,) * 3,
    }  # fmt: skip
    robot = replace(robot, effort_limits=np.full(3, 60.0))
    return robot, robot.sample_parameters(rng), loop


LAW: dict[str, Any] = {"law": "sampled", "G": 30.0, "blend": 0.01}


def test_a_plant_of_our_forward_dynamics_moves_as_the_builtin_one() -> None:
    robot, point, settings = driven()
    logs = []
    for plant in (None, OurDynamics(robot, point)):
        controller = mr.RobustController(robot, loop=LoopSettings(**settings), **LAW)
        loop = make_loop(controller, point, q=[0.01, 0.0, -0.01], plant=plant, substeps=5)
        logs.append(loop.advance(*rest(robot, 40), 1))
        assert loop.status == 0
    for name, ours in logs[0].items():
        size = np.abs(ours).max()
        np.testing.assert_allclose(logs[1][name], ours, rtol=0, atol=1e-12 * size, err_msg=name)


TOTALS = (
    *("status", "ticks", "violations", "violation_max", "error_last", "last_outside", "rho_sum"),
    *("error_max_after", "rho_max", "limited", "q", "dq", "tau_max", "ticks_at_limit"),
)


def state_of(loop: _kernel.Loop) -> list[bytes]:
    return [np.asarray(getattr(loop, name)).tobytes() for name in TOTALS]


@pytest.mark.parametrize("at", [1, 7, 8, 34])
def test_what_a_plant_raises_comes_out_and_leaves_the_loop_as_it_was(at: int) -> None:
    robot, point, settings = driven()
    loops = []
    for _ in range(2):
        plant = OurDynamics(robot, point)
        controller = mr.RobustController(robot, loop=LoopSettings(**settings), **LAW)
        loop = make_loop(controller, point, q=[0.01, 0.0, -0.01], plant=plant, substeps=5)
        loop.advance(*rest(robot, 10), 1)
        loops.append((loop, plant))
    (loop, plant), (other, _) = loops
    before = state_of(loop)
    plant.fails_at = plant.steps + at
    with pytest.raises(ZeroDivisionError, match="had enough"):
        loop.advance(*rest(robot, 10), 1)
    assert state_of(loop) == before
    again, expected = (x.advance(*rest(robot, 10), 1) for x in (loop, other))
    for name, value in expected.items():  # generators, filter and controller too
        assert again[name].tobytes() == value.tobytes(), name
    assert state_of(loop) == state_of(other)


@pytest.mark.parametrize("answer", [None, (np.zeros(3),), (np.zeros(2), np.zeros(3)), "no"])
def test_a_plant_that_answers_something_else_is_an_error(answer: Any) -> None:
    class Wrong:
        def step(self, *_: Any) -> Any:
            return answer

    robot = slides(3)
    loop = make_loop(proportional(robot), plant=Wrong())
    with pytest.raises((ValueError, RuntimeError, TypeError)):
        loop.advance(*rest(robot, 2), 1)
    assert loop.ticks == 0


def test_a_plant_that_leaves_the_range_has_diverged() -> None:
    class Lost:
        def step(self, *_: Any) -> Any:
            raise _kernel.KernelError(_kernel.STATUS_DIVERGED)

    robot = slides()
    loop = make_loop(proportional(robot), plant=Lost())
    log = loop.advance(*rest(robot, 3), 1)
    assert loop.status == _kernel.STATUS_DIVERGED
    assert len(log["t"]) == 1  # the state at which it was asked
