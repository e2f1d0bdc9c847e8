"""The worked joint of docs/theory/rounding.md: every number of its table, and the exact range."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import modrobust as mr
from modrobust.model import Robot
from support.paths import ROOT
from support.random_robots import point_robot
from support.rounding import slack

PAGE = (ROOT / "docs" / "theory" / "rounding.md").read_text(encoding="utf-8")
KERNEL = ROOT / "src" / "modrobust" / "kernel"
U = 2.0**-53
G, LEVER, COM, DDQ_A = 9.81, 0.3, 0.5, 3.0  # [m/s^2], [m], [m], [rad/s^2]
MASS, CHANGE = 2.0, 0.4  # [kg]
X = LEVER + COM


def worked() -> Robot:
    """One joint about -y of the base with a body of 2 kg +- 0.4 kg."""
    before, after = np.eye(4), np.eye(4)
    before[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    after[0, 3] = LEVER
    robot = point_robot(
        "r", after=[after], mass=[MASS], com=[[COM, 0, 0]], inertia=[np.zeros((3, 3))]
    )
    lower, upper = (
        replace(robot.nominal, mass=np.array([MASS + sign * CHANGE])) for sign in (-1, 1)
    )
    return replace(
        robot,
        base=np.eye(4),
        before=before[None],
        placement=np.eye(4)[None],
        lower=lower,
        upper=upper,
    )


STATE = (np.zeros(1), np.zeros(1), np.zeros(1), np.array([DDQ_A]))


def column() -> dict[str, str]:
    """First and last column of the page's table, without units."""
    section = PAGE.split("## One revolute joint in numbers")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (.+?) \| .+ \| (.+?) \|$", section, re.MULTILINE)
    return {name: value.partition(" ")[0] for name, value in rows}


def test_every_value_of_the_table_is_computed() -> None:
    a = G + DDQ_A * X
    A = (G + DDQ_A * LEVER) + G
    force = A + DDQ_A * X
    N, dN = MASS * force * X, CHANGE * force * X
    least = U * (159 * N + 686 * dN)
    values = {
        "acceleration of the COM": a,
        "nominal torque, (16)": MASS * X * a,
        "$f_0$, (18)": X * a,
        "range, (18)": (MASS - CHANGE) * X * a,
        "$K$": DDQ_A,
        "$A$": A,
        "$N$": N,
        r"$\Delta N$": dN,
        "rates": 66 + 90 + 1 + 2,
        "slack, (26)": least,
        "of the width": 2 * least / (2 * CHANGE * X * a),
    }
    shown = column()
    assert {name: shown[name] for name in values} == {
        name: f"{value:.2g}" if name == "of the width" else f"{value:.6g}"
        for name, value in values.items()
    }
    assert f"to {(MASS + CHANGE) * X * a:.6g} N m" in PAGE
    assert f"{66 + 90 + 1 + 2} and {183 + 500 + 1 + 2} |" in PAGE


def test_the_kernel_has_the_slack_and_the_torques_of_the_table() -> None:
    robot, shown = worked(), column()
    assert mr.inverse_dynamics(robot, *STATE)[0] == pytest.approx(19.536, rel=1e-15)
    stated = float(shown["slack, (26)"])
    assert slack(robot, *STATE, drives=False)[0] == pytest.approx(stated, rel=5e-6)


def test_the_bounds_contain_the_exact_range_and_need_a_hundredth_of_the_slack() -> None:
    robot = worked()
    lo, hi = mr.inverse_dynamics_bounds(robot, *STATE)
    lever = Fraction(LEVER) + Fraction(COM)
    per_mass = lever * (Fraction(G) + Fraction(DDQ_A) * lever)
    exact = [Fraction(p.mass[0]) * per_mass for p in (robot.lower, robot.upper)]
    moved = Fraction(slack(robot, *STATE, drives=False)[0])
    assert Fraction(lo[0]) < exact[0]
    assert exact[1] < Fraction(hi[0])
    for end, real in zip((Fraction(lo[0]) + moved, Fraction(hi[0]) - moved), exact, strict=True):
        assert abs(end - real) < moved / 100


def test_every_function_and_test_that_a_lemma_names_is_there() -> None:
    lines = re.findall(r"^\*Code:\*(.*?)(?=\n\n)", PAGE, re.MULTILINE | re.DOTALL)
    assert len(lines) == PAGE.count("*Code:*") == PAGE.count("*Test:*") >= 16
    for line in lines:
        code, _, tests = line.partition("*Test:*")
        for names, files in re.findall(r"((?:`\w+`,? ?\n?)+)\s*in ((?:`\w+\.[ch]`[, ]*)+)", code):
            text = "".join(
                (KERNEL / file).read_text(encoding="utf-8")
                for file in re.findall(r"`([^`]+)`", files)
            )
            for name in re.findall(r"`(\w+)`", names):
                assert re.search(rf"\b{name}\b", text), (name, files)
        for path in re.findall(r"`(tests/[^`]+)`", tests):
            assert (ROOT / path).is_file(), path
    symbols = PAGE.split("## Symbols")[1].split("\n\n")[1]
    kernel = "".join(path.read_text(encoding="utf-8") for path in KERNEL.glob("*.[ch]"))
    for name in re.findall(r"`(\w+)`", symbols):
        assert re.search(rf"\b{name}\b", kernel), name
