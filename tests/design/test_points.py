"""The two points of the box that the sampled law computes with, against the box itself."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.design import central_parameters, light_parameters
from modrobust.design.states import configurations, position_range
from modrobust.errors import SingularMassMatrixError, ValueRangeError
from modrobust.model.sampling import physical_bodies

ROBOTS = ("lwa4p-paper", "lwa4p", "lwa4p-payload", "hebi-arm", "gantry", "concert-wall")


def awkward():
    """The paper's robot with COMs below and across zero, a body without mass, one perhaps."""
    robot = mr.load_robot("lwa4p-paper")
    points = {}
    for name in ("lower", "nominal", "upper"):
        p = getattr(robot, name)
        mass, com, inertia = p.mass.copy(), p.com.copy(), p.inertia.copy()
        side = {"lower": -1.0, "nominal": 0.0, "upper": 1.0}[name]
        com[0] = [-0.03 + 0.01 * side, -0.2 + 0.02 * side, 0.05 * side]
        com[1] = [0.05 + 0.06 * side, -0.04 + 0.05 * side, 0.3 + 0.01 * side]
        mass[5] = {"lower": 0.0, "nominal": 1.0, "upper": 2.0}[name]
        inertia[5] *= {"lower": 0.0, "nominal": 1.0, "upper": 1.5}[name]
        mass[2] = 0.0
        inertia[2] = 0.0
        points[name] = replace(p, mass=mass, com=com, inertia=inertia)
    return replace(robot, scenarios={}, **points)


def steiner(m, c):
    return m * (c @ c * np.eye(3) - np.outer(c, c))


def ends_of_the_lifted_box(robot, b):
    """Least and largest (m, m c, I_o) over vertices, and where a component of c may vanish, there.

    Every entry is monotonic in m and in I, and in each c_i but for its square.
    """
    lo, hi = robot.lower, robot.upper
    steps = [
        {lo.com[b, i], hi.com[b, i], float(np.clip(0.0, lo.com[b, i], hi.com[b, i]))}
        for i in range(3)
    ]
    found = []
    for m, *rest in product((lo.mass[b], hi.mass[b]), *steps, (lo.inertia[b], hi.inertia[b])):
        c, I = np.array(rest[:3]), rest[3]  # noqa: E741
        moved = I if robot.framed[b] else I + steiner(m, c)
        found.append(np.concatenate([[m], m * c, moved.ravel()]))
    return np.min(found, axis=0), np.max(found, axis=0)


def lifted_body(robot, point, b):
    m, c = point.mass[b], point.com[b]
    moved = point.inertia[b] if robot.framed[b] else point.inertia[b] + steiner(m, c)
    return np.concatenate([[m], m * c, moved.ravel()])


@pytest.mark.parametrize("name", [*ROBOTS, "awkward"])
def test_the_centre_lies_in_the_middle_of_the_lifted_box(name):
    robot = awkward() if name == "awkward" else mr.load_robot(name)
    centre = central_parameters(robot)
    for b in range(robot.b):
        lo, hi = ends_of_the_lifted_box(robot, b)
        scale = max(1e-12, np.abs(hi).max())
        middle = lifted_body(robot, centre, b)
        np.testing.assert_allclose(middle, 0.5 * (lo + hi), rtol=1e-12, atol=1e-13 * scale)
    for name_ in ("rotor_inertia", "viscous", "coulomb"):
        middle = 0.5 * (getattr(robot.lower, name_) + getattr(robot.upper, name_))
        np.testing.assert_allclose(getattr(centre, name_), middle, rtol=1e-15)


@pytest.mark.parametrize("name", [*ROBOTS, "awkward"])
def test_the_centre_is_a_body_and_inside_the_bounds_of_mass_and_com(name):
    robot = awkward() if name == "awkward" else mr.load_robot(name)
    centre = central_parameters(robot)
    assert physical_bodies(robot.nominal, centre, robot.framed).all()
    for entry in ("mass", "com"):
        x = getattr(centre, entry)
        assert (x >= getattr(robot.lower, entry) - 1e-12).all()
        assert (x <= getattr(robot.upper, entry) + 1e-12).all()


def test_what_is_exact_keeps_its_bits():
    robot = mr.load_robot("lwa4p-paper")
    exact = replace(robot, lower=robot.nominal, upper=robot.nominal)
    centre = central_parameters(exact)
    assert np.array_equal(centre.packed, robot.nominal.packed)


def test_a_box_whose_middle_no_body_has_is_pulled_towards_nominal():
    """Moments (1, 1, 1), the last up to 10: no body has (1, 1, 5.5); (1, 1, 2) is the last."""
    robot = mr.load_robot("lwa4p-paper")
    mass, com = robot.nominal.mass.copy(), robot.nominal.com
    inertia, upper = np.tile(np.eye(3), (robot.b, 1, 1)), np.tile(np.eye(3), (robot.b, 1, 1))
    upper[3, 2, 2] = 10.0
    points: dict[str, Any] = {
        k: replace(robot.nominal, mass=mass, com=com, inertia=i)
        for k, i in (("lower", inertia), ("nominal", inertia), ("upper", upper))
    }
    centre = central_parameters(replace(robot, scenarios={}, **points))
    np.testing.assert_allclose(np.diag(centre.inertia[3]), [1.0, 1.0, 2.0], rtol=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_light_end_has_least_masses_and_no_moment_above_its_least(name):
    robot = mr.load_robot(name)
    centre = central_parameters(robot)
    light = light_parameters(robot, centre)
    assert np.array_equal(light.mass, robot.lower.mass)
    assert np.array_equal(light.com, centre.com)
    assert np.array_equal(light.rotor_inertia, robot.lower.rotor_inertia)
    assert np.array_equal(light.viscous, centre.viscous)
    assert np.array_equal(light.coulomb, centre.coulomb)
    for b in range(robot.b):
        c = centre.com[b]
        taken = steiner(light.mass[b], c) if robot.framed[b] else 0.0
        mine = light.inertia[b] - taken
        whole = centre.inertia[b] - (steiner(centre.mass[b], c) if robot.framed[b] else 0.0)
        least = robot.lower.inertia[b] - taken
        tolerance = 1e-12 * max(np.abs(whole).max(), 1e-12)
        assert (np.diag(mine) <= np.maximum(np.diag(least), 0.0) + tolerance).all()
        factor = np.trace(mine) / np.trace(whole) if np.trace(whole) > 0.0 else 1.0
        assert 0.0 <= factor <= 1.0 + 1e-12
        np.testing.assert_allclose(mine, factor * whole, atol=tolerance)
        touched = np.isclose(np.diag(mine), np.diag(least), rtol=1e-9, atol=tolerance)
        assert touched.any() or np.isclose(factor, 1.0) or factor == 0.0


@pytest.mark.parametrize("name", [*ROBOTS, "awkward"])
def test_the_light_mass_matrix_is_positive_and_below_that_of_the_centre(name):
    robot = awkward() if name == "awkward" else mr.load_robot(name)
    centre = central_parameters(robot)
    light = light_parameters(robot, centre)
    for q in configurations(robot, 12):
        M_s, M_c = (mr.mass_matrix(robot, q, p) for p in (light, centre))
        assert np.linalg.eigvalsh(M_s).min() > 0.0
        assert np.linalg.eigvalsh(M_c - M_s).min() > -1e-9 * np.abs(M_c).max()


def test_where_the_last_link_may_weigh_nothing_one_per_cent_of_the_centre_is_mixed_in():
    robot = awkward()  # its last body may have neither mass nor inertia, and there is no rotor
    centre = central_parameters(robot)
    light = light_parameters(robot, centre)
    assert light.mass[5] == pytest.approx(0.01 * centre.mass[5])
    np.testing.assert_allclose(light.inertia[5], 0.01 * centre.inertia[5], rtol=1e-9)
    assert light.mass[0] == pytest.approx(0.99 * robot.lower.mass[0] + 0.01 * centre.mass[0])


def test_a_joint_that_nothing_resists_is_refused_by_name_of_the_robot():
    robot = awkward()
    nothing = {}
    for name in ("lower", "nominal", "upper"):
        p = getattr(robot, name)
        mass, inertia = p.mass.copy(), p.inertia.copy()
        mass[5], inertia[5] = 0.0, 0.0
        nothing[name] = replace(p, mass=mass, inertia=inertia)
    bare = replace(robot, **nothing)
    with pytest.raises(
        SingularMassMatrixError, match='robot "lwa4p-paper": the mass matrix at the'
    ):
        light_parameters(bare, central_parameters(bare))


def test_what_is_no_robot_is_refused():
    wrong: Any = "lwa4p"
    with pytest.raises(ValueRangeError, match="expected a Robot, got str"):
        central_parameters(wrong)


@pytest.mark.parametrize("name", ["lwa4p", "gantry", "panda"])
def test_configurations_are_the_same_each_time_and_inside_the_limits(name):
    robot = mr.load_robot(name)
    q = configurations(robot)
    assert np.array_equal(q, configurations(robot))
    lo, hi = robot.position_limits.T
    assert (q >= lo).all()
    assert (q <= hi).all()
    assert (q.max(axis=0) - q.min(axis=0) > 0.5 * np.subtract(*position_range(robot)[::-1])).all()


def test_joints_without_limits_are_looked_at_within_a_turn_or_half_a_metre():
    robot = mr.load_robot("gantry")
    free = replace(robot, position_limits=np.tile([-np.inf, np.inf], (robot.n, 1)))
    lo, hi = position_range(free)
    turn = np.where(robot.free_turns, np.pi, 0.25)
    np.testing.assert_allclose(hi, 0.8 * turn)
    np.testing.assert_allclose(lo, -0.8 * turn)
