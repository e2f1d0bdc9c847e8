"""Motions: analytic derivatives, limits, CSV files."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from modrobust.errors import DescriptionError, FileError, ShapeError, ValueRangeError
from modrobust.model import Robot, TrajectorySettings, synthetic_chain
from modrobust.motion import (
    Quintic,
    Sines,
    Splined,
    Trajectory,
    default_trajectory,
    make_trajectory,
)
from modrobust.motion.limits import check_duration, check_limits
from modrobust.motion.spline import CubicSpline
from modrobust.motion.trajectory import paper_trajectory

NAMES = ("link1.axis", "link2.axis")


def chain(
    n: int = 2,
    position: float = np.inf,
    velocity: float = np.inf,
    acceleration: float = np.inf,
) -> Robot:
    return replace(
        synthetic_chain(n),
        position_limits=np.tile([-position, position], (n, 1)),
        velocity_limits=np.full(n, velocity),
        acceleration_limits=np.full(n, acceleration),
    )


def motions() -> list[Trajectory]:
    times = np.array([0.0, 0.7, 1.9, 2.5, 4.0])
    points = np.array([[0.0, 1.0], [0.3, -0.5], [1.0, 0.0], [-1.0, 0.2], [0.5, 0.5]])
    return [
        Sines((1.0, -0.5), (0.6, 1.5)),
        Sines((1.0, 2.0), (0.6, 1.5, 2.2)),
        Quintic(times, points),
        Splined(times, points),
    ]


@pytest.mark.parametrize("motion", motions(), ids=lambda m: type(m).__name__)
def test_derivatives_agree_with_finite_differences(motion: Trajectory) -> None:
    t = np.linspace(0.05, 3.95, 211)
    h = 1e-5
    _, dq, ddq = motion.sample(t)
    q_lo, dq_lo, _ = motion.sample(t - h)
    q_hi, dq_hi, _ = motion.sample(t + h)
    np.testing.assert_allclose((q_hi - q_lo) / (2 * h), dq, atol=1e-7)
    np.testing.assert_allclose((dq_hi - dq_lo) / (2 * h), ddq, atol=1e-3)


def test_the_papers_motion_is_equation_13() -> None:
    t = np.array([0.0, 0.3, 1.0, 7.7])
    q, _, _ = paper_trajectory(synthetic_chain(6)).sample(t)
    amplitude = np.array([1 / 2, -1 / 4, 1 / 6, -1 / 6, 1 / 4, -1 / 2]) * math.pi
    expected = np.outer(np.sin(math.pi * t / 5) * np.sin(math.pi * t / 2), amplitude)
    np.testing.assert_allclose(q, expected, atol=1e-15)


def test_the_papers_motion_needs_six_joints() -> None:
    with pytest.raises(ShapeError, match='has 6 joints; robot "chain-2" has 2'):
        make_trajectory(chain(2), "paper")


def test_a_quintic_passes_its_waypoints_at_rest_and_holds_the_last() -> None:
    motion = motions()[2]
    assert isinstance(motion, Quintic)
    q, dq, ddq = motion.sample(motion.times)
    np.testing.assert_allclose(q, motion.points, atol=1e-15)
    assert not dq.any()
    assert not ddq.any()
    q, dq, ddq = motion.sample([9.0])
    np.testing.assert_array_equal(q[0], motion.points[-1])
    assert not dq.any()
    assert not ddq.any()


def test_a_single_waypoint_is_held() -> None:
    q, dq, _ = Quintic(np.array([0.0]), np.array([[1.0, 2.0]])).sample([0.0, 5.0])
    np.testing.assert_array_equal(q, [[1.0, 2.0], [1.0, 2.0]])
    assert not dq.any()


@pytest.mark.parametrize("knots", [2, 3, 4, 5, 12])
def test_a_spline_reproduces_polynomials_of_its_order(knots: int) -> None:
    t = np.sort(np.random.default_rng(knots).uniform(0.0, 3.0, knots))
    c = np.array([0.3, -1.0, 0.5, 0.2])[: min(knots, 4)]
    polynomial = np.polynomial.Polynomial(c)
    x = np.linspace(t[0], t[-1], 50)
    value, first, second = CubicSpline(t, polynomial(t)[:, None])(x)
    np.testing.assert_allclose(value[:, 0], polynomial(x), atol=1e-11)
    np.testing.assert_allclose(first[:, 0], polynomial.deriv(1)(x), atol=1e-9)
    np.testing.assert_allclose(second[:, 0], polynomial.deriv(2)(x), atol=1e-7)


def test_a_spline_is_twice_continuously_differentiable_at_its_knots() -> None:
    motion = motions()[3]
    assert isinstance(motion, Splined)
    inner = motion.times[1:-1]
    for left, right in zip(motion.sample(inner - 1e-12), motion.sample(inner + 1e-12), strict=True):
        np.testing.assert_allclose(left, right, atol=1e-9)


def test_the_spline_agrees_with_scipy() -> None:
    interpolate = pytest.importorskip("scipy.interpolate")
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.uniform(0.01, 1.0, 40))
    y = rng.normal(size=(40, 3))
    x = np.linspace(t[0], t[-1], 400)
    theirs = interpolate.CubicSpline(t, y)
    for order, ours in enumerate(CubicSpline(t, y)(x)):
        scale = np.abs(theirs(x, order)).max()
        np.testing.assert_allclose(ours, theirs(x, order), atol=1e-11 * scale)


def test_the_default_motion_stays_within_limits_and_is_seeded() -> None:
    robot = chain(4, position=1.0, velocity=0.8)
    for seed in range(20):
        check_limits(robot, default_trajectory(robot, 10.0, seed), 10.0)
    one, same, other = (default_trajectory(robot, 10.0, seed).points for seed in (1, 1, 2))
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.1
    assert np.abs(np.diff(one, axis=0)).max() > 0.1


@pytest.mark.parametrize("limit", ["velocity", "acceleration"])
def test_the_peak_of_the_default_motion_is_half_its_limit(limit: str) -> None:
    # The range is so wide that every step of the seeded waypoints is as long as the limit allows.
    robot = chain(3, position=1e6, **{limit: 0.8})
    motion = default_trajectory(robot, 10.0)
    peak = np.abs(motion.sample(np.linspace(0.0, 10.0, 100_001))[1 + (limit != "velocity")])
    np.testing.assert_allclose(peak.max(axis=0), 0.4, rtol=1e-6)
    check_limits(robot, motion, 10.0)


def test_the_default_motion_without_limits_is_slow() -> None:
    robot = replace(chain(2), joint_types=("revolute", "prismatic"))
    peak = np.abs(default_trajectory(robot, 1.0).sample(np.linspace(0.0, 1.0, 10_001))[1])
    assert (peak.max(axis=0) <= [0.5 + 1e-9, 0.1 + 1e-9]).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"duration": 0.0}, "duration: 0 s; must be positive and finite"),
        ({"duration": "5"}, "duration: '5'; must be a number [s]"),
        ({"seed": -1}, "seed: -1; must be at least 0"),
    ],
)
def test_a_default_motion_of_wrong_numbers_is_refused(
    options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueRangeError) as caught:
        default_trajectory(chain(), **options)
    assert str(caught.value) == message


def test_the_default_motion_respects_a_range_that_excludes_zero() -> None:
    robot = replace(chain(2), position_limits=np.array([[0.5, 0.6], [-np.inf, -1.0]]))
    check_limits(robot, default_trajectory(robot, 10.0), 10.0)


def test_leaving_a_position_limit_names_joint_value_limit_and_time() -> None:
    robot = chain(2, position=0.4)
    with pytest.raises(ValueRangeError) as caught:
        check_limits(robot, Quintic(np.array([0.0, 2.0]), np.array([[0.0, 0.0], [0.3, 0.5]])), 2.0)
    assert str(caught.value) == (
        'trajectory: joint "link2.axis" is at 0.5 rad at t = 2 s; its position must stay in '
        "[-0.4, 0.4] rad; make the motion smaller"
    )


def test_leaving_a_velocity_limit_names_joint_value_limit_and_time() -> None:
    robot = chain(2, velocity=0.2)
    with pytest.raises(ValueRangeError) as caught:
        check_limits(robot, Quintic(np.array([0.0, 2.0]), np.array([[0.0, 0.0], [-0.3, 0.1]])), 2.0)
    assert str(caught.value) == (
        'trajectory: joint "link1.axis" moves at -0.28125 rad/s at t = 1 s; its velocity must '
        "stay in [-0.2, 0.2] rad/s; slow the motion down"
    )


def test_leaving_an_acceleration_limit_names_joint_value_limit_and_time() -> None:
    robot = chain(2, acceleration=0.2)
    motion = Quintic(np.array([0.0, 2.0]), np.array([[0.0, 0.0], [-0.1, 0.3]]))
    with pytest.raises(ValueRangeError) as caught:
        check_limits(robot, motion, 1.0)  # the first half, which speeds up
    # 10 / sqrt(3) times 0.3 rad / (2 s)^2, at s = 1/2 - sqrt(3)/6.
    assert str(caught.value) == (
        'trajectory: joint "link2.axis" accelerates at 0.433012 rad/s^2 at t = 0.423 s; its '
        "acceleration must stay in [-0.2, 0.2] rad/s^2; slow the motion down"
    )
    check_limits(chain(2, acceleration=0.4330128), motion, 2.0)


def test_a_motion_up_to_the_limit_itself_is_fine() -> None:
    check_limits(chain(1, position=0.3), Quintic(np.array([0.0, 1.0]), np.array([[0.1], [0.3]])), 5)


def test_a_splined_motion_that_starts_at_its_limit_is_fine_and_beyond_it_is_not() -> None:
    robot = replace(chain(1), position_limits=np.array([[0.0, 0.3]]))
    t = np.linspace(0.0, 1.0, 101)
    q = Quintic(np.array([0.0, 1.0]), np.array([[0.0], [0.02]])).sample(t)[0]
    assert Splined(t, q).sample([1e-3])[0] < 0.0  # what the spline makes of the start
    check_limits(robot, Splined(t, q), 1.0)
    with pytest.raises(ValueRangeError, match=r"is at -1.00083e-06 rad at t = 0.001 s"):
        check_limits(robot, Splined(t, q - 1e-6), 1.0)


def write(folder: Path, text: str) -> Path:
    file = folder / "m.csv"
    file.write_text(text)
    return file


def test_a_csv_round_trips_and_its_header_orders_the_columns(tmp_path: Path) -> None:
    plain = write(tmp_path, "0,1,2\n1,1.5,2.5\n\n# a remark\n2.5,3,-1e-3\n")
    motion = make_trajectory(chain(), plain)
    assert isinstance(motion, Splined)
    np.testing.assert_allclose(motion.sample(motion.times)[0], motion.points, atol=1e-15)
    np.testing.assert_array_equal(motion.points, [[1, 2], [1.5, 2.5], [3, -1e-3]])
    assert motion.duration == 2.5
    named = write(tmp_path, "t, link2.axis, link1.axis\n0,2,1\n1,2.5,1.5\n2.5,-1e-3,3\n")
    np.testing.assert_array_equal(make_trajectory(chain(), named).points, motion.points)  # type: ignore[attr-defined]
    rest = make_trajectory(chain(), f"quintic:{named}")
    assert isinstance(rest, Quintic)
    np.testing.assert_array_equal(rest.points, motion.points)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0,1,2\n1,x,2\n", ':2: column 2: "x" is not a number; positions are in rad or m, t in s'),
        ("0,1,2\n1,nan,2\n", ':2: column 2: "nan"; every number must be finite'),
        ("0,1,2\n1,1e400,2\n", ':2: column 2: "1e400"; every number must be finite'),
        (
            "0,1,2\n1,2\n",
            ":2: 2 columns; expected 3: t and one position for each of 2 joints, separated by "
            "commas",
        ),
        ("0,1,2\n1,1,2\n1,1,2\n", ":3: t: 1 s follows 1 s; times must increase"),
        (
            "0;1;2\n1;1;2\n",
            ":1: columns separated by semicolons; a CSV file has commas between its columns, and a "
            "point in its numbers; replace them",
        ),
        (
            "t;link1.axis;link2.axis\n0;1,5;2\n",
            ":1: columns separated by semicolons; a CSV file has commas between its columns, and a "
            "point in its numbers; replace them",
        ),
        (
            "0\t1\t2\n1\t1\t2\n",
            ":1: columns separated by tabs; a CSV file has commas between its columns, and a "
            "point in its numbers; replace them",
        ),
        (
            "1e18,1,2\n1000000000000000010,1,2\n",
            ":2: t: 1e+18 s follows 1e+18 s; times must increase",
        ),
        (
            "t,link1.axis,link3.axis\n0,1,2\n",
            ':1: header: no joint "link3.axis"; did you mean "link2.axis"? '
            "known: link1.axis, link2.axis",
        ),
        (
            "t,link1.axis\n0,1\n",
            ":1: header: no column for link2.axis; every joint needs one",
        ),
        (
            "t,link1.axis,link1.axis\n0,1,1\n",
            ':1: header: joint "link1.axis" appears twice; name it once',
        ),
        (
            "time,link1.axis,link2.axis\n0,1,1\n",
            ':1: header: first column is "time"; must be t, then the joint names',
        ),
    ],
)
def test_a_wrong_row_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    file = write(tmp_path, text)
    with pytest.raises(DescriptionError) as caught:
        make_trajectory(chain(), file)
    assert str(caught.value) == f"{file}{message}"


NO_TABLE = (
    "line 1 is no row of a CSV file; a trajectory has t and one position for each of 2 joints, "
    "separated by commas"
)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "no rows; a trajectory has rows of t and one position per joint"),
        (
            b"t,link1.axis,link2.axis\n",
            "a header without rows; add rows of t and one position per joint",
        ),
        (b"\xff\xfe0,1", "not a text file in UTF-8; expected a CSV file"),
        (b"0,1\x00,2", "a binary file; expected a CSV file"),
        *(
            (secret, NO_TABLE)
            for secret in (
                b"-----BEGIN PRIVATE KEY-----\nabc\n",
                b'{"password": "x", "user": "y"}\n',
                b"root:x:0:0:root:/root:/bin/sh\n",
                b"%PDF-1.4, \x1b[31m, 3\n",
                "t\u202e, a, b\n".encode(),
                b"a" * 101 + b",1,2\n",
            )
        ),
    ],
)
def test_a_useless_file_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    file = tmp_path / "m.csv"
    file.write_bytes(content)
    with pytest.raises(FileError) as caught:
        make_trajectory(chain(), file)
    assert str(caught.value) == f"{file}: {message}"


def test_a_missing_file_is_refused() -> None:
    with pytest.raises(FileError) as caught:
        make_trajectory(chain(), "nowhere.csv")
    assert str(caught.value) == "nowhere.csv: no such file; give the path of a CSV file of t and q"


def test_an_unknown_trajectory_lists_those_known() -> None:
    with pytest.raises(ValueRangeError) as caught:
        make_trajectory(chain(), "papr")
    assert str(caught.value) == (
        'trajectory: no trajectory "papr"; did you mean "paper"? '
        "known: paper, quintic, FILE.csv, quintic:FILE.csv"
    )


def test_the_descriptions_own_motion_is_the_default(tmp_path: Path) -> None:
    sines = TrajectorySettings("sines", 3.0, amplitude=(0.1, 0.2), omega=(1.0,))
    motion = make_trajectory(replace(chain(), trajectory=sines))
    assert motion.duration == 3.0
    np.testing.assert_allclose(motion.sample([0.5])[0][0], np.sin(0.5) * np.array([0.1, 0.2]))
    quintic = TrajectorySettings("quintic", None, times=(0.0, 2.0), points=((0.0, 0.0), (1.0, 2.0)))
    motion = make_trajectory(replace(chain(), trajectory=quintic))
    assert motion.duration == 2.0
    np.testing.assert_allclose(motion.sample([1.0])[0][0], [0.5, 1.0])
    file = write(tmp_path, "0,1,2\n1,1.5,2.5\n")
    motion = make_trajectory(replace(chain(), trajectory=TrajectorySettings("csv", file=str(file))))
    assert isinstance(motion, Splined)


def test_a_trajectory_of_another_robot_is_refused() -> None:
    with pytest.raises(ShapeError, match='has 2 joints; robot "chain-3" has 3 joints'):
        make_trajectory(chain(3), Sines((1.0, 2.0), (1.0,)))


@pytest.mark.parametrize("duration", [0.0, -1.0, math.nan, math.inf])
def test_a_useless_duration_is_refused(duration: float) -> None:
    with pytest.raises(ValueRangeError, match="must be positive and finite"):
        check_duration(duration)


class Ends(Splined):
    """A motion of somebody else's that is not defined beyond its last row."""

    @property
    def end(self) -> float:
        return float(self.times[-1])


def test_a_run_longer_than_a_motion_that_ends_is_refused() -> None:
    motion = Ends(np.array([0.0, 1.0]), np.array([[0.0], [1.0]]))
    check_duration(1.0, motion)
    with pytest.raises(ValueRangeError) as caught:
        check_duration(2.0, motion)
    assert str(caught.value) == (
        "duration: 2 s is longer than the motion, which ends at 1 s; shorten it or add rows"
    )


def test_a_splined_motion_is_held_at_its_last_row() -> None:
    motion = Splined(np.array([0.0, 1.0, 2.0]), np.array([[0.0], [1.0], [0.5]]))
    q, dq, ddq = motion.sample([2.0, 2.0 + 1e-9, 50.0])
    np.testing.assert_allclose(q[:, 0], 0.5, atol=1e-15)
    assert dq[0, 0] != 0.0  # it comes to its last row under way
    assert dq[1:].tolist() == ddq[1:].tolist() == [[0.0], [0.0]]
    check_duration(50.0, motion)


@pytest.mark.parametrize("start", ["-4", "3", "1700000000.25"])
def test_a_file_may_start_at_any_time(tmp_path: Path, start: str) -> None:
    rows = [f"{float(start) + t!r},{q},0" for t, q in ((0.0, 0.0), (0.5, 0.3), (1.25, 0.1))]
    motion = make_trajectory(chain(), write(tmp_path, "\n".join(rows)))
    assert isinstance(motion, Splined)
    assert motion.times.tolist() == [0.0, 0.5, 1.25]
    assert motion.duration == 1.25
    np.testing.assert_allclose(motion.sample([0.0, 0.5])[0][:, 0], [0.0, 0.3], atol=1e-15)


def test_tabs_and_blanks_beside_commas_are_no_separators(tmp_path: Path) -> None:
    motion = make_trajectory(chain(), write(tmp_path, "0,\t1, 2\n1 ,1,\t2\n"))
    assert motion.duration == 1.0


def test_the_time_of_the_default_motion_is_that_of_the_file() -> None:
    own = replace(chain(), trajectory=TrajectorySettings("quintic", 25.0))
    for spec in (None, "quintic"):
        motion = make_trajectory(own, spec)
        assert isinstance(motion, Quintic)
        assert (motion.duration, len(motion.times)) == (25.0, 11)
    assert make_trajectory(chain(), "quintic").duration == 10.0
    assert make_trajectory(own, "quintic", 5.0).duration == 5.0


@pytest.mark.parametrize(
    ("times", "points", "message"),
    [
        ([0.0, 1.0], [[0.0]], r"trajectory points: expected shape \(2, n\), got \(1, 1\)"),
        ([0.0, np.nan], [[0.0], [1.0]], "trajectory times: .*every number must be finite"),
        ([0.0, 1.0], [[0.0], [np.inf]], "trajectory points: every number must be finite"),
        ([0.0, 2.0, 1.0], [[0.0]] * 3, "1 s follows 2 s; times must increase"),
        ([-1.0, 2.0], [[0.0]] * 2, "first is -1 s; a motion starts at 0 s"),
    ],
)
def test_impossible_waypoints_are_refused(
    times: list[float], points: list[list[float]], message: str
) -> None:
    with pytest.raises((ShapeError, ValueRangeError), match=message):
        Quintic(np.array(times), np.array(points))
