"""Why a loop diverged: joint, gain, inertia, hold and what helps, against figures worked out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import ControllerSettings
from modrobust.simulation.divergence import Divergence, find_divergence


@pytest.fixture(scope="module")
def diverged() -> mr.SimulationResult:
    return mr.simulate(mr.load_robot("lwa4p-paper"), rate=1e3, duration=0.5)


def test_the_light_wrist_is_named_with_its_gain_and_inertia(diverged: mr.SimulationResult) -> None:
    found = diverged.divergence
    assert found is not None
    assert (found.joint, found.kind, found.t, found.hold) == ("link6.axis", "revolute", 0.0, 1e-3)
    # At the first tick the integral is 0: k = kappa_P ‖rho‖ + phi_P.
    gains = diverged.controller
    gain = gains.kappa_P * np.linalg.norm(diverged.rho[0]) + gains.phi_P
    M = mr.mass_matrix(diverged.robot, diverged.q[0], parameters=diverged.parameters, drives=True)
    inertia = 1.0 / np.linalg.norm(np.linalg.inv(M), 2)
    assert found.gain == pytest.approx(gain, rel=1e-12)
    assert found.inertia == pytest.approx(inertia, rel=1e-9)
    assert found.share == pytest.approx(gain * 1e-3 / inertia, rel=1e-9)
    assert found.share is not None
    assert found.share > 2.0


def test_there_is_one_reason_and_no_consequence(diverged: mr.SimulationResult) -> None:
    limited = replace(diverged.robot, effort_limits=np.ones(6), velocity_limits=np.full(6, 9.0))
    run = mr.simulate(limited, rate=1e3, duration=0.5)
    assert run.diverged
    assert run.statistics is not None
    assert (run.statistics.tau_max > limited.effort_limits).all()
    assert run.remarks == []
    assert len(run.reasons) == 1
    assert run.reasons[0].startswith('the loop diverged at 0.013 s: joint "link6.axis": the gain ')
    assert 'what helps: the law "auto", which chooses gains for this rate' in run.reasons[0]
    assert "--" not in run.reasons[0]


def test_the_rate_that_is_named_makes_the_loop_hold(diverged: mr.SimulationResult) -> None:
    assert diverged.divergence is not None
    assert diverged.divergence.rate is not None
    again = mr.simulate(diverged.robot, rate=diverged.divergence.rate, duration=0.5)
    assert not again.diverged
    assert again.divergence is None
    assert again.summary()["divergence"] is None


def test_a_slide_has_its_own_units() -> None:
    found = Divergence("finger", "prismatic", 2e-3, 0.0, 60.0, 0.03, 4.0, 4e3, "componentwise")
    assert (
        'gain of law "componentwise", 60 N s/m, held for 2 ms, is 4 times the inertia of 0.03 kg '
    ) in found.cause
    assert found.remedy.startswith('the law "auto"')


def test_a_G_of_one_s_own_has_another_remedy() -> None:
    found = Divergence("finger", "prismatic", 2e-3, 0.0, 60.0, 0.03, 4.0, 4e3, "sampled")
    assert found.remedy == 'the law "auto" instead of a G of one\'s own, or a rate of 4 kHz'
    unknown = Divergence("finger", "prismatic", 2e-3, law="sampled")
    assert unknown.remedy == "a start nearer to the motion, or a slower one"


def test_a_G_that_is_too_large_is_named_with_its_joint() -> None:
    run = mr.simulate(mr.load_robot("lwa4p-paper"), law="sampled", G=4e3, rate=1e3, duration=0.5)
    assert run.diverged
    found = run.divergence
    assert found is not None
    assert found.law == "sampled"
    assert found.share is not None
    assert found.share > 2.0
    assert "instead of a G" in found.remedy


def test_the_integral_counts_from_the_tick_after_an_error() -> None:
    """kappa_I alone: no gain at first, 30 ‖rho‖ times 1 ms of error 0.5 at the second tick."""
    robot = mr.load_robot("lwa4p-paper")
    settings = ControllerSettings(
        (10.0,) * 6, kappa_P=0.0, kappa_I=30.0, phi_P=0.0, phi_I=0.0, epsilon=0.01
    )
    zeros = np.zeros((2, 6))
    rho = np.zeros((2, 6))
    rho[:, 0] = 1e4
    found = find_divergence(
        robot, robot.nominal, settings, 1e-3, np.array([0.0, 1e-3]), zeros, zeros,
        np.array([0.5, 0.005]), rho,
    )  # fmt: skip
    assert found.t == 1e-3
    assert found.gain == pytest.approx(30.0 * 0.5e-3 * 1e4)


@pytest.mark.parametrize("rows", [0, 1])
def test_what_the_gain_does_not_explain_is_said_so(rows: int) -> None:
    robot = mr.load_robot("lwa4p-paper")
    settings = ControllerSettings((10.0,) * 6, kappa_P=0.0, kappa_I=0.0, phi_P=0.0, phi_I=0.0)
    q, dq = np.zeros((rows, 6)), np.tile([0.0, 0.0, -9.0, 0.0, 1.0, 0.0], (rows, 1))
    found = find_divergence(
        robot, robot.nominal, settings, 1e-3, np.zeros(rows), q, dq, np.zeros(rows), q
    )
    assert found.joint == (robot.joint_names[2] if rows else None)
    assert found.gain is None
    assert "auto" in found.remedy
    assert "does not explain" in found.cause or "first steps" in found.cause
