"""Which mounting angles two connectors allow."""

from __future__ import annotations

import math

import pytest

from modrobust.assembly.modules.connectors import clocking_problem
from modrobust.formats import Connector, Where

HERE = Where("m.yaml", 1)


def connector(clocking: float | None) -> Connector:
    """A connector with its step in degrees."""
    step = None if clocking is None else math.radians(clocking)
    return Connector("t", None, "n", step, HERE)


@pytest.mark.parametrize(
    ("step", "mount"),
    [
        *((30, k) for k in (0, 30, 60, 90, 150, 330, 720, -30, -60, -90, -330)),
        *((60, k) for k in (0, 60, 120, 180, 300, -60, -120, -300)),
        *((90, k) for k in (0, 90, 270, -90, -270)),
        (90, 2070),  # in radians a little less than 23 steps
    ],
)
def test_a_multiple_of_the_step_is_allowed_either_way(step: float, mount: float) -> None:
    for out, into in ((step, None), (None, step), (step, step)):
        assert clocking_problem(connector(out), connector(into), math.radians(mount)) is None


@pytest.mark.parametrize(
    ("step", "mount"),
    [(30, 15), (30, 45), (30, 29.999), (30, -15), (30, -31), (60, 30), (60, 90), (60, -30)],
)
def test_an_angle_between_the_steps_is_not(step: float, mount: float) -> None:
    for side, out, into in (("out", step, None), ("in", None, step)):
        problem = clocking_problem(connector(out), connector(into), math.radians(mount))
        assert problem == (
            f"{mount:g} deg is not a multiple of {step:g} deg, the clocking of the {side} connector"
        )


def test_both_steps_count() -> None:
    out, into = connector(30), connector(60)
    assert clocking_problem(out, into, math.radians(60)) is None
    assert clocking_problem(out, into, math.radians(30)) == (
        "30 deg is not a multiple of 60 deg, the clocking of the in connector"
    )


def test_without_a_step_any_angle_is_allowed() -> None:
    assert clocking_problem(connector(None), connector(None), 0.123) is None
