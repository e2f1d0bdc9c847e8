"""What a command imports is what it needs: most of the time of a short command is imports."""

import subprocess
import sys

import pytest


def imported(*arguments: str) -> set[str]:
    command = [sys.executable, "-X", "importtime", "-m", "modrobust", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return {line.rsplit("|")[-1].strip() for line in done.stderr.splitlines()}


@pytest.mark.parametrize(
    ("arguments", "needed", "needless"),
    [
        (["--help"], {"typer"}, {"numpy", "pydantic", "ruamel.yaml", "rich.console"}),
        (
            ["assemble", "lwa4p-paper"],
            {"numpy", "pydantic", "rich.console", "modrobust.model.orientation"},
            {"lxml.etree", "yourdfpy", "mujoco", "scipy", "xml.etree", "modrobust.export.mjcf",
             "modrobust.assembly.urdf.robot", "modrobust.simulation.run"},
        ),
    ],
)  # fmt: skip
def test_a_short_command_imports_what_it_needs(
    arguments: list[str], needed: set[str], needless: set[str]
) -> None:
    found = imported(*arguments)
    assert needed <= found
    assert not needless & found
