"""Shows at the end of a run how much of the slack exact torques needed."""

from __future__ import annotations

import pytest

from support.containment.ball_comparison import Outcome

TOTAL = Outcome()


@pytest.fixture
def total() -> Outcome:
    """The sum of all outcomes of the run."""
    return TOTAL


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if TOTAL.cases:
        terminalreporter.write_line(f"containment: {TOTAL.summary()}")
