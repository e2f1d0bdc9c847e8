"""Without the care for rounding, containment fails: so these tests can see it missing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Robot
from modrobust.reference import box, newton_euler
from support.containment.containment_cases import run_seed
from support.containment.kernel_answers import Bound, Query, bounds_slack
from support.random_robots import steiner

SEEDS = range(40)


def without_slack(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
    """The hulls without what they hold for rounding."""
    slack = {drives: bounds_slack(robot, query, drives) for drives in (True, False)}
    return [
        replace(bound, lo=bound.lo + slack[bound.drives], hi=bound.hi - slack[bound.drives])
        for bound in bounds
        if "hull" in bound.name
    ]


def ianea_in_plain_doubles(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
    """Algorithm 1 as transcribed, rounded to nearest."""
    if robot.j > robot.n:
        return []
    u = newton_euler(robot, box(robot), *query.vectors(), drives=False)
    return [
        replace(bound, lo=u.lo, hi=u.hi)
        for bound in bounds
        if bound.name == "torque ianea, drives False"
    ]


def plainly_subtracted(keep: str) -> Callable[[Robot, Query, list[Bound]], list[Bound]]:
    """(12) from the guaranteed bounds of the torque, u0 and [d] subtracted to nearest."""

    def change(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
        torque = {bound.name: bound for bound in bounds}.get(f"torque {keep}, drives True")
        if torque is None:
            return []
        d = robot.disturbance
        return [
            replace(
                bound,
                lo=torque.lo - bound.nominal - d.hi,
                hi=torque.hi - bound.nominal - d.lo,
            )
            for bound in bounds
            if bound.name == f"perturbation {keep}"
        ]

    return change


def nominal_without_slack(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
    """(12) from hulls without slack, u0 subtracted to nearest, [d] left to the exact side."""
    plain = {b.name: b for b in without_slack(robot, query, bounds)}
    torque = plain.get("torque hull, drives True")
    if torque is None or any(np.any(x) for x in (robot.disturbance.lo, robot.disturbance.hi)):
        return []
    nominal = plain["perturbation hull"].nominal
    return [replace(plain["perturbation hull"], lo=torque.lo - nominal, hi=torque.hi - nominal)]


def moved_to_com(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
    """Hulls of tensors about the frame, moved to the COM with the nominal mass and COM alone."""
    if not robot.framed.any():
        return []
    p = robot.nominal
    shift = robot.framed[:, None, None] * steiner(p.mass, p.com)
    points = {
        name: replace(getattr(robot, name), inertia=getattr(robot, name).inertia - shift)
        for name in ("lower", "nominal", "upper")
    }
    moved = replace(robot, inertia_about=(), **points)
    lo, hi = mr.inverse_dynamics_bounds(moved, *query.vectors(), drives=False)
    return [
        replace(bound, lo=lo, hi=hi)
        for bound in bounds
        if bound.name == "torque hull, drives False"
    ]


def test_a_tensor_moved_to_the_com_at_nominal_is_seen() -> None:
    with np.errstate(all="ignore"):
        assert any(run_seed(seed, moved_to_com).violations for seed in SEEDS)


@pytest.mark.parametrize(
    "change",
    [
        without_slack,
        ianea_in_plain_doubles,
        plainly_subtracted("hull"),
        plainly_subtracted("ianea"),
        nominal_without_slack,
    ],
    ids=[
        "hull without slack",
        "ianea to nearest",
        "u0 and d subtracted to nearest from the hull",
        "u0 and d subtracted to nearest from ianea",
        "u0 subtracted to nearest",
    ],
)
def test_rounding_left_out_is_seen(change: Any) -> None:
    with np.errstate(all="ignore"):
        assert any(run_seed(seed, change).violations for seed in SEEDS)


@pytest.mark.parametrize(("side", "other"), [("lo", "hi"), ("hi", "lo")])
def test_each_end_is_judged(side: str, other: str) -> None:
    """Else a comparison of lower ends alone would see all that is left out above, and pass."""

    def change(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
        return [
            replace(bound, **{side: getattr(bound, other)})
            for bound in bounds
            if bound.name == "torque hull, drives False"
        ]

    assert any(run_seed(seed, change).violations for seed in range(5))


def test_bounds_a_millionth_of_the_slack_short_are_not_seen() -> None:
    """The other way round: what is seen is rounding, no error of the comparison."""

    def nearly(robot: Robot, query: Query, bounds: list[Bound]) -> list[Bound]:
        slack = bounds_slack(robot, query, True)
        return [
            replace(bound, lo=bound.lo + 1e-6 * slack, hi=bound.hi - 1e-6 * slack)
            for bound in bounds
            if bound.name == "torque hull, drives True"
        ]

    assert not any(run_seed(seed, nearly).violations for seed in range(8))
