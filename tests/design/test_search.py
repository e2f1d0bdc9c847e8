"""Directed steps: how bodies move, extreme points of the box, eigenvalues, accelerations."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import modrobust as mr
from modrobust.design import central_parameters, light_parameters
from modrobust.design.box import Box, lifted
from modrobust.design.need import need
from modrobust.design.spectra import spectra
from modrobust.design.states import MotionStates, configurations, states_of_any_motion
from modrobust.design.twists import (
    Weights,
    jacobians,
    kinetic_weights,
    mass_matrices,
    motion,
    moving,
    spatial,
    torque_weights,
)

ROBOTS = ("lwa4p-paper", "lwa4p", "panda", "gantry", "hebi-arm")  # panda has a mimic joint


@cache
def drawn(name, count):
    """A robot and random points of its box."""
    robot = mr.load_robot(name)
    rng = np.random.default_rng(11)
    return robot, [robot.sample_parameters(rng) for _ in range(count)]


def value(weights: Weights, points):
    """Of the linear function, row by row."""
    return (
        (weights.mass * points.mass).sum(-1)
        + (weights.moment * points.moment).sum((-1, -2))
        + (weights.inertia * points.inertia).sum((-1, -2, -3))
        + (weights.rotor * points.rotor).sum(-1)
    )


@pytest.mark.parametrize("name", ROBOTS)
def test_bodies_and_drives_add_up_to_the_kernels_mass_matrix(name):
    robot = mr.load_robot(name)
    q = configurations(robot, 4)
    point = robot.sample_parameters(1)
    J = jacobians(robot, q)
    at = lifted(robot, [point])
    blocks = spatial(at.mass, at.moment, at.inertia)
    M = mass_matrices(robot, J, np.tile(blocks, (4, 1, 1, 1, 1)), np.tile(at.rotor, (4, 1, 1)))
    for k in range(4):
        expected = mr.mass_matrix(robot, q[k], point)
        np.testing.assert_allclose(M[k, 0], expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", ROBOTS)
def test_weights_give_the_kernels_kinetic_energy_and_torque(name):
    robot = mr.load_robot(name)
    rng = np.random.default_rng(4)
    q = configurations(robot, 4)
    dq, ddq, delta = rng.normal(size=(3, *q.shape))
    point = robot.sample_parameters(1)
    rigid = replace(point, viscous=0.0 * point.viscous, coulomb=0.0 * point.coulomb)
    at, J = lifted(robot, [rigid]), jacobians(robot, q)
    twice = value(kinetic_weights(robot, J, dq[:, None]), at)
    torque = value(torque_weights(robot, J, motion(robot, q, dq, ddq), ddq, delta[:, None]), at)
    for k in range(4):
        assert twice[k] == pytest.approx(dq[k] @ mr.mass_matrix(robot, q[k], rigid) @ dq[k])
        expected = mr.inverse_dynamics(robot, q[k], dq[k], dq[k], ddq[k], rigid)
        assert torque[k] == pytest.approx(delta[k] @ expected, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("name", ["lwa4p-paper", "lwa4p-payload", "hebi-arm"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_extreme_points_are_bodies_inside_the_box_and_beyond_all_random_ones(name, sign):
    robot = mr.load_robot(name)
    q = configurations(robot, 6)
    J = jacobians(robot, q)
    rng = np.random.default_rng(7)
    dq, ddq, delta = rng.normal(size=(3, *q.shape))
    moved = motion(robot, q, dq, ddq)
    for weights in (
        kinetic_weights(robot, J, dq[:, None]),
        torque_weights(robot, J, moved, ddq, delta[:, None]),
    ):
        found = Box(robot).extreme(weights, sign)
        random = lifted(robot, drawn(name, 40)[1])
        reached = value(weights, found)
        for k in range(6):
            one = Weights(*(getattr(weights, x)[k] for x in ("mass", "moment", "inertia", "rotor")))
            spread = sign * value(one, random)
            assert sign * reached[k] >= spread.max() - 0.02 * np.ptp(spread)
        which = moving(robot)
        lo, hi = robot.lower, robot.upper
        com = found.moment / np.where(found.mass, found.mass, 1.0)[..., None]
        slack = 1e-9
        assert (found.mass >= lo.mass[which] - slack).all()
        assert (found.mass <= hi.mass[which] + slack).all()
        some = found.mass > 0.0
        assert ((com >= lo.com[which] - slack) | ~some[..., None]).all()
        assert ((com <= hi.com[which] + slack) | ~some[..., None]).all()
        square = (com**2).sum(-1)[..., None, None] * np.eye(3)
        parallel = found.mass[..., None, None] * (square - com[..., :, None] * com[..., None, :])
        framed = robot.framed[which][:, None, None]
        at_com = found.inertia - parallel
        given = np.where(framed, found.inertia, at_com)
        assert (given >= lo.inertia[which] - slack).all()
        assert (given <= hi.inertia[which] + slack).all()
        half_trace = 0.5 * np.trace(at_com, axis1=-2, axis2=-1)[..., None, None]
        least = np.linalg.eigvalsh(half_trace * np.eye(3) - at_com)[..., 0]
        assert (least >= -1e-6 * np.abs(at_com).max()).all()


@pytest.mark.parametrize(
    ("name", "count"), [("lwa4p-paper", 500), ("ur5", 500), ("gantry", 500), ("lwa4p", 100)]
)
def test_ranges_hold_the_eigenvalues_of_random_robots_to_two_per_cent(name, count):
    robot, points = drawn(name, count)
    q = configurations(robot, 6)
    centre = central_parameters(robot)
    light = light_parameters(robot, centre)
    found = spectra(robot, centre, light, q)
    for model, (least, most) in ((light, found.light), (centre, found.centre)):
        assert 0.0 < least < most < np.inf
        for x in q:
            L = np.linalg.inv(np.linalg.cholesky(mr.mass_matrix(robot, x, model)))
            M = np.array([mr.mass_matrix(robot, x, p) for p in points])
            values = 1.0 / np.linalg.eigvalsh(L @ M @ L.T)
            assert values.min() >= 0.98 * least
            assert values.max() <= 1.02 * most


@pytest.mark.parametrize("name", ["lwa4p-paper", "lwa4p-payload", "ur5"])
def test_ranges_reach_as_far_as_the_corners_of_the_box(name):
    """What is found is a point of the box; pulled corners are others, and none is much further."""
    robot = mr.load_robot(name)
    q = configurations(robot, 6)
    centre = central_parameters(robot)
    light = light_parameters(robot, centre)
    least, most = spectra(robot, centre, light, q).light
    points = [robot.physical_corner("corner", k)[0] for k in range(16)]
    points += [robot.physical_corner(end)[0] for end in ("lower", "upper")]
    for x in q:
        L = np.linalg.inv(np.linalg.cholesky(mr.mass_matrix(robot, x, light)))
        M = np.array([mr.mass_matrix(robot, x, p) for p in points])
        values = 1.0 / np.linalg.eigvalsh(L @ M @ L.T)
        assert values.min() >= 0.98 * least
        assert values.max() <= 1.02 * most


def test_the_range_of_an_exact_robot_is_one():
    robot = mr.load_robot("lwa4p-paper")
    exact = replace(robot, lower=robot.nominal, upper=robot.nominal)
    q = configurations(exact, 4)
    centre = central_parameters(exact)
    found = spectra(exact, centre, light_parameters(exact, centre), q)
    np.testing.assert_allclose([*found.light, *found.centre, found.least_share], 1.0, rtol=1e-9)


def test_twice_the_mass_of_everything_is_half_the_eigenvalue():
    """One box for mass and tensors, 1 to 2 times nominal: M_s is the least, pi from 1/2 to 1."""
    robot = mr.load_robot("gantry")  # no rotor counts twice
    p = replace(robot.nominal, rotor_inertia=0.0 * robot.nominal.rotor_inertia)
    double = replace(p, mass=2.0 * p.mass, inertia=2.0 * p.inertia)
    box = replace(robot, lower=p, nominal=p, upper=double, scenarios={})
    centre = central_parameters(box)
    light = light_parameters(box, centre)
    found = spectra(box, centre, light, configurations(box, 4))
    np.testing.assert_allclose(found.light, [0.5, 1.0], rtol=1e-9)
    np.testing.assert_allclose(found.centre, [0.75, 1.5], rtol=1e-9)
    assert found.least_share == pytest.approx(2.0 / 3.0)


def _light_mass(robot, light, states):
    return np.array([mr.mass_matrix(robot, q, light) for q in states.q])


@pytest.mark.parametrize("name", ["lwa4p-paper", "lwa4p", "panda", "hebi-arm"])
def test_the_need_is_at_least_that_of_random_robots(name):
    robot = mr.load_robot(name)
    centre = central_parameters(robot)
    states = states_of_any_motion(robot, centre)
    light = light_parameters(robot, centre, states.q)
    M_s = _light_mass(robot, light, states)
    found = need(robot, centre, M_s, states)
    most = 0.0
    for point in drawn(name, 30)[1]:
        for q, dq, ddq, M in zip(states.q, states.dq, states.ddq, M_s, strict=True):
            torque = [mr.inverse_dynamics(robot, q, dq, dq, ddq, p) for p in (point, centre)]
            most = max(most, float(np.linalg.norm(np.linalg.solve(M, torque[0] - torque[1]))))
    assert most <= 1.02 * (found.parameters + found.friction)
    assert found.parameters + found.friction < 20.0 * most


def test_the_need_of_a_known_robot_is_its_disturbance():
    """With M_s and [d] by hand: ||M_s^-1| |d||, and no factor 2 on it."""
    robot = mr.load_robot("gantry")
    d = replace(robot.disturbance, lo=np.full(robot.n, -3.0), hi=np.full(robot.n, 1.0))
    exact = replace(robot, lower=robot.nominal, upper=robot.nominal, disturbance=d)
    centre = central_parameters(exact)
    q = configurations(exact, 3)
    states = MotionStates(q, 0.0 * q, 0.0 * q, "rest")
    M_s = _light_mass(exact, centre, states)
    found = need(exact, centre, M_s, states)
    expected = max(np.linalg.norm(np.abs(np.linalg.inv(M)) @ np.full(robot.n, 3.0)) for M in M_s)
    assert found.disturbance == pytest.approx(expected)
    assert found.total == pytest.approx(expected, rel=1e-6)
    assert found.friction == 0.0


def test_friction_counts_twice_with_half_its_width():
    robot = mr.load_robot("gantry")
    p = robot.nominal
    spread = np.full(robot.j, 4.0)
    box = replace(robot, lower=p, upper=replace(p, coulomb=p.coulomb + spread), scenarios={})
    centre = central_parameters(box)
    q = configurations(box, 3)
    states = MotionStates(q, 0.0 * q, 0.0 * q, "rest")
    M_s = _light_mass(box, centre, states)
    found = need(box, centre, M_s, states)
    expected = max(np.linalg.norm(np.abs(np.linalg.inv(M)) @ np.full(robot.n, 2.0)) for M in M_s)
    assert found.friction == pytest.approx(expected)
    assert found.total == pytest.approx(2.0 * expected + found.disturbance, rel=1e-6)


@pytest.mark.parametrize("name", ["lwa4p", "panda", "gantry"])
def test_states_of_any_motion_stay_inside_limits_and_torques(name):
    robot = mr.load_robot(name)
    centre = central_parameters(robot)
    states = states_of_any_motion(robot, centre)
    assert (np.abs(states.dq) <= robot.velocity_limits).all()
    assert (np.abs(states.ddq) <= robot.acceleration_limits).all()
    for q, dq, ddq in zip(states.q, states.dq, states.ddq, strict=True):
        tau = mr.inverse_dynamics(robot, q, dq, dq, ddq, centre)
        resting = mr.inverse_dynamics(robot, q, 0 * dq, 0 * dq, 0 * ddq, centre)
        room = np.maximum(0.8 * robot.effort_limits, np.abs(resting) + 1.0)
        assert (np.abs(tau) <= room).all()


def test_half_the_speed_is_half_the_pace():
    q = np.ones((2, 3))
    states = MotionStates(q, 2.0 * q, 6.0 * q, "a motion")
    assert states.pace == pytest.approx(3.0)
    assert states.at_speed(0.5).pace == pytest.approx(1.5)
    np.testing.assert_allclose(states.at_speed(0.5).ddq, 1.5)
    assert MotionStates(q, 0.0 * q, 0.0 * q, "rest").pace == 0.0
