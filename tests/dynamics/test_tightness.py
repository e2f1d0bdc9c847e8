"""The hull against the exact range: how wide at most, how wide on average, and never narrower."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import flint
import numpy as np
import pytest

import modrobust as mr
from dynamics.exact_hull import exact_bounds
from modrobust.assembly.modules.catalogue import builtin_robots
from support.exact_range import BALLS, bits, exact_range, largest
from support.random_robots import random_robot, random_state
from support.tightness_population import THRESHOLD, Case, boxed, cases, summary

WIDEST = 1.02  # of the true range, at any joint
MEAN = 1.001
# Ratios at true widths of 1e-9 of the largest torque, where the slack for rounding shows: slow arms
# of up to 12 joints, and any of up to 30 joints turning at 10 rad/s
SLACK_SHOWS_SLOW = 1.05
SLACK_SHOWS = 4.0
# Most parameters exact: the slack does not show above this, of the largest torque
FEW_UNKNOWN = 1e-7
UNCERTAINTIES = [0.01, 0.05, 0.1, 0.5]
LONG_DOUBLE = 1e-17  # of the largest torque, what the reference itself may be wrong by


@pytest.mark.parametrize("uncertainty", UNCERTAINTIES)
def test_hull_is_as_wide_as_the_true_range(uncertainty: float) -> None:
    found = summary([*cases(uncertainty, 120, 1), *cases(uncertainty, 3, 2, joints=30)])
    assert len(found.ratios) > 1500
    assert found.ratios.max() <= WIDEST, found.worst
    assert found.ratios.mean() <= MEAN
    assert found.short <= LONG_DOUBLE


@pytest.mark.parametrize("uncertainty", UNCERTAINTIES)
def test_hull_is_as_wide_as_the_true_range_where_few_parameters_are_unknown(
    uncertainty: float,
) -> None:
    many = list(cases(uncertainty, 60, 9, share=0.05))
    found = summary(many, narrowest=FEW_UNKNOWN)
    assert len(found.ratios) > 500
    assert found.ratios.max() <= WIDEST, found.worst
    found = summary(many)
    assert found.ratios.mean() <= MEAN
    assert found.short <= LONG_DOUBLE


def test_hull_is_as_wide_as_the_true_range_where_next_to_nothing_is_unknown() -> None:
    # true widths about 1e-9 of the largest torque, where the slack for rounding weighs most
    many = [case for u in (1e-9, 3e-9, 1e-8) for case in cases(u, 60, 3)]
    many += cases(1e-8, 5, 4, joints=30)
    slow = summary([c for c in many if c.rate < 1.0 and c.robot.n <= 12], widest=10 * THRESHOLD)
    assert len(slow.ratios) > 200
    assert slow.ratios.max() <= SLACK_SHOWS_SLOW, slow.worst
    found = summary(many, widest=10 * THRESHOLD)
    assert len(found.ratios) > 700
    assert found.ratios.max() <= SLACK_SHOWS, found.worst
    assert found.short <= LONG_DOUBLE


@pytest.mark.parametrize("name", builtin_robots())
def test_hull_of_the_built_in_robots_is_as_wide_as_the_true_range(name: str) -> None:
    robot = mr.load_robot(name)
    if robot.j != robot.n:
        pytest.skip("mimic joints: the hull is exact per joint of the tree only")
    rng = np.random.default_rng(5)
    many = [
        Case(robot, random_state(rng, robot.n, rate), drives, f"{name}, {drives=}")
        for rate in (0.0, 1.0)
        for drives in (False, True)
    ]
    found = summary(many)
    assert len(found.ratios) > 0
    assert found.ratios.max() <= WIDEST, found.worst
    assert found.ratios.mean() <= MEAN
    assert found.short <= LONG_DOUBLE


@pytest.mark.parametrize("uncertainty", [1e-9, 0.01, 0.5])
def test_the_reference_is_that_of_three_hundred_bits(uncertainty: float) -> None:
    for case in cases(uncertainty, 8, 6):
        lo, hi = exact_range(case.robot, case.state, case.drives)
        with bits(300):
            sure_lo, sure_hi = exact_range(case.robot, case.state, case.drives, BALLS)
            assert max(float(x.rad()) for x in (*sure_lo, *sure_hi)) < 1e-75
            wrong = [_distance(x, y) for x, y in zip((*lo, *hi), (*sure_lo, *sure_hi), strict=True)]
        assert max(wrong) <= LONG_DOUBLE * max(np.abs(lo).max(), np.abs(hi).max())


def _distance(long: Any, ball: Any) -> float:
    head = float(long)  # a long double is the exact sum of two doubles
    return abs(float(ball - flint.arb(head) - flint.arb(float(long - np.longdouble(head)))))


def test_the_reference_agrees_with_the_transcription_of_the_paper() -> None:
    found = list(cases(0.2, 4, 7))
    assert any(case.robot.framed.any() for case in found)
    for case in found:
        lo, hi = exact_range(case.robot, case.state, case.drives)
        expected = exact_bounds(case.robot, *case.state, drives=case.drives)
        size = max(np.abs(lo).max(), np.abs(hi).max())
        np.testing.assert_allclose(np.stack([lo, hi]), np.stack(expected), atol=1e-14 * size)


def test_the_reference_finds_a_maximum_inside_on_a_face_and_at_a_corner() -> None:
    A = np.array([-np.eye(3), np.diag([1.0, -1.0, -1.0]), np.eye(3)], dtype=np.longdouble)
    g = np.array([[0.2, 0.4, 0.6], [0.0, 0.4, 0.6], [0.0, 0.0, 0.0]], dtype=np.longdouble)
    one = np.ones((3, 3), dtype=np.longdouble)
    # 0.01 + 0.04 + 0.09; an end of x and 0.04 + 0.09; three ends
    np.testing.assert_allclose(largest(A, g, -one, one).astype(float), [0.14, 1.13, 3.0])


def test_a_narrowed_and_a_widened_hull_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(8)
    robot = boxed(random_robot(rng, 4, width="exact"), 0.1, rng)
    case = Case(robot, random_state(rng, 4), False, "")
    centre = replace(case, robot=replace(robot, lower=robot.nominal, upper=robot.nominal))
    assert summary([centre]).ratios.size == 0  # nothing unknown, nothing judged
    honest = mr.inverse_dynamics_bounds

    def stretched(factor: float) -> Any:
        def bounds(*arguments: Any, **named: Any) -> Any:
            lo, hi = honest(*arguments, **named)
            middle, half = (lo + hi) / 2, factor * (hi - lo) / 2
            return middle - half, middle + half

        return bounds

    monkeypatch.setattr(mr, "inverse_dynamics_bounds", stretched(1.03))
    assert summary([case]).ratios.min() > WIDEST
    monkeypatch.setattr(mr, "inverse_dynamics_bounds", stretched(1 - 1e-6))
    assert summary([case]).short > 1e-9
