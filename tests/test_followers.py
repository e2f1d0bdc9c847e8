"""Joints that follow another, docs/theory/equations.md (15)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.robot import Bounded, Followers, Robot
from random_robots import random_robot

MULTIPLIER = np.array([-0.5, 2.0])
OFFSET = np.array([0.3, -0.1])
LEADERS = np.array([1, 0], np.int32)


@pytest.fixture(params=range(4))
def pair(request: Any) -> tuple[Robot, Robot]:
    """A tree of six free joints, and the same robot with the last two joints following."""
    rng = np.random.default_rng(request.param)
    whole = random_robot(rng, 6, tree=True)
    bound = Bounded(*(getattr(whole.disturbance, name)[:4] for name in ("nominal", "lo", "hi")))
    tied = replace(
        whole,
        joint_names=whole.joint_names[:4],
        position_limits=whole.position_limits[:4],
        velocity_limits=whole.velocity_limits[:4],
        effort_limits=whole.effort_limits[:4],
        acceleration_limits=whole.acceleration_limits[:4],
        disturbance=bound,
        followers=Followers(whole.joint_names[4:], LEADERS, MULTIPLIER, OFFSET),
    )
    return whole, tied


G = np.vstack([np.eye(4), np.zeros((2, 4))])
G[4, 1], G[5, 0] = MULTIPLIER


def states(seed: int = 1) -> list[tuple[list[np.ndarray], list[np.ndarray]]]:
    """The free joints' vectors and those of all joints."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(20):
        free = [rng.normal(size=4) for _ in range(4)]
        full = [G @ x for x in free]
        full[0][4:] += OFFSET
        found.append((free, full))
    return found


def test_torques_are_those_of_the_whole_tree_led_by_the_free_joints(pair: Any) -> None:
    whole, tied = pair
    for free, full in states():
        expected = G.T @ mr.inverse_dynamics(whole, *full)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(mr.inverse_dynamics(tied, *free), expected, atol=1e-12 * scale)


def test_the_mass_matrix_is_projected(pair: Any) -> None:
    whole, tied = pair
    for free, full in states():
        expected = G.T @ mr.mass_matrix(whole, full[0]) @ G
        np.testing.assert_allclose(mr.mass_matrix(tied, free[0]), expected, rtol=1e-12, atol=1e-12)


def test_forward_dynamics_inverts_inverse_dynamics(pair: Any) -> None:
    _, tied = pair
    for (q, dq, _, ddq), _ in states():
        tau = mr.inverse_dynamics(tied, q, dq, dq, ddq)
        np.testing.assert_allclose(mr.forward_dynamics(tied, q, dq, tau), ddq, atol=1e-8)


@pytest.mark.parametrize("method", ["hull", "ianea"])
def test_bounds_hold_every_sample_and_corner(pair: Any, method: str) -> None:
    _, tied = pair
    rng = np.random.default_rng(5)
    for free, _ in states(2):
        lo, hi = mr.inverse_dynamics_bounds(tied, *free, method=method)
        margin = 1e-12 * np.abs([lo, hi]).max()
        for _ in range(20):
            for point in (tied.sample_parameters(rng), tied.corner_parameters(rng)):
                tau = mr.inverse_dynamics(tied, *free, parameters=point)
                assert (lo - margin <= tau).all()
                assert (tau <= hi + margin).all()


def test_frames_of_followers_move_with_their_leaders(pair: Any) -> None:
    whole, tied = pair
    for free, full in states(3):
        np.testing.assert_allclose(
            mr.forward_kinematics(tied, free[0]), mr.forward_kinematics(whole, full[0]), atol=1e-12
        )


def test_the_resolved_robot_names_leader_multiplier_and_offset(pair: Any) -> None:
    _, tied = pair
    joints = tied.to_dict()["joints"]
    assert [joint.get("mimic") for joint in joints] == [
        *[None] * 4,
        {"joint": 1, "multiplier": -0.5, "offset": 0.3},
        {"joint": 0, "multiplier": 2.0, "offset": -0.1},
    ]
    assert tied.to_dict()["dh"] is None
