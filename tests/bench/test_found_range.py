"""The range found by search: attained, inside the true one, and near all of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.bench.benchmark import random_tightness, trajectory_tightness
from modrobust.bench.found_range import found_range, probe_count
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import Bounded, Robot, synthetic_chain
from support.exact_range import exact_range
from support.random_robots import random_robot, random_state, tied
from support.states import State
from support.tightness_population import boxed


def wide(n: int, seed: int, **shape: Any) -> Robot:
    rng = np.random.default_rng(seed)
    return boxed(random_robot(rng, n, width="exact", **shape), 0.3, rng, share=0.7)


def states(n: int, count: int, seed: int = 0) -> State:
    """Moving ones: about standstill true Coulomb friction may do what the smooth one does not."""
    rng = np.random.default_rng(seed)
    rows = [random_state(rng, n, 3.0) for _ in range(count)]
    q, dq, dq_a, ddq_a = (np.array(column) for column in zip(*rows, strict=True))
    return q, np.copysign(np.abs(dq) + 1.0, dq), dq_a, ddq_a


@pytest.mark.parametrize(
    ("n", "shape"), [(1, {}), (4, {"types": "rprp"}), (6, {}), (8, {"tree": True})]
)
def test_the_search_attains_the_true_range(n: int, shape: dict[str, Any]) -> None:
    for seed in range(5):
        robot = wide(n, seed, **shape)
        columns = states(robot.n, 4, seed)
        for drives in (False, True):
            found_lo, found_hi = found_range(robot, *columns, drives=drives)
            for k in range(4):
                lo, hi = exact_range(robot, [x[k] for x in columns], drives)
                size = max(np.abs(lo).max(), np.abs(hi).max())
                assert (found_lo[k] >= lo - 1e-13 * size).all()
                assert (found_hi[k] <= hi + 1e-13 * size).all()
                width = hi - lo + 1e-6 * size
                assert (found_hi[k] - found_lo[k] >= 0.999 * (hi - lo) - 1e-6 * width).all()


def test_the_search_finds_a_maximum_inside_the_box_of_a_centre_of_mass() -> None:
    robot = random_robot(np.random.default_rng(2), types="rrr", simple=True, drives=False)
    robot = replace(
        robot,
        lower=replace(robot.nominal, com=robot.nominal.com - 0.5),
        upper=replace(robot.nominal, com=robot.nominal.com + 0.5),
    )
    columns = states(3, 20)
    found = np.subtract(*found_range(robot, *columns)[::-1])
    for k in range(20):
        lo, hi = exact_range(robot, [x[k] for x in columns], False)
        assert (found[k] >= 0.99 * (hi - lo)).all()


def test_no_point_leaves_the_box_and_exact_parameters_are_left_alone() -> None:
    robot = random_robot(np.random.default_rng(3), 3, width="exact")
    lo, hi = found_range(robot, *states(3, 2))
    np.testing.assert_array_equal(lo, hi)
    assert probe_count(robot) == 1 + 6
    for seed in range(5):
        robot = wide(5, seed)
        columns = states(5, 3, seed)
        for lo, hi, *state in zip(*found_range(robot, *columns), *columns, strict=True):
            bound_lo, bound_hi = mr.inverse_dynamics_bounds(robot, *state)
            assert (bound_lo <= lo).all()
            assert (bound_hi >= hi).all()


def test_mimic_joints_are_searched_together() -> None:
    robot = tied(wide(5, 1), 3, np.random.default_rng(1))
    lo, hi = found_range(robot, *states(3, 3))
    bounds = np.array(
        [mr.inverse_dynamics_bounds(robot, *s) for s in zip(*states(3, 3), strict=True)]
    )
    assert (bounds[:, 0] <= lo).all()
    assert (bounds[:, 1] >= hi).all()
    assert ((hi - lo) >= 0.3 * (bounds[:, 1] - bounds[:, 0])).all()


def test_wrong_states_are_refused() -> None:
    robot = wide(2, 0)
    good = states(2, 3)
    with pytest.raises(ShapeError, match="dq_a"):
        found_range(robot, good[0], good[1], good[2][:2], good[3])
    with pytest.raises(ValueRangeError, match="joint angle"):
        found_range(robot, good[0] + 1e6, *good[1:])


def test_the_disturbance_belongs_to_the_range() -> None:
    robot = synthetic_chain(3)
    one = np.ones(3)
    shaken = replace(robot, disturbance=Bounded(nominal=0 * one, lo=-one, hi=2 * one))
    still, moved = (random_tightness(r, 5, search=True).width_found for r in (robot, shaken))
    assert still is not None
    assert moved is not None
    np.testing.assert_allclose(moved, still + 3.0)


def test_states_of_a_run_are_spread_and_moving() -> None:
    robot = replace(synthetic_chain(2), coulomb_speed=np.full(2, 1e-2))
    run = mr.simulate(robot, duration=0.2, rate=10e3)
    result = trajectory_tightness(run, 7)
    assert result.where == "7 states of the trajectory"
    assert result.width_hull.shape == (7, 2)
    at_rest = replace(run, dq=0 * run.dq)
    assert trajectory_tightness(at_rest, 7).width_hull.shape == (7, 2)
    slow = np.where(np.arange(len(run.t))[:, None] < 5, run.dq + 1.0, 0.0)
    assert trajectory_tightness(replace(run, dq=slow), 7).where == "5 states of the trajectory"
