"""The slack for rounding is what (26) says, worked out by hand for one joint with one body."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modrobust.model import Robot
from support.random_robots import point_robot
from support.rounding import slack

U = 2.0**-53
G = 9.81  # [m/s^2]
MASS, COM = 2.0, 0.5  # [kg], [m] from the link frame
SECOND_ORDER = 1e-4  # the slack may hold this much more
ZERO = np.zeros(1)


def swivel(lever: float) -> Robot:
    """A vertical axis, a lever [m] and a quarter turn about x to the link with the body."""
    after = np.array([[1.0, 0, 0, lever], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    robot = point_robot(
        "r", after=[after], mass=[MASS], com=[[COM, 0, 0]], inertia=[np.zeros((3, 3))]
    )
    return replace(robot, base=np.eye(4), before=np.eye(4)[None], placement=np.eye(4)[None])


@pytest.mark.parametrize("ddq_a", [0.0, 3.0])
@pytest.mark.parametrize("lever", [0.3, 7.0])
@pytest.mark.parametrize("unknown", ["nothing", "mass", "com", "inertia"])
def test_slack_is_what_26_says(unknown: str, lever: float, ddq_a: float) -> None:
    """Else a term of (26) could shrink many times unseen: real errors are a few per cent of it."""
    spread: dict[str, Any] = {
        "mass": 0.4,
        "com": np.array([0.2, 0, 0]),
        "inertia": 0.1 * np.eye(3),
    }
    dm = 0.4 * (unknown == "mass")
    r = 0.2 * (unknown == "com")
    dI = 0.1 * np.sqrt(3) * (unknown == "inertia")
    robot = swivel(lever)
    if unknown != "nothing":
        nominal = getattr(robot.nominal, unknown)
        robot = replace(
            robot,
            lower=replace(robot.nominal, **{unknown: nominal - spread[unknown]}),
            upper=replace(robot.nominal, **{unknown: nominal + spread[unknown]}),
        )
    K, x = ddq_a, lever + COM
    A = np.hypot(G, ddq_a * lever) + G
    N = MASS * (A + K * x) * x
    change = dm * (A + K * x) * x + MASS * (A + K * r + 2 * K * x) * r + K * dI
    D = b = j = 1
    expected = U * ((66 * D + 90 + b + 2 * j) * N + (183 * D + 500 + b + 2 * j) * change)
    got = slack(robot, ZERO, ZERO, ZERO, np.array([ddq_a]), drives=False)[0]
    assert expected <= got <= expected * (1 + SECOND_ORDER)


@pytest.mark.parametrize("unknown", ["nothing", "mass", "com", "inertia"])
def test_slack_of_a_tensor_about_the_frame(unknown: str) -> None:
    """The tensor's size is |J| + 3/2 m c^2, because it is moved to the COM in doubles."""
    spread: dict[str, Any] = {
        "mass": 0.4,
        "com": np.array([0.2, 0, 0]),
        "inertia": 0.1 * np.eye(3),
    }
    dm = 0.4 * (unknown == "mass")
    r = 0.2 * (unknown == "com")
    dJ = 0.1 * np.sqrt(3) * (unknown == "inertia")
    lever, K = 0.3, 3.0
    robot = replace(swivel(lever), inertia_about=("frame",))
    point = replace(robot.nominal, inertia=0.7 * np.eye(3)[None])
    lower = upper = point
    if unknown != "nothing":
        lower, upper = (
            replace(point, **{unknown: getattr(point, unknown) + sign * spread[unknown]})
            for sign in (-1, 1)
        )
    robot = replace(robot, nominal=point, lower=lower, upper=upper)
    x = lever + COM
    A = np.hypot(G, K * lever) + G
    N = MASS * (A + K * x) * x + K * (0.7 * np.sqrt(3) + 1.5 * MASS * COM**2)
    change = dm * (A + K * x) * x + MASS * (A + K * r + 2 * K * x) * r + K * dJ
    expected = U * ((66 + 90 + 1 + 2) * N + (183 + 500 + 1 + 2) * change)
    got = slack(robot, ZERO, ZERO, ZERO, np.array([K]), drives=False)[0]
    assert expected <= got <= expected * (1 + SECOND_ORDER)


def test_the_drives_slack() -> None:
    """Else the drive's 32 u could be left out: the slack of heavy bodies hides it elsewhere."""
    robot = point_robot(
        "r", after=[np.eye(4)], mass=[1e-30], com=[[0, 0, 0]], inertia=[np.zeros((3, 3))]
    )
    viscous, coulomb, rotor, gear = 3.0, 2.0, 0.1, 7.0
    point = replace(
        robot.nominal,
        viscous=np.array([viscous]),
        coulomb=np.array([coulomb]),
        rotor_inertia=np.array([rotor]),
    )
    robot = replace(
        robot,
        gravity=np.zeros(3),
        gear_ratio=np.array([gear]),
        nominal=point,
        lower=point,
        upper=point,
    )
    dq, ddq_a = 1.5, 2.0
    expected = 32 * U * (viscous * dq + coulomb + gear**2 * rotor * ddq_a)
    got = slack(robot, ZERO, np.array([dq]), ZERO, np.array([ddq_a]))[0]
    assert expected * (1 - 1e-12) <= got <= expected * (1 + SECOND_ORDER)
