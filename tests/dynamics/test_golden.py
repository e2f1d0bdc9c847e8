"""The dynamics equal the figures of the authors' own published program for the LWA 4P.

Two robots: one built here from the program's own D-H rows and link figures (so that it needs no
description file), and the built-in `lwa4p`, assembled from module files. Figures and their source:
tests/data/lwa4p_golden.json.
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Parameters, Robot
from modrobust.reference import link_frames, turn_z
from support.paths import ROOT
from support.random_robots import point_robot

GOLDEN = json.loads((ROOT / "tests" / "data" / "lwa4p_golden.json").read_text())
CASES = GOLDEN["cases"]
TOLERANCE = 1e-9  # [N m], [kg m^2]; the figures have 12 digits and an 11-digit pi


def dh_row(a: float, alpha: float, theta: float, d: float) -> Any:
    """Standard D-H without the joint: Rz(theta) Tz(d) Tx(a) Rx(alpha)."""
    T = np.eye(4)
    T[:3, :3] = turn_z(theta) @ np.roll(turn_z(alpha), (1, 1), (0, 1))
    T[:3, 3] = turn_z(theta) @ [a, 0, d]
    return T


def rows_robot() -> Robot:
    """The LWA 4P straight from the program's tables, with the Dissertation drives."""
    drive = np.array(GOLDEN["drives"]["Dissertation"])
    robot = point_robot(
        "r" * 6,
        after=np.array([dh_row(*row) for row in GOLDEN["dh"]]),
        mass=GOLDEN["mass"],
        com=GOLDEN["com"],
        inertia=GOLDEN["inertia"],
    )
    point = with_drives(robot.nominal, drive)
    return replace(robot, gear_ratio=drive[:, 0], nominal=point, lower=point, upper=point)


def with_drives(parameters: Parameters, drive: Any) -> Parameters:
    """The parameters with a drive table: gear ratio, rotor inertia, viscous, Coulomb."""
    rotor_inertia, viscous, coulomb = np.array(drive).T[1:]
    return replace(parameters, rotor_inertia=rotor_inertia, viscous=viscous, coulomb=coulomb)


@pytest.fixture(scope="module", params=["rows", "modules"])
def robot(request: pytest.FixtureRequest) -> Robot:
    return rows_robot() if request.param == "rows" else mr.load_robot("lwa4p")


@pytest.fixture(params=range(len(CASES)))
def case(request: pytest.FixtureRequest) -> dict[str, Any]:
    return {k: np.array(v) for k, v in CASES[request.param].items()}


def assert_close(actual: Any, golden: Any) -> None:
    np.testing.assert_allclose(actual, golden, rtol=0, atol=TOLERANCE)


def test_mass_matrix_equals_the_published_program(robot: Robot, case: dict[str, Any]) -> None:
    assert_close(mr.mass_matrix(robot, case["q"], drives=False), case["M"])


def test_gravity_torque_equals_the_published_program(robot: Robot, case: dict[str, Any]) -> None:
    zero = np.zeros(6)
    tau = mr.inverse_dynamics(robot, case["q"], zero, zero, zero, drives=False)
    assert_close(tau, case["gravity"])


def test_newton_euler_equals_the_published_program(robot: Robot, case: dict[str, Any]) -> None:
    q, dq, ddq = case["q"], case["dq"], case["ddq"]
    assert_close(mr.inverse_dynamics(robot, q, dq, dq, ddq, drives=False), case["rnea"])


def test_modified_newton_euler_equals_the_published_program_velocities_exchanged(
    robot: Robot, case: dict[str, Any]
) -> None:
    q, dq, dq_a, ddq = case["q"], case["dq"], case["dq_a"], case["ddq"]
    tau = mr.inverse_dynamics(robot, q, dq_a, dq, ddq, drives=False)
    assert_close(tau, case["ne_modified"])
    as_printed = mr.inverse_dynamics(robot, q, dq, dq_a, ddq, drives=False)
    assert np.abs(as_printed - case["ne_modified"]).max() > 1e-5  # the exchange is seen


@pytest.mark.parametrize("drives", ["Papers", "Dissertation"])
def test_drive_torques_equal_the_published_program(
    robot: Robot, case: dict[str, Any], drives: str
) -> None:
    # friction and rotor inertia take dq and ddq, whichever way round the program's velocities are
    q, dq, ddq = case["q"], case["dq"], case["ddq"]
    parameters = with_drives(robot.nominal, GOLDEN["drives"][drives])
    full = mr.inverse_dynamics(robot, q, dq, dq, ddq, parameters=parameters, drives=True)
    rigid = mr.inverse_dynamics(robot, q, dq, dq, ddq, parameters=parameters, drives=False)
    assert_close(full - rigid, case[f"full_{drives}"] - case["ne_modified"])
    inertia = mr.mass_matrix(robot, q, parameters=parameters, drives=True) - case["M"]
    ratio = np.array(GOLDEN["drives"][drives])[:, 0]
    assert_close(inertia, np.diag(ratio**2 * parameters.rotor_inertia))


def test_the_robot_has_the_dissertation_drives_as_its_nominal(
    robot: Robot, case: dict[str, Any]
) -> None:
    q, dq, ddq = case["q"], case["dq"], case["ddq"]
    drive = mr.inverse_dynamics(robot, q, dq, dq, ddq) - case["rnea"]
    assert_close(drive, case["full_Dissertation"] - case["ne_modified"])


def test_the_last_link_frame_is_where_the_published_program_has_it(case: dict[str, Any]) -> None:
    assert_close(link_frames(rows_robot(), case["q"])[-1], case["tip"])
