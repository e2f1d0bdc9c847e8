"""The command line in the test's own folder."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from support.command_line import run_in

Run = Callable[..., CompletedProcess[str]]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Runs ``modrobust ARGUMENTS`` in the test's folder."""
    return partial(run_in, tmp_path)
