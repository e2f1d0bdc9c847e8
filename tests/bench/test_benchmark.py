"""Times, growth and tightness: that they are measured and kept, never how fast they are."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.bench.benchmark import (
    PAPER_TIMES,
    Growth,
    Tightness,
    benchmark,
    growth,
    random_tightness,
    replay,
)
from modrobust.cli.bench import print_benchmark
from modrobust.errors import ValueRangeError
from modrobust.model import Robot, synthetic_chain
from modrobust.simulation.metrics import plain, ratio, time_statistics


@pytest.fixture(scope="module")
def arm() -> Robot:
    return synthetic_chain(3, uncertainty=0.1)


def test_the_papers_figures_are_those_of_section_v() -> None:
    assert PAPER_TIMES == {"mean": 15.3e-6, "max": 17.2e-6, "std": 0.288e-6}


def test_a_replay_times_every_command_of_the_run_in_c_and_in_python(arm: Robot) -> None:
    run = mr.simulate(arm, duration=0.1, rate=10e3)
    times = replay(run, "ianea", repeat=3)
    assert times.in_c.shape == times.in_python.shape == (3 * 101,)
    assert (times.in_c > 0.0).all()
    # The Python call contains the C call.
    assert np.median(times.in_python) > np.median(times.in_c)
    figures = times.to_dict()
    assert figures["commands"] == 303
    assert set(figures["in_c"]) == {"mean", "max", "std", "p50", "p99", "min"}


def test_times_are_summarised_as_their_names_say() -> None:
    seconds = np.arange(1.0, 102.0)
    assert time_statistics(seconds) == {
        "mean": 51.0,
        "max": 101.0,
        "std": pytest.approx(np.sqrt((101.0**2 - 1.0) / 12.0)),
        "p50": 51.0,
        "p99": 100.0,
        "min": 1.0,
    }
    assert set(time_statistics(np.zeros(0)).values()) == {None}


def test_the_exponent_is_the_slope_over_the_longer_chains() -> None:
    joints = [2, 4, 8, 16, 32, 64]
    seconds = [1.0, 1.0, 1.0, *(1e-6 * n**1.5 for n in joints[3:])]
    assert Growth("hull", joints, seconds).exponent == pytest.approx(1.5)
    assert Growth("hull", [2, 4], [1.0, 2.0]).exponent is None


def test_growth_measures_each_size(arm: Robot) -> None:
    shown: list[float] = []
    result = growth("hull", (2, 5), repeat=1, progress=shown.append)
    assert result.joints == [2, 5]
    assert all(0.0 < seconds < 1.0 for seconds in result.seconds)
    assert shown == [0.5, 1.0]


def test_tightness_is_the_width_of_ianea_over_that_of_hull(arm: Robot) -> None:
    result = random_tightness(arm, states=50, seed=1)
    assert (result.width_ianea >= result.width_hull * (1.0 - 1e-9)).all()
    figures = result.to_dict()
    assert figures["states"] == 50
    expected = result.width_ianea.mean(axis=0) / result.width_hull.mean(axis=0)
    np.testing.assert_allclose(figures["ianea_over_hull"], expected)
    assert figures["ianea_over_hull"][0] > 2.0
    assert figures["ianea_over_hull_median"][0] >= 1.0
    again = random_tightness(arm, states=50, seed=1)
    np.testing.assert_array_equal(result.width_hull, again.width_hull)
    assert np.abs(random_tightness(arm, 50, 2).width_hull - result.width_hull).max() > 1e-3


def test_random_states_respect_the_limits(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def spy(robot: Robot, q: Any, dq: Any, dq_a: Any, ddq_a: Any, bound: str) -> Any:
        seen.append((q, dq, dq_a))
        return np.zeros(3), np.ones(3)

    monkeypatch.setattr("modrobust.bench.benchmark.perturbation_bounds", spy)
    limits = np.array([[0.1, 0.2], [-np.inf, -1.0], [-0.5, np.inf]])
    random_tightness(replace(arm, position_limits=limits, velocity_limits=np.full(3, 0.3)), 100)
    q, dq, dq_a = (np.array(column) for column in zip(*seen, strict=True))
    assert ((q >= limits[:, 0]) & (q <= limits[:, 1])).all()
    assert np.abs(dq).max() <= 0.3
    assert 0.2 < np.abs(dq_a).max() <= 0.3


def test_a_bound_without_width_has_no_ratio() -> None:
    result = Tightness("here", np.array([[0.0, 1.0]]), np.array([[0.0, 2.0]])).to_dict()
    assert result["ianea_over_hull"] == [None, 2.0]
    assert result["ianea_over_hull_median"] == [None, 2.0]
    np.testing.assert_array_equal(ratio(np.ones(2), np.array([0.0, 4.0])), [np.nan, 0.25])


def test_the_whole_benchmark_is_json_and_shows_its_progress(arm: Robot) -> None:
    shown: list[str] = []
    result = benchmark(
        [arm],
        repeat=1,
        sizes=(2, 16, 32),
        states=20,
        duration=0.05,
        progress=lambda what, fraction: shown.append(f"{what} {fraction:.2f}"),
    )
    figures = result.to_dict()
    assert json.loads(json.dumps(figures, allow_nan=False)) == figures
    (robot,) = figures["robots"]
    assert [item["bound"] for item in robot["times"]] == ["hull", "ianea"]
    assert [item["where"] for item in robot["tightness"]] == [
        "20 states of the trajectory",
        "20 random states, seed 0",
    ]
    for item in robot["tightness"]:
        np.testing.assert_allclose(item["hull_over_found"], 1.0, atol=1e-6)
        np.testing.assert_allclose(item["width_found"], item["width_hull"], rtol=1e-6)
    assert [item["joints"] for item in figures["growth"]] == [[2, 16, 32]] * 2
    assert figures["growth"][0]["exponent"] is not None
    assert not figures["interrupted"]
    assert shown[-1] == "growth, ianea 1.00"
    assert "chain-3: tightness 1.00" in shown


@pytest.mark.parametrize(
    ("when", "robots", "times", "sizes"),
    [
        ("chain-3: simulation", 1, 0, None),
        ("chain-3: replay", 1, 1, None),
        ("growth, hull", 1, 2, [2]),
    ],
)
def test_ctrl_c_keeps_what_was_measured(
    arm: Robot, when: str, robots: int, times: int, sizes: list[int] | None
) -> None:
    def interrupt(what: str, fraction: float) -> None:
        if what == when:
            raise KeyboardInterrupt

    result = benchmark([arm], repeat=1, sizes=(2, 3), states=5, duration=0.05, progress=interrupt)
    assert result.interrupted
    assert len(result.robots) == robots
    assert len(result.robots[0].times) == times
    assert [item.joints for item in result.growth] == ([] if sizes is None else [sizes])
    assert json.dumps(result.to_dict(), allow_nan=False)


@pytest.mark.parametrize("name", ["repeat", "states"])
def test_a_count_below_one_is_refused(arm: Robot, name: str) -> None:
    with pytest.raises(ValueRangeError, match=f"{name}: 0; must be at least 1"):
        benchmark([arm], **{name: 0})  # type: ignore[arg-type]


def test_a_chain_without_joints_is_refused() -> None:
    with pytest.raises(ValueRangeError, match="n: 0; a chain has at least 1 joint"):
        synthetic_chain(0)


def test_every_body_of_a_synthetic_chain_is_uncertain_and_physical() -> None:
    robot = synthetic_chain(40)
    assert (robot.lower.mass < robot.upper.mass).all()
    assert (robot.lower.inertia[:, 0, 0] < robot.upper.inertia[:, 0, 0]).all()
    sample = robot.sample_parameters(1)
    assert (np.linalg.eigvalsh(sample.inertia) > 0.0).all()
    mass_matrix = mr.mass_matrix(robot, np.linspace(-1.0, 1.0, 40))
    assert (np.linalg.eigvalsh(mass_matrix) > 0.0).all()


def test_plain_makes_json_of_arrays_and_none_of_what_is_not_finite() -> None:
    value = {"a": np.array([1.0, np.inf]), "b": (np.int64(3), np.bool_(True)), "c": float("nan")}
    assert plain(value) == {"a": [1.0, None], "b": [3, True], "c": None}


def test_each_width_stands_under_its_own_header(capsys: pytest.CaptureFixture[str]) -> None:
    """Two states, worked out by hand: means 1.6, 2 and 6, ratios 2/1.6 and 6/2, each 2 and 10/3."""
    widths = Tightness(
        where="somewhere",
        width_hull=np.array([[1.0], [3.0]]),
        width_ianea=np.array([[2.0], [10.0]]),
        width_found=np.array([[1.0], [2.2]]),
    )
    entry = {
        "robot": "arm",
        "joints": ["elbow"],
        "times": [],
        "laws": {},
        "tightness": [widths.to_dict()],
    }
    print_benchmark({"robots": [entry], "growth": []})
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    header = next(line for line in lines if line[:1] == ["joint"])
    row = next(line for line in lines if line[:1] == ["elbow"])
    assert dict(zip(header, row, strict=True)) == {
        "joint": "elbow",
        "found": "1.6",
        "hull": "2",
        "ianea": "6",
        "hull/found": "1.25",
        "ianea/hull": "3",
        "median": "2.667",
    }
