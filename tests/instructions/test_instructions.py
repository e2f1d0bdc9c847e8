"""A robust command costs no more instructions than stored; see instruction_counts.py."""

from __future__ import annotations

import json
import platform
import shutil

import pytest

from instructions.instruction_counts import CASES, STORED, count_all, gcc_version

MARGIN = 0.05
UPDATE = (
    "if that is meant, store the new counts: python tests/instructions/instruction_counts.py, and "
    "commit tests/data/instruction_counts.json; docs/measured/performance.md quotes them"
)


def test_a_command_costs_the_stored_number_of_instructions() -> None:
    for tool in ("gcc", "valgrind"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    if platform.machine() != "x86_64":
        pytest.skip("the stored counts are those of x86-64")
    compiler = f"gcc {gcc_version()}"
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    if compiler not in stored:
        pytest.skip(f"no counts are stored for {compiler}; stored: {', '.join(stored)}")
    assert set(stored[compiler]) == set(CASES), UPDATE
    for name, count in count_all().items():
        was = stored[compiler][name]
        change = (count - was) / was
        assert abs(change) <= MARGIN, (
            f"{name}: {count:.0f}, stored {was:.0f} ({change:+.1%}); {UPDATE}"
        )
