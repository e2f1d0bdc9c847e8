"""Runs the command line as a user does: a process of its own, in a folder of its own.

``MODROBUST_EXECUTABLE`` names the command to test; without it, the package of this interpreter.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

EXECUTABLE = os.environ.get("MODROBUST_EXECUTABLE")
COMMAND = [EXECUTABLE] if EXECUTABLE else [sys.executable, "-m", "modrobust"]

Run = Callable[..., "subprocess.CompletedProcess[str]"]


def environment() -> dict[str, str]:
    """The environment without what changes the output, or leads back to the checkout."""
    dropped = {"NO_COLOR", "FORCE_COLOR", "COLUMNS", "TTY_COMPATIBLE"}
    if EXECUTABLE:
        dropped |= {"PYTHONPATH", "VIRTUAL_ENV"}
    return {key: value for key, value in os.environ.items() if key not in dropped}


@pytest.fixture
def command() -> list[str]:
    """The command under test, to start a process with."""
    return COMMAND


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Runs ``modrobust ARGUMENTS`` in the test's folder."""

    def run_modrobust(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(  # type: ignore[call-overload, no-any-return]
            [*COMMAND, *arguments],
            **{
                "cwd": tmp_path,
                "env": environment(),
                "capture_output": True,
                "text": True,
                "stdin": subprocess.DEVNULL,
                "timeout": 120,
                **options,
            },
        )

    return run_modrobust
