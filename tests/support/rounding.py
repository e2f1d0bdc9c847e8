"""How much wider than the real bounds the computed ones may be, (26) and (27); for tests."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields, replace
from typing import Any

import numpy as np

import modrobust as mr
from modrobust import _kernel
from modrobust.model import Parameters, Robot
from support.states import State, doubles, state_of

ULP = 2.0**-52  # relative spacing of doubles, at most
UNIT = 2.0**-53  # relative error of one rounding
TINY = 1e-250  # what underflow may add


def as_long(state: Iterable[Any]) -> State:
    """The same state in long double, so that what follows from it is as good as exact."""
    return state_of(np.asarray(x, dtype=np.longdouble) for x in state)


def point(robot: Robot) -> Robot:
    """The robot with every parameter exact."""
    return replace(robot, lower=robot.nominal, upper=robot.nominal)


def depth(robot: Robot) -> int:
    """Joints on the longest way from the base."""
    levels: list[int] = []
    for parent in robot.parents:
        levels.append(1 if parent < 0 else levels[parent] + 1)
    return max(levels)


def largest(robot: Robot) -> Parameters:
    """What (27) takes for the sizes: the larger end of every entry, and four radii of vectors."""
    sides = {}
    for field in fields(Parameters):
        lo, hi = getattr(robot.lower, field.name), getattr(robot.upper, field.name)
        sides[field.name] = np.where(np.abs(lo) > np.abs(hi), lo, hi)
        if field.name in ("com", "inertia"):
            sides[field.name] += 2.0 * np.sign(sides[field.name]) * (hi - lo)
    return Parameters(**sides)


def slack(robot: Robot, *state: *State, drives: bool = True) -> Any:
    """What rounding may move an end of the hull by, (n,); it is added to that end once more."""
    box = robot.nominal.packed, robot.lower.packed, robot.upper.packed
    return _kernel.bounds_slack(robot.model, *box, *doubles(state), drives)


def torque_error(robot: Robot, *state: *State, parameters: Any = None, drives: bool = True) -> Any:
    """A bound of the rounding error of `inverse_dynamics`, (n,)."""
    packed = (robot.nominal if parameters is None else parameters).packed
    return _kernel.inverse_dynamics_rounding(robot.model, packed, *doubles(state), drives)[1]


def excess_allowed(robot: Robot, *state: *State, bound: str = "hull", drives: bool = True) -> Any:
    """The most that an end of the bounds may lie outside the real one, (n,).

    hull: the slack, and a tenth of it for rounding that happened; 1/1000 was seen. ianea: rounding
    makes any robot as wide as the one whose parameters are exact and as large as the box allows,
    give or take 20 % (17 % was seen at 12 joints, where wide boxes are turned); half of that width
    is at either end. Radii grow by their own rounding on top, (27). Drives add a handful of
    roundings, outward one by one.
    """
    ends = mr.inverse_dynamics_bounds(robot, *state, bound=bound, drives=drives)
    roundings = 8 * ULP * np.abs(ends).max(axis=0) + TINY
    if bound == "hull":
        return 1.1 * slack(robot, *state, drives=drives) + roundings
    most = largest(robot)
    large = replace(robot, nominal=most, lower=most, upper=most)
    lo, hi = mr.inverse_dynamics_bounds(large, *state, bound=bound, drives=False)
    radii = (16 * depth(robot) + 96 + 4 * (robot.b + robot.j)) * UNIT
    return 1.2 * (hi - lo) / 2 + radii * (ends[1] - ends[0]) / 2 + roundings


def assert_encloses(bounds: Any, real: Any, allowed: Any) -> None:
    """Each computed end lies outside the real one, by at most what is allowed."""
    (lo, hi), (real_lo, real_hi) = bounds, real
    for outside in (real_lo - lo, hi - real_hi):
        assert np.all(outside >= 0.0), outside
        assert np.all(outside <= allowed), outside / allowed
