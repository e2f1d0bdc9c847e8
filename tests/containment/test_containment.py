"""100,000 cases: exact torques of random robots, states and parameters lie within the bounds.

Ten million and more: tests/containment/run.py.
"""

from __future__ import annotations

from itertools import count

import pytest
from ball_comparison import Outcome
from containment_cases import run_seed

PARTS = 20
CASES = 5_000  # a part


@pytest.mark.parametrize("part", range(PARTS))
def test_exact_torques_lie_within_the_bounds(part: int, total: Outcome) -> None:
    found = Outcome()
    for seed in count(1_000_000 * (part + 1)):
        found.add(run_seed(seed))
        if found.cases >= CASES:
            break
    total.add(found)
    assert not found.violations, "\n".join(found.violations[:20])
    assert found.refused < 0.1 * found.states  # rates of 1e100 may overflow, others may not
    assert 0.0 < found.used_hull < 1.0
    assert 0.0 < found.used_rounding < 1.0
