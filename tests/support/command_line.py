"""What starts the command line as a user does: a process of its own, in a folder of its own.

``MODROBUST_EXECUTABLE`` names the command to test; without it, the package of this interpreter.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

EXECUTABLE = os.environ.get("MODROBUST_EXECUTABLE")
COMMAND = [EXECUTABLE] if EXECUTABLE else [sys.executable, "-m", "modrobust"]


def environment(**changes: str) -> dict[str, str]:
    """The environment without what changes the output, or leads back to the checkout."""
    dropped = {"NO_COLOR", "FORCE_COLOR", "COLUMNS", "TTY_COMPATIBLE"}
    if EXECUTABLE:
        dropped |= {"PYTHONPATH", "VIRTUAL_ENV"}
    return {key: value for key, value in os.environ.items() if key not in dropped} | changes


def run_in(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run ``modrobust ARGUMENTS`` in a folder; neither end is a terminal."""
    return subprocess.run(
        [*COMMAND, *arguments],
        cwd=folder,
        env=environment(),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
