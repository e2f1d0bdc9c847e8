"""Link frames of the kernel: products of before, joint and after."""

from __future__ import annotations

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import ValueRangeError
from modrobust.reference import link_frames
from support.random_robots import random_robot


@pytest.mark.parametrize("tree", [False, True])
def test_link_frames_are_products_of_the_transforms(tree: bool) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        robot = random_robot(rng, 7, tree=tree)
        q = rng.uniform(-4, 4, 7)
        frames = mr.forward_kinematics(robot, q)
        np.testing.assert_allclose(frames, link_frames(robot, q), rtol=0, atol=1e-13)


def test_an_angle_beyond_the_kernels_sine_is_refused() -> None:
    robot = random_robot(np.random.default_rng(2), types="rp")
    mr.forward_kinematics(robot, [1e5, 1e6])
    with pytest.raises(ValueRangeError):
        mr.forward_kinematics(robot, [-1.1e5, 0.0])
