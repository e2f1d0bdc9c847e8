"""M(q): symmetry, positive definiteness, kinetic energy, hand-worked cases."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Parameters, Robot
from modrobust.reference import link_frames, mass_matrix
from support.random_robots import about_com, random_robot, random_state

SHAPES: list[dict[str, Any]] = [
    {"simple": True, "n": 6},
    {"simple": False, "types": "prprpr"},
    {"simple": False, "n": 12},
    {"simple": False, "n": 10, "tree": True},
]


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("drives", [False, True])
def test_mass_matrix_is_symmetric_and_positive_definite(
    shape: dict[str, Any], drives: bool
) -> None:
    rng = np.random.default_rng(1)
    for _ in range(10):
        robot = random_robot(rng, **shape)
        M = mr.mass_matrix(robot, random_state(rng, robot.n)[0], drives=drives)
        np.testing.assert_array_equal(M, M.T)
        assert np.linalg.eigvalsh(M)[0] > 0


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_mass_matrix_has_the_columns_of_the_inverse_dynamics(shape: dict[str, Any]) -> None:
    rng = np.random.default_rng(2)
    for _ in range(5):
        robot = random_robot(rng, **shape)
        n = robot.n
        q, zero = random_state(rng, n)[0], np.zeros(n)
        g = mr.inverse_dynamics(robot, q, zero, zero, zero)
        columns = [mr.inverse_dynamics(robot, q, zero, zero, e) - g for e in np.eye(n)]
        M = mr.mass_matrix(robot, q)
        np.testing.assert_allclose(M, np.stack(columns, 1), rtol=0, atol=1e-12 * np.abs(M).max())
        rigid = mr.mass_matrix(robot, q, drives=False)
        expected = mass_matrix(robot, robot.nominal, q)
        np.testing.assert_allclose(rigid, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_half_of_the_quadratic_form_is_the_kinetic_energy(shape: dict[str, Any]) -> None:
    # velocities of the bodies by a complex step through the frames, with no recursion at all
    rng = np.random.default_rng(3)
    robot = random_robot(rng, **shape)
    q, dq, _, _ = random_state(rng, robot.n)
    h = 1e-30
    frames = link_frames(robot, q + 1j * h * dq)
    energy = 0.0
    for b, i in enumerate(robot.body_joints):
        if i < 0:
            continue
        T = frames[i] @ robot.placement[b]
        p = about_com(robot).nominal
        velocity = (T[:3, :3] @ p.com[b] + T[:3, 3]).imag / h
        W = T.real[:3, :3].T @ (T[:3, :3].imag / h)  # [omega]x in body axes
        omega = np.array([W[2, 1], W[0, 2], W[1, 0]])
        energy += p.mass[b] * velocity @ velocity / 2 + omega @ p.inertia[b] @ omega / 2
    M = mr.mass_matrix(robot, q, drives=False)
    assert dq @ M @ dq / 2 == pytest.approx(energy, rel=1e-12)


def test_the_reflected_rotor_inertia_sits_on_the_diagonal() -> None:
    rng = np.random.default_rng(4)
    robot = random_robot(rng, types="rpr")
    q = random_state(rng, 3)[0]
    added = mr.mass_matrix(robot, q) - mr.mass_matrix(robot, q, drives=False)
    expected = np.diag(robot.gear_ratio**2 * robot.nominal.rotor_inertia)
    np.testing.assert_allclose(added, expected, rtol=0, atol=1e-13)


def test_gravity_does_not_enter_the_mass_matrix() -> None:
    rng = np.random.default_rng(5)
    robot = random_robot(rng, 5)
    q = random_state(rng, 5)[0]
    elsewhere = replace(robot, gravity=np.array([1e3, 0.0, 0.0]))
    np.testing.assert_array_equal(mr.mass_matrix(elsewhere, q), mr.mass_matrix(robot, q))


def split_in_two(robot: Robot, rng: np.random.Generator) -> Robot:
    """Each body as two of 30 and 70 % of its mass, apart but with the same total tensor."""
    robot = about_com(robot)
    p = robot.nominal
    apart = rng.uniform(-0.03, 0.03, p.com.shape)
    com = np.concatenate([p.com + 0.7 * apart, p.com - 0.3 * apart])
    mass = np.concatenate([0.3 * p.mass, 0.7 * p.mass])
    squares = np.einsum("bi,bi->b", apart, apart)[:, None, None] * np.eye(3)
    steiner = (0.21 * p.mass)[:, None, None] * (squares - np.einsum("bi,bj->bij", apart, apart))
    inertia = np.concatenate([0.5 * (p.inertia - steiner)] * 2)
    point = Parameters(
        mass=mass,
        com=com,
        inertia=inertia,
        rotor_inertia=p.rotor_inertia,
        viscous=p.viscous,
        coulomb=p.coulomb,
    )
    return replace(
        robot,
        body_names=robot.body_names + tuple(f"{name}-2" for name in robot.body_names),
        body_joints=np.tile(robot.body_joints, 2),
        placement=np.tile(robot.placement, (2, 1, 1)),
        nominal=point,
        lower=point,
        upper=point,
        inertia_about=(),
    )


def test_splitting_a_body_in_two_leaves_the_mass_matrix_and_the_torque_unchanged() -> None:
    rng = np.random.default_rng(6)
    robot = random_robot(rng, 6)
    other = split_in_two(robot, rng)
    q, dq, _, ddq = random_state(rng, 6)
    M = mr.mass_matrix(robot, q)
    np.testing.assert_allclose(mr.mass_matrix(other, q), M, rtol=0, atol=1e-13 * M.max())
    # with dq_a = dq only: the factorisation C of Algorithm 1 depends on how mass is split
    tau = mr.inverse_dynamics(robot, q, dq, dq, ddq)
    again = mr.inverse_dynamics(other, q, dq, dq, ddq)
    np.testing.assert_allclose(again, tau, rtol=0, atol=1e-13 * np.abs(tau).max())
