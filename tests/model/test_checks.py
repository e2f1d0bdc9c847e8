"""A Robot made by hand is checked like one from a file."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import MimicJoints, Robot, synthetic_chain


def mirrored(robot: Robot) -> Any:
    after = robot.after.copy()
    after[1, :3, :3] *= -1
    return after


@pytest.mark.parametrize(
    ("change", "kind", "message"),
    [
        (
            lambda r: {"lower": r.upper},
            ValueRangeError,
            "mass[0]: nominal 1.0 is outside its bounds [1.1, 1.1]; widen them or correct it",
        ),
        (
            lambda r: {"lower": replace(r.lower, mass=-r.lower.mass)},
            ValueRangeError,
            "mass: the lower bound -0.9 is negative",
        ),
        (
            lambda r: {"joint_types": ("revolute", "revolut")},
            ValueRangeError,
            'joint_types[1] is "revolut"; did you mean "revolute"? known: revolute, continuous, '
            "prismatic",
        ),
        (
            lambda r: {"after": mirrored(r)},
            ValueRangeError,
            "after[1] is not a rigid transform; its rotation must be orthonormal and "
            "right-handed, its last row 0 0 0 1",
        ),
        (
            lambda r: {"parents": np.array([-1, 1], np.int32)},
            ValueRangeError,
            "parents[1] is 1; it must be a joint before its child, or -1, the base",
        ),
        (
            lambda r: {"velocity_limits": np.ones(3)},
            ShapeError,
            'velocity_limits: expected shape (2,), got (3,); robot "chain-2" has 2 free joints, '
            "2 joints and 2 bodies",
        ),
        (
            lambda r: {"mimic": MimicJoints(("x",), np.array([0]), np.ones(1), np.zeros(1))},
            ShapeError,
            'mimic.leaders: expected shape (0,), got (1,); robot "chain-2" has 2 free joints, '
            "2 joints and 2 bodies",
        ),
    ],
)
def test_an_impossible_robot_is_refused(change: Any, kind: type, message: str) -> None:
    robot = synthetic_chain(2, uncertainty=0.1)
    with pytest.raises(kind) as caught:
        replace(robot, **change(robot))
    assert str(caught.value) == message
