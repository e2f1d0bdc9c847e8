"""100,000 distinct cases: exact torques of random robots, states, parameters lie in the bounds.

Ten million and more: tests/containment/run.py.
"""

from __future__ import annotations

from itertools import count

import numpy as np
import pytest

from support.containment.ball_comparison import Outcome, check_state
from support.containment.containment_cases import run_seed
from support.containment.extreme_states import Signals
from support.containment.kinds import LEAST
from support.random_robots import point_robot, random_robot, random_state

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


def test_the_cases_are_of_every_kind(total: Outcome) -> None:
    """Else a generator that had lost its long robots or wide boxes would find no violation."""
    if total.cases < PARTS * CASES:
        pytest.skip("some parts of the cases were not run")
    answered = total.states - total.refused
    assert set(total.kinds) == set(LEAST)
    scarce = {k: n for k, n in total.kinds.items() if n < LEAST[k] * answered}
    assert scarce == {}


def test_points_that_coincide_count_once() -> None:
    """Else exact robots would be thirty cases each, all of them the same."""
    robot = point_robot(
        "rr",
        after=[np.eye(4)] * 2,
        mass=[1, 1],
        com=np.ones((2, 3)),
        inertia=[np.eye(3)] * 2,
    )
    rng = np.random.default_rng(0)
    signals = Signals(*rng.normal(size=(5, 2)))
    assert check_state(robot, signals, rng, "exact").cases == 1
    assert check_state(random_robot(rng, 2), signals, rng, "wide").cases > 10


def test_a_refused_state_is_no_case() -> None:
    """Else states that overflow would be the cheapest way to a hundred thousand."""
    rng = np.random.default_rng(0)
    q, dq, dq_a, ddq_a = random_state(rng, 2)
    outcome = check_state(random_robot(rng, 2), Signals(q, 1e200 * dq, q, dq_a, ddq_a), rng, "")
    assert (outcome.states, outcome.refused, outcome.cases, outcome.kinds) == (1, 1, 0, {})
