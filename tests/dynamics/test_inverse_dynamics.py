"""NE* of the kernel: the transcription of Algorithm 1, hand-worked cases, symmetries, errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import modrobust as mr
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import Parameters, Robot
from modrobust.reference import link_frames, mass_matrix, newton_euler
from support.random_robots import merge_bodies, point_robot, random_robot, random_state
from support.rounding import as_long, assert_encloses, excess_allowed, point

SHAPES = [
    {"simple": True, "n": 6},
    {"simple": True, "types": "pppp"},
    {"simple": True, "types": "rprprp"},
    {"simple": False, "n": 1},
    {"simple": False, "n": 7},
    {"simple": False, "n": 12},
    {"simple": False, "n": 9, "tree": True},
]


def assert_same(actual: Any, expected: Any, tolerance: float = 1e-12) -> None:
    """Equal to `tolerance` of the largest entry."""
    scale = max(1e-300, float(np.abs(expected).max()))
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * scale)


def exact_corner(robot: Robot, rng: np.random.Generator) -> Parameters:
    """Some vertex of the box, drawn here so that the robot's own method is not trusted."""
    sides = {}
    for name in ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb"):
        lo, hi = getattr(robot.lower, name), getattr(robot.upper, name)
        pick = rng.random(lo.shape) < 0.5
        if name == "inertia":
            pick = np.triu(pick) | np.triu(pick, 1).swapaxes(-1, -2)
        sides[name] = np.where(pick, lo, hi)
    return Parameters(**sides)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("drives", [False, True])
def test_newton_euler_equals_the_transcription(shape: dict[str, Any], drives: bool) -> None:
    rng = np.random.default_rng(1)
    for _ in range(5):
        robot = random_robot(rng, **shape)
        state = random_state(rng, robot.n)
        for parameters in (None, exact_corner(robot, rng)):
            tau = mr.inverse_dynamics(robot, *state, parameters=parameters, drives=drives)
            point = robot.nominal if parameters is None else parameters
            assert_same(tau, newton_euler(robot, point, *state, drives=drives))


def coriolis_matrix(robot: Robot, q: Any, dq: Any) -> Any:
    """C(q, dq), column by column: C e_k = NE*(q, dq, e_k, 0) - g."""
    zero = np.zeros(robot.n)
    g = mr.inverse_dynamics(robot, q, zero, zero, zero, drives=False)
    columns = [mr.inverse_dynamics(robot, q, dq, e, zero, drives=False) for e in np.eye(robot.n)]
    return np.stack(columns, axis=1) - g[:, None]


def mass_matrix_rate(robot: Robot, q: Any, dq: Any) -> Any:
    """dM/dt along dq: central differences of the kernel's M, extrapolated to sixth order."""

    def difference(h: float) -> Any:
        ahead = mr.mass_matrix(robot, q + h * dq, drives=False)
        behind = mr.mass_matrix(robot, q - h * dq, drives=False)
        return (ahead - behind) / (2 * h)

    h = 4e-3
    one, two, four = difference(h), difference(2 * h), difference(4 * h)
    first, second = (4 * one - two) / 3, (4 * two - four) / 3
    return (16 * first - second) / 15


def skew_defect(rate: Any, C: Any) -> float:
    """Largest |x'(Mdot - 2C)x| over unit x, relative to the norm of Mdot and C."""
    N = rate - 2 * C
    worst = np.abs(np.linalg.eigvalsh((N + N.T) / 2)).max()
    return float(worst / (np.linalg.norm(rate) + np.linalg.norm(C)))


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_mass_rate_minus_two_coriolis_is_skew_symmetric_for_every_vector(
    shape: dict[str, Any],
) -> None:
    rng = np.random.default_rng(2)
    for _ in range(4):
        robot = random_robot(rng, **shape)
        q, dq, _, _ = random_state(rng, robot.n, rate=1.0)
        C = coriolis_matrix(robot, q, dq)
        if np.linalg.norm(C) < 1e-9:
            assert set(robot.joint_types) == {"prismatic"} or robot.n == 1
            continue
        # exact derivative of the transcription's M, which equals the kernel's
        h = 1e-30
        assert_same(mr.mass_matrix(robot, q, drives=False), mass_matrix(robot, robot.nominal, q))
        exact = mass_matrix(robot, robot.nominal, q + 1j * h * dq).imag / h
        assert skew_defect(exact, C) < 1e-12
        # and the derivative of the kernel's own M, as far as differences go
        assert skew_defect(mass_matrix_rate(robot, q, dq), C) < 1e-8


def test_the_skew_symmetry_test_sees_a_wrong_factorisation() -> None:
    rng = np.random.default_rng(3)
    for types in ("rrr", "rprr", "rrrrrr"):
        robot = random_robot(rng, types=types, drives=False)
        q, dq, _, _ = random_state(rng, robot.n, rate=1.0)
        zero, h = np.zeros(robot.n), 1e-30
        g = newton_euler(robot, robot.nominal, q, zero, zero, zero)
        columns = [
            newton_euler(robot, robot.nominal, q, dq, e, zero, gyroscopic_in_omega=True) - g
            for e in np.eye(robot.n)
        ]
        wrong = np.stack(columns, axis=1)
        right = coriolis_matrix(robot, q, dq)
        rate = mass_matrix(robot, robot.nominal, q + 1j * h * dq).imag / h
        assert_same(wrong @ dq, right @ dq, 1e-11)  # no test through C(q, dq) dq tells them apart
        assert abs(dq @ (rate - 2 * wrong) @ dq) < 1e-9  # nor the test with x = dq
        assert skew_defect(rate, wrong) > 1e-4 > skew_defect(rate, right)


def test_coriolis_torque_exchanges_with_the_velocities_only_along_the_diagonal() -> None:
    robot = random_robot(np.random.default_rng(4), types="rrpr", drives=False)
    q, dq, dq_a, ddq_a = random_state(np.random.default_rng(5), 4)
    there = mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a)
    back = mr.inverse_dynamics(robot, q, dq_a, dq, ddq_a)
    assert np.abs(there - back).max() > 1e-6


def planar_arm(types: str, lengths: list[float], masses: list[float]) -> Robot:
    """Point masses at the ends of links in a vertical plane: joints about a horizontal axis."""
    after = []
    for i, length in enumerate(lengths):
        T = np.eye(4)
        if types[i] == "p":  # slides along z of its own frame
            T[2, 3] = length
        else:
            T[0, 3] = length
        after.append(T)
    n = len(types)
    robot = point_robot(
        types, after=after, mass=masses, com=np.zeros((n, 3)), inertia=np.zeros((n, 3, 3))
    )
    return replace(robot, gravity=np.array([0.0, -9.81, 0.0]))


def test_a_pendulum_needs_its_weight_times_the_lever() -> None:
    robot = planar_arm("r", [0.5], [2.0])
    q, dq, ddq = 0.3, 1.7, -0.9
    tau = mr.inverse_dynamics(robot, [q], [dq], [dq], [ddq])
    assert tau[0] == pytest.approx(2.0 * 0.25 * ddq + 2.0 * 9.81 * 0.5 * np.cos(q), rel=1e-14)


def test_a_two_link_arm_follows_the_textbook_with_separate_velocities() -> None:
    l1, l2, m1, m2, g = 0.4, 0.3, 1.5, 0.7, 9.81
    robot = planar_arm("rr", [l1, l2], [m1, m2])
    q, dq, dq_a, ddq = random_state(np.random.default_rng(6), 2)
    c2, h = np.cos(q[1]), m2 * l1 * l2 * np.sin(q[1])
    M = np.array(
        [
            [
                (m1 + m2) * l1**2 + m2 * l2**2 + 2 * m2 * l1 * l2 * c2,
                m2 * l2**2 + m2 * l1 * l2 * c2,
            ],
            [m2 * l2**2 + m2 * l1 * l2 * c2, m2 * l2**2],
        ]
    )
    C = np.array([[-h * dq[1], -h * (dq[0] + dq[1])], [h * dq[0], 0.0]])
    reach = l2 * np.cos(q[0] + q[1])
    gravity = g * np.array([(m1 + m2) * l1 * np.cos(q[0]) + m2 * reach, m2 * reach])
    tau = mr.inverse_dynamics(robot, q, dq, dq_a, ddq)
    assert_same(tau, M @ ddq + C @ dq_a + gravity, 1e-14)


def test_a_vertical_slide_carries_weight_and_inertia() -> None:
    robot = point_robot(
        "p", after=[np.eye(4)], mass=[3.0], com=[[0, 0, 0.1]], inertia=np.zeros((1, 3, 3))
    )
    tau = mr.inverse_dynamics(robot, [0.2], [0.5], [0.7], [2.0])
    assert tau[0] == pytest.approx(3.0 * (9.81 + 2.0), rel=1e-15)


def test_a_slide_on_a_turntable_feels_the_centrifugal_and_coriolis_forces() -> None:
    # the slide's z points along x of the turntable; the mass is at radius q1
    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix()
    robot = point_robot(
        "rp", after=[turn, np.eye(4)], mass=[0.0, 2.0], com=np.zeros((2, 3)),
        inertia=np.zeros((2, 3, 3)),
    )  # fmt: skip
    q, dq, ddq = [0.4, 0.6], [1.5, -0.8], [0.3, 0.9]
    tau = mr.inverse_dynamics(robot, q, dq, dq, ddq)
    expected = [2.0 * (0.36 * 0.3 + 2 * 0.6 * 1.5 * -0.8), 2.0 * (0.9 - 0.6 * 1.5**2)]
    assert_same(tau, expected, 1e-14)


@pytest.mark.parametrize("turns", [1, -1, 3, 1000])
def test_a_revolute_joint_is_periodic(turns: int) -> None:
    rng = np.random.default_rng(7)
    robot = random_robot(rng, types="rrrrr")
    q, *rates = random_state(rng, 5)
    there = mr.inverse_dynamics(robot, q, *rates)
    # the double 2 pi is off by 2.4e-16, each turn; q itself loses its last bits
    assert_same(
        mr.inverse_dynamics(robot, q + turns * 2 * np.pi, *rates), there, 1e-13 + 4e-15 * abs(turns)
    )


def test_an_angle_beyond_the_kernels_sine_is_an_error_and_a_long_slide_is_not() -> None:
    robot = random_robot(np.random.default_rng(8), types="rp")
    zero = np.zeros(2)
    mr.inverse_dynamics(robot, [99_999.0, 200_000.0], zero, zero, zero)
    with pytest.raises(ValueRangeError):
        mr.inverse_dynamics(robot, [100_001.0, 0.0], zero, zero, zero)


def test_the_base_may_turn_with_gravity_and_move_anywhere() -> None:
    rng = np.random.default_rng(9)
    robot = random_robot(rng, 6)
    state = random_state(rng, 6)
    tau = mr.inverse_dynamics(robot, *state)
    turn = np.eye(4)
    turn[:3, :3] = Rotation.random(rng=rng).as_matrix()
    turn[:3, 3] = [3.0, -2.0, 1.0]
    moved = replace(robot, base=turn @ robot.base, gravity=turn[:3, :3] @ robot.gravity)
    assert_same(mr.inverse_dynamics(moved, *state), tau, 1e-13)
    mounted = replace(robot, base=turn @ robot.base)  # gravity stays: a wall mount
    assert np.abs(mr.inverse_dynamics(mounted, *state) - tau).max() > 0.1


def test_the_split_of_a_constant_transform_into_before_and_after_does_not_matter() -> None:
    rng = np.random.default_rng(10)
    robot = random_robot(rng, 6, drives=False)
    after, before = robot.after.copy(), robot.before.copy()
    before[3] = after[2] @ before[3]  # joint 3 hangs on joint 2; link 2's frame moves to its joint
    placement = robot.placement.copy()
    on_link = robot.body_joints == 2
    placement[on_link] = after[2] @ placement[on_link]
    after[2] = np.eye(4)
    other = replace(robot, before=before, after=after, placement=placement)
    state = random_state(rng, 6)
    assert_same(mr.inverse_dynamics(other, *state), mr.inverse_dynamics(robot, *state))


@pytest.mark.parametrize("where", ["before", "after", "placement"])
@pytest.mark.parametrize("angle", [1e-9, 1e-8, 1e-6])
def test_a_tiny_rotation_is_not_taken_for_none(where: str, angle: float) -> None:
    # the cosine of 1e-9 is 1 in double precision; its sine still is 1e-9
    rng = np.random.default_rng(11)
    robot = random_robot(rng, 4, simple=True)
    frames = getattr(robot, where).copy()
    tilt = np.eye(4)
    c, s = np.cos(angle), np.sin(angle)
    tilt[:3, :3] = [[c, -s, 0], [s * c, c * c, -s], [s * s, s * c, c]]
    frames[1:] = tilt if where != "after" else frames[1:] @ tilt
    tilted = replace(robot, **{where: frames})
    state = random_state(rng, 4)
    expected = newton_euler(tilted, tilted.nominal, *state)
    assert_same(mr.inverse_dynamics(tilted, *state, drives=False), expected)
    bounds = mr.inverse_dynamics_bounds(point(tilted), *state, drives=False)
    real = newton_euler(tilted, tilted.nominal, *as_long(state))
    assert_encloses(bounds, (real, real), excess_allowed(point(tilted), *state, drives=False))


def test_torque_is_linear_in_mass_and_inertia_and_quadratic_in_speed() -> None:
    rng = np.random.default_rng(12)
    robot = random_robot(rng, 5, drives=False)
    q, dq, dq_a, ddq_a = random_state(rng, 5)
    heavy = replace(robot.nominal, mass=3 * robot.nominal.mass, inertia=3 * robot.nominal.inertia)
    tau = mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a)
    assert_same(mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a, parameters=heavy), 3 * tau)
    free = replace(robot, gravity=np.zeros(3))
    tau = mr.inverse_dynamics(free, q, dq, dq_a, ddq_a)
    assert_same(mr.inverse_dynamics(free, q, 2 * dq, 2 * dq_a, 4 * ddq_a), 4 * tau)


def test_torque_is_affine_in_the_auxiliary_velocity_and_acceleration() -> None:
    rng = np.random.default_rng(13)
    robot = random_robot(rng, 6)
    q, dq, x, y = random_state(rng, 6)
    zero = np.zeros(6)
    rest = mr.inverse_dynamics(robot, q, dq, zero, zero)
    both = mr.inverse_dynamics(robot, q, dq, x, y)
    apart = mr.inverse_dynamics(robot, q, dq, x, zero) + mr.inverse_dynamics(robot, q, dq, zero, y)
    assert_same(both, apart - rest)


def test_friction_uses_the_velocity_and_the_rotor_the_auxiliary_acceleration() -> None:
    rng = np.random.default_rng(14)
    robot = random_robot(rng, types="rpr")
    q, dq, dq_a, ddq_a = random_state(rng, 3)
    dq[1] = 5e-4  # inside the smooth part
    p = robot.nominal
    expected = (
        p.viscous * dq
        + p.coulomb * dq / np.sqrt(dq**2 + robot.coulomb_speed**2)
        + robot.gear_ratio**2 * p.rotor_inertia * ddq_a
    )
    full = mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a)
    rigid = mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a, drives=False)
    assert_same(full - rigid, expected)


def test_bodies_fixed_to_the_base_add_nothing() -> None:
    rng = np.random.default_rng(15)
    robot = random_robot(rng, 4)
    assert robot.body_joints[0] == -1
    mass = robot.nominal.mass.copy()
    mass[0] *= 100
    heavy = replace(robot.nominal, mass=mass)
    state = random_state(rng, 4)
    there = mr.inverse_dynamics(robot, *state)
    np.testing.assert_array_equal(mr.inverse_dynamics(robot, *state, parameters=heavy), there)


def test_bodies_apart_change_the_factorisation_by_a_known_gyroscopic_moment() -> None:
    # apart - merged: on each link the moment -(sum of m d^2) omega_a x omega, d from the joint COM;
    # it vanishes for dq_a = dq, and x'(Mdot - 2C)x cannot see it
    rng = np.random.default_rng(22)
    robot = random_robot(rng, types="rprr", drives=False)
    assert np.count_nonzero(robot.body_joints >= 2) > 2
    one = merge_bodies(robot)
    q, dq, dq_a, ddq_a = random_state(rng, 4)
    h = 1e-30
    frames = link_frames(robot, q)
    jacobians = []  # angular, link frames, (3, n)
    for i in range(4):
        columns = []
        for e in np.eye(4):
            moved = link_frames(robot, q + 1j * h * e)[i]
            W = frames[i][:3, :3].T @ (moved[:3, :3].imag / h)
            columns.append([W[2, 1], W[0, 2], W[1, 0]])
        jacobians.append(np.array(columns).T)
    expected = np.zeros(4)
    for i, J in enumerate(jacobians):
        own = np.flatnonzero(robot.body_joints == i)
        T, p = robot.placement[own], robot.nominal
        centres = np.einsum("bij,bj->bi", T[:, :3, :3], p.com[own]) + T[:, :3, 3]
        spread = p.mass[own] @ ((centres - one.nominal.com[i]) ** 2).sum(axis=1)
        expected -= J.T @ (spread * np.cross(J @ dq_a, J @ dq))
    apart = mr.inverse_dynamics(robot, q, dq, dq_a, ddq_a)
    difference = apart - mr.inverse_dynamics(one, q, dq, dq_a, ddq_a)
    assert np.abs(expected).max() > 1e-3
    np.testing.assert_allclose(difference, expected, rtol=0, atol=1e-12 * np.abs(apart).max())
    same = mr.inverse_dynamics(robot, q, dq, dq, ddq_a)
    assert_same(mr.inverse_dynamics(one, q, dq, dq, ddq_a), same)


def test_a_branch_does_not_load_its_sibling() -> None:
    rng = np.random.default_rng(16)
    robot = replace(random_robot(rng, types="rrpr"), parents=np.array([-1, 0, 0, 2], np.int32))
    mass = robot.nominal.mass.copy()
    mass[robot.body_joints == 1] = 0.0
    light = replace(robot.nominal, mass=mass)
    state = random_state(rng, 4)
    change = mr.inverse_dynamics(robot, *state) - mr.inverse_dynamics(
        robot, *state, parameters=light
    )
    assert abs(change[0]) > 1e-3 < abs(change[1])
    assert change[2] == 0.0 == change[3]


@pytest.mark.parametrize("k", range(4))
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_refused(k: int, bad: float) -> None:
    robot = random_robot(np.random.default_rng(17), 3)
    state = random_state(np.random.default_rng(18), 3)
    state[k][1] = bad
    with pytest.raises(ValueRangeError):
        mr.inverse_dynamics(robot, *state)
    for bound in ("hull", "ianea"):
        with pytest.raises(ValueRangeError):
            mr.inverse_dynamics_bounds(robot, *state, bound=bound)
        with pytest.raises(ValueRangeError):
            mr.perturbation_bounds(robot, *state, bound=bound)


@pytest.mark.parametrize("k", range(4))
@pytest.mark.parametrize("shape", [(2,), (4,), (3, 1), ()])
def test_a_vector_of_the_wrong_shape_is_refused(k: int, shape: tuple[int, ...]) -> None:
    robot = random_robot(np.random.default_rng(19), 3)
    state = list(random_state(np.random.default_rng(20), 3))
    state[k] = np.zeros(shape)
    with pytest.raises(ShapeError, match="joints"):
        mr.inverse_dynamics(robot, *state)
