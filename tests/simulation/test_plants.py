"""The true robot in MuJoCo and in Pinocchio: it moves as ours does, and the guarantee holds there.

The control rates are those at which the loop is stable and the test quick: 3 kHz for the LWA 4P
with a payload, whose rotors make its light wrist heavy enough; 50 kHz for the paper's robot, which
has none.
"""

from __future__ import annotations

import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.errors import MissingExtraError, ValueRangeError
from modrobust.model import Parameters, Robot
from modrobust.simulation import SimulationResult, simulate
from modrobust.simulation.plants import PLANTS, make_plant
from modrobust.simulation.result import LOGGED
from support.loops import make_loop
from support.random_robots import random_robot, tied

ENGINES = ("mujoco", "pinocchio")
RATE = 3e3  # [Hz]


def frictionless(robot: Robot) -> Robot:
    def without(point: Parameters) -> Parameters:
        return replace(point, viscous=0.0 * point.viscous, coulomb=0.0 * point.coulomb)

    return replace(
        robot,
        nominal=without(robot.nominal),
        lower=without(robot.lower),
        upper=without(robot.upper),
    )


@pytest.fixture(scope="module")
def smooth_runs() -> dict[str, SimulationResult]:
    """Ten seconds of the LWA 4P with a payload, no friction, random true parameters."""
    robot = frictionless(mr.load_robot("lwa4p-payload"))
    options: dict[str, Any] = {"rate": RATE, "seed": 3, "duration": 10.0}
    return {plant: simulate(robot, plant=plant, **options) for plant in PLANTS}


@pytest.fixture(scope="module")
def runs() -> dict[str, SimulationResult]:
    """Two seconds of the same robot with its friction, at a corner of the bounds."""
    robot = mr.load_robot("lwa4p-payload")
    options: dict[str, Any] = {"parameters": "corner", "seed": 4, "rate": RATE}
    return {plant: simulate(robot, plant=plant, duration=2.0, **options) for plant in PLANTS}


def apart(one: SimulationResult, other: SimulationResult) -> float:
    """Largest difference of joint positions over time [rad]."""
    assert one.q.shape == other.q.shape
    return float(np.abs(one.q - other.q).max())


def test_three_plants_agree_within_a_tenth_of_a_milliradian_over_ten_seconds(
    smooth_runs: dict[str, SimulationResult],
) -> None:
    builtin = smooth_runs["builtin"]
    assert builtin.t[-1] == pytest.approx(10.0)
    assert np.ptp(builtin.q, axis=0).min() > 0.3  # they move [rad]
    for plant in ENGINES:
        assert apart(builtin, smooth_runs[plant]) < 1e-4  # required; seen: 3e-16
        assert apart(builtin, smooth_runs[plant]) < 1e-10


def test_the_bound_holds_and_epsilon_is_reached_in_all_three_plants(
    smooth_runs: dict[str, SimulationResult], runs: dict[str, SimulationResult]
) -> None:
    for result in (*smooth_runs.values(), *runs.values()):
        figures = result.summary()
        assert figures["violations"] == 0
        assert figures["epsilon_entered_at"] is not None
        assert figures["ok"]


def test_friction_makes_no_difference_to_the_agreement(runs: dict[str, SimulationResult]) -> None:
    assert runs["builtin"].parameters.coulomb.min() > 1.0  # [N m]
    for plant in ENGINES:
        assert apart(runs["builtin"], runs[plant]) < 1e-10


def test_everything_that_is_logged_agrees_and_the_figures_over_all_ticks_too(
    runs: dict[str, SimulationResult],
) -> None:
    builtin = runs["builtin"]
    for plant in ENGINES:
        for name in LOGGED:
            ours, theirs = getattr(builtin, name), getattr(runs[plant], name)
            np.testing.assert_allclose(theirs, ours, rtol=1e-7, atol=1e-7, err_msg=name)
        one, other = builtin.statistics, runs[plant].statistics
        assert one is not None
        assert other is not None
        for key, value in vars(one).items():
            np.testing.assert_allclose(getattr(other, key), value, rtol=1e-7, atol=1e-9)
        assert runs[plant].settings["plant"] == plant


def test_the_paper_s_robot_moves_alike_at_50_khz() -> None:
    robot = mr.load_robot("lwa4p-paper")
    ran = {
        p: simulate(robot, scenario="2", plant=p, duration=0.1, rate=50e3, law="norm")
        for p in PLANTS
    }
    for plant in ENGINES:
        assert apart(ran["builtin"], ran[plant]) < 1e-10
        assert ran[plant].summary()["violations"] == 0
        assert len(ran[plant].t) == 101


def test_a_violated_bound_is_seen_with_every_plant() -> None:
    """The true robot has no friction; the bounds say that it has."""
    robot = mr.load_robot("lwa4p")
    truth = frictionless(robot).nominal
    options: dict[str, Any] = {"parameters": truth, "rate": 2e3, "duration": 0.1}
    ran = [simulate(robot, plant=plant, **options).statistics for plant in PLANTS]
    counts = {statistics.violations for statistics in ran if statistics is not None}
    assert len(counts) == 1
    assert counts.pop() > 150


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_bound_violated_on_one_side_only_is_seen(side: float) -> None:
    """A disturbance beyond [d] moves w of every joint to one side."""
    robot = mr.load_robot("lwa4p-payload")
    options: dict[str, Any] = {"disturbance": side * np.full(robot.n, 100.0), "rate": RATE}
    ran = [simulate(robot, plant=p, duration=0.003, **options).statistics for p in PLANTS]
    assert [s.violations for s in ran if s is not None] == [10, 10, 10]
    largest = [s.violation_max for s in ran if s is not None]
    np.testing.assert_allclose(largest, largest[0], rtol=1e-9)
    assert largest[0] > 1.0


class Script:
    """A plant that stands where it is told."""

    def __init__(self, rows: Any) -> None:
        self._rows = iter(rows)

    def step(self, q: Any, dq: Any, drive: Any, h: float) -> tuple[Any, Any]:
        return next(self._rows, q), np.zeros(len(q))


def test_the_largest_error_counts_from_the_last_time_that_epsilon_was_left() -> None:
    robot = mr.load_robot("lwa4p-paper")
    controller = mr.RobustController(robot, epsilon=0.01, law="norm")
    rows = np.zeros((6, robot.n))
    rows[:, 2] = [0.0, 0.009, 0.02, 0.003, 0.005, 0.004]
    loop = make_loop(controller, q=rows[0], plant=Script(rows[1:]), dt=1e-3)
    zero = np.zeros((6, robot.n))
    log = loop.advance(zero, zero, zero, 2)
    assert log["t"].tolist() == [0.0, 0.002, 0.004]
    np.testing.assert_array_equal(log["q"], rows[::2])
    assert (loop.ticks, loop.last_outside) == (6, 0.002)
    assert loop.error_max_after == pytest.approx(0.005, abs=1e-15)
    assert loop.error_last == pytest.approx(0.004, abs=1e-15)


@pytest.mark.parametrize("plant", ENGINES)
@pytest.mark.parametrize("shape", ["chain", "tree", "mimic", "carrying mimic joints"])
def test_without_a_controller_the_motion_is_that_of_our_forward_dynamics(
    plant: str, shape: str
) -> None:
    """No loop that would hide a difference: given torques, friction, rotors, a disturbance."""
    rng = np.random.default_rng(11)
    robot = (
        random_robot(rng, types="rprrp") if shape == "chain" else random_robot(rng, 7, tree=True)
    )
    if shape.endswith("mimic"):
        robot = tied(robot, 4, rng, anywhere=shape.startswith("carrying"))
    point, d = robot.sample_parameters(rng), rng.normal(size=robot.n)
    q, dq = rng.normal(size=(2, robot.n))
    motion = make_plant(plant, robot, point)
    theirs = q, dq
    for _ in range(600):
        drive = 20.0 * rng.normal(size=robot.n) + d
        theirs = motion.step(*theirs, drive, 5e-5)
        q, dq = runge_kutta(robot, point, q, dq, drive, 5e-5)
    assert np.abs(dq).max() > 0.1
    np.testing.assert_allclose(theirs[0], q, rtol=0, atol=1e-10)
    np.testing.assert_allclose(theirs[1], dq, rtol=0, atol=1e-8)


@pytest.mark.parametrize("plant", ENGINES)
@pytest.mark.parametrize("shape", ["chain", "carrying mimic joints"])
def test_an_implicit_step_of_an_engine_is_that_of_our_own_plant(plant: str, shape: str) -> None:
    """Steps of 1 ms over friction that an explicit one could not take."""
    rng = np.random.default_rng(12)
    robot = random_robot(rng, types="rprrp", drives=False)
    if shape != "chain":
        robot = tied(robot, 3, rng, anywhere=True)
    friction = {"viscous": np.full(robot.j, 0.3), "coulomb": rng.uniform(0.5, 3.0, robot.j)}
    robot = replace(
        robot,
        effort_limits=np.zeros(robot.n),
        coulomb_speed=np.full(robot.j, 1e-4),
        **{
            name: replace(getattr(robot, name), **friction)
            for name in ("nominal", "lower", "upper")
        },
    )
    d, q, dq = 3.0 * rng.normal(size=robot.n), *rng.normal(size=(2, robot.n))
    moving = make_plant(plant, robot, robot.nominal, implicit=True)
    logs = []
    for one in (None, moving):
        controller = mr.RobustController(robot, law="norm")
        loop = make_loop(
            controller, d=d, q=q, dq=dq, plant=one, substeps=2, implicit=True, saturation=1
        )
        logs.append(loop.advance(*[np.zeros((100, robot.n))] * 3, 1))
        assert loop.status == 0
    for name in ("q", "dq"):
        np.testing.assert_allclose(logs[1][name], logs[0][name], rtol=0, atol=1e-8)
    assert np.abs(logs[0]["q"][-1] - q).max() > 0.05


def runge_kutta(
    robot: Robot, point: Parameters, q: Any, dq: Any, tau: Any, h: float
) -> tuple[Any, Any]:
    def slope(state: Any) -> Any:
        a = mr.forward_dynamics(robot, state[0], state[1], tau, point)
        return np.array([state[1], a])

    y = np.array([q, dq])
    k1 = slope(y)
    k2 = slope(y + h / 2 * k1)
    k3 = slope(y + h / 2 * k2)
    k4 = slope(y + h * k3)
    q, dq = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return q, dq


@pytest.mark.parametrize("plant", PLANTS)
def test_a_run_that_diverges_says_so_and_leaves_no_file(
    plant: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    robot = mr.load_robot("lwa4p-paper")
    result = simulate(robot, scenario="1", plant=plant, rate=500.0, duration=1.0)
    assert result.diverged
    assert result.summary()["reasons"]
    assert len(result.t) < 500
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("plant", ENGINES)
@pytest.mark.filterwarnings("ignore:(overflow|invalid value):RuntimeWarning")
def test_a_state_out_of_range_shows_and_leaves_no_file(
    plant: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """MuJoCo would start anew from zero, and write MUJOCO_LOG.TXT."""
    monkeypatch.chdir(tmp_path)
    robot = mr.load_robot("lwa4p-paper")
    zero = np.zeros(robot.n)
    motion = make_plant(plant, robot, robot.nominal)

    def run_away() -> None:
        q, dq = zero + 1.0, zero
        for drive in (1e5, 1e5, 1e5, 1e5, 1e200, 0.0):
            q, dq = motion.step(q, dq, zero + drive, 1e-3)

    with pytest.raises(_kernel.KernelError) as caught:
        run_away()
    assert caught.value.args == (_kernel.STATUS_DIVERGED,)
    assert list(tmp_path.iterdir()) == []


def test_mujoco_s_hooks_are_the_user_s_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """They belong to the whole process: we set none, and none of the user's acts on our robot."""
    mujoco = pytest.importorskip("mujoco")
    robot = mr.load_robot("lwa4p")
    one, other = (in_mujoco(robot) for _ in range(2))
    calls: list[Any] = []

    def mine(model: Any, data: Any) -> None:
        calls.append(data)

    def refuse(*_: Any) -> None:
        raise AssertionError("a hook of the process was set")

    hooks = [name for name in dir(mujoco) if name.startswith(("set_mjcb", "set_mju"))]
    assert {"set_mjcb_passive", "set_mjcb_control", "set_mju_user_warning"} <= set(hooks)
    setters = {name: getattr(mujoco, name) for name in hooks}
    setters["set_mjcb_passive"](mine)
    setters["set_mjcb_control"](mine)
    for name in hooks:
        monkeypatch.setattr(mujoco, name, refuse)
    try:
        with_hook = moved(one, 20)
        assert mujoco.get_mjcb_passive() is mine
    finally:
        setters["set_mjcb_passive"](None)
        setters["set_mjcb_control"](None)
    assert not calls
    np.testing.assert_array_equal(with_hook, moved(other, 20))


def in_mujoco(robot: Robot) -> Any:
    """MuJoCo cannot make a model while a hook is set."""
    return robot, make_plant("mujoco", robot, robot.nominal)


def moved(plant: Any, ticks: int) -> Any:
    """Positions after some ticks under a torque, in motion, so that friction acts."""
    robot, motion = plant
    q, dq = np.full(robot.n, 0.3), np.full(robot.n, 0.5)
    for _ in range(2 * ticks):
        q, dq = motion.step(q, dq, np.ones(robot.n), 5e-4)
    return q


def test_two_threads_and_a_user_s_own_model_do_not_disturb_each_other() -> None:
    mujoco = pytest.importorskip("mujoco")
    robots = [mr.load_robot(name) for name in ("lwa4p", "lwa4p-payload")]
    alone = [moved(in_mujoco(robot), 200) for robot in robots]
    own = mujoco.MjModel.from_xml_string(
        '<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="a" type="hinge"/>'
        '<geom size="0.1" mass="1"/></body></worldbody></mujoco>'
    )

    def coast() -> float:
        """A wheel without friction, in the user's own thread."""
        data = mujoco.MjData(own)
        data.qvel[0] = 1.0
        for _ in range(2000):
            mujoco.mj_step(own, data)
        return float(data.qvel[0])

    with ThreadPoolExecutor(3) as pool:
        runs = [pool.submit(moved, in_mujoco(robot), 200) for robot in robots]
        wheel = pool.submit(coast)
        for run, expected in zip(runs, alone, strict=True):
            np.testing.assert_array_equal(run.result(), expected)
        assert wheel.result() == 1.0


@pytest.mark.parametrize(("plant", "package"), [("mujoco", "mujoco"), ("pinocchio", "pinocchio")])
def test_an_engine_that_is_not_installed_names_its_extra(
    plant: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingExtraError) as caught:
        simulate(mr.load_robot("scara"), plant=plant)
    assert str(caught.value) == (
        f'plant "{plant}": the package {package} is not installed; '
        f'install it with pip install "modrobust[{plant}]"'
    )


def test_an_unknown_plant_is_refused() -> None:
    with pytest.raises(ValueRangeError) as caught:
        simulate(mr.load_robot("scara"), plant="mujuco")
    assert str(caught.value) == (
        'plant: no plant "mujuco"; did you mean "mujoco"? known: builtin, mujoco, pinocchio'
    )
