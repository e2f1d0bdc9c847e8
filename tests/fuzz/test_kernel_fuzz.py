"""A short run of the kernel's fuzz target, from the catalogue's robots; `make fuzz` goes on."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from fuzz import kernel_target
from fuzz.kernel_seeds import write_seeds

SECONDS = 8


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return kernel_target.build(tmp_path_factory.mktemp("target"))


def test_the_kernel_keeps_its_promises_on_any_input(target: Path, tmp_path: Path) -> None:
    seeds, grown = tmp_path / "seeds", tmp_path / "grown"
    assert write_seeds(seeds) >= 8
    grown.mkdir()
    answer = subprocess.run(
        [target, f"-max_total_time={SECONDS}", "-seed=1", *kernel_target.OPTIONS, grown, seeds],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert answer.returncode == 0, answer.stderr[-4000:]
    assert len(os.listdir(grown)) > 50  # it found ways through the kernel beyond the seeds'
