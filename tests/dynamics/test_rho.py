"""The norm of rho against the largest norm of w.

benchmarks/rho.py and docs/theory/guarantees.md agree.
"""

from __future__ import annotations

import sys

import pytest

from modrobust.model import Robot
from support.paths import ROOT

sys.path.insert(0, str(ROOT / "benchmarks"))

import rho

OVER = 1.01  # docs/theory/guarantees.md, "How tight": 1.004 and 1.005 on average over 100 states


@pytest.mark.parametrize("robot", [rho.paper_robot(), rho.uncertain_robot()], ids=["table", "all"])
def test_the_norm_of_rho_is_hardly_more_than_the_largest_norm_of_w(robot: Robot) -> None:
    ratio = rho.over_estimates(robot, 4)
    assert (ratio >= 1.0).all()
    assert ratio.max() <= OVER
