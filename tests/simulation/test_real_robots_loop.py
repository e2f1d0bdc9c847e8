"""Real robots in the closed loop: 5 % uncertainty, random true parameters, no violation."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.real_robots import LOADED, located
from support.uncertain_robots import REFLECTED, SETTINGS, START, run, with_uncertainty

MOTION = 2.0  # [s]
# The 101 joints of one of them take 0.8 ms a tick.
DURATION = {"tiago_dual": 0.05}  # [s]
ENOUGH = 0.2  # [s]


@pytest.mark.parametrize(
    ("package", "name"), [(package, name) for package, names in LOADED.items() for name in names]
)
def test_the_bound_holds_on_a_real_robot_with_random_parameters(
    package: str, name: str, tmp_path: Path
) -> None:
    robot = with_uncertainty(located(package, name), tmp_path)
    result = run(robot, MOTION, DURATION.get(name, ENOUGH))
    assert result.settings["parameters_inside_bounds"]
    assert not result.diverged
    assert result.statistics is not None
    assert result.statistics.violations == 0
    assert result.statistics.rho_max > 0
    assert result.statistics.error_last < START
    if name not in DURATION:
        assert result.epsilon_entered_at is not None
        assert result.statistics.error_max_after < SETTINGS["epsilon"]


def test_the_overlay_reaches_the_robot(tmp_path: Path) -> None:
    robot = with_uncertainty(located("example-robot-data", "ur5_robot"), tmp_path)
    assert robot.upper.mass == pytest.approx(1.05 * robot.nominal.mass)
    assert robot.lower.com == pytest.approx(robot.nominal.com - 5e-3)
    assert (robot.nominal.rotor_inertia == REFLECTED).all()
    assert (robot.lower.rotor_inertia < REFLECTED).all()
