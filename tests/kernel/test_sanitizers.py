"""The address and undefined-behaviour sanitizers find nothing in the kernel.

Workspaces, inputs and outputs are allocations of their exact sizes, see native.py.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.kernel.native import build, compile_objects, compiler

HERE = Path(__file__).parent
FLAGS = [
    "-O1",
    "-g",
    "-fsanitize=address,undefined,float-cast-overflow",
    "-fno-sanitize-recover=all",
]
OVERRUN = """
import ctypes, sys
from support.kernel.native import Memory
with Memory() as m:
    function = ctypes.CDLL(sys.argv[1]).mr_sum_and_one_more
    function(m.doubles([1.0, 2.0]), 2)
"""


def under_sanitizers(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Python with gcc's address sanitizer loaded first."""
    runtime = subprocess.check_output([compiler("gcc"), "-print-file-name=libasan.so"], text=True)
    if not os.path.isabs(runtime):
        pytest.skip("gcc has no libasan")
    env = {
        **os.environ,
        "LD_PRELOAD": runtime.strip(),
        "ASAN_OPTIONS": "detect_leaks=0",  # Python keeps what it has until the end
        "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE.parent)]),
    }
    return subprocess.run(
        [sys.executable, *arguments], text=True, capture_output=True, env=env, check=False
    )


def test_everything_that_the_kernel_computes_is_clean(tmp_path: Path) -> None:
    answer = under_sanitizers(HERE / "sanitizer_run.py", build("gcc", FLAGS, tmp_path))
    assert answer.returncode == 0, answer.stderr
    assert int(answer.stdout) > 1000


def test_a_step_beyond_an_array_is_found(tmp_path: Path) -> None:
    """So that the test above is able to fail."""
    objects = compile_objects("gcc", FLAGS, [HERE / "overrun.c"], tmp_path)
    library = tmp_path / "overrun.so"
    subprocess.run([compiler("gcc"), "-shared", FLAGS[2], *objects, "-o", library], check=True)
    answer = under_sanitizers("-c", OVERRUN, library)
    assert answer.returncode != 0
    assert "heap-buffer-overflow" in answer.stderr
