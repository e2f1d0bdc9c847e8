"""Results do not hang on the floating-point environment of the caller, and leave it as it was.

Each environment is tried in a process of its own: a rounding mode set, subnormals flushed, floating
point exceptions that trap, and a library built with fast-math loaded before or preloaded.
"""

from __future__ import annotations

import ctypes
import json
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from support.kernel.kernel_cases import by_extension, robots, states
from support.kernel.native import compiler
from support.kernel.python_cases import from_python
from support.timor_databases import base, bent_link, database, powerball
from support.urdf_texts import two_links, written

HERE = Path(__file__).parent
INSIDE = (
    '<origin xyz="0.1 0.2 0.3" rpy="0.7 0.11 -0.3"/><axis xyz="0.1 0.3 0.7"/>'
    '<limit lower="-2.1" upper="2.3" effort="31" velocity="1.7"/>'
    '<dynamics damping="0.1" friction="0.3"/>'
)
KINDS = ("upward", "downward", "towards_zero", "flushing", "flushing_upward", "trapping")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Holds the library of environment.c, one built with fast-math, and the expected results."""
    folder = tmp_path_factory.mktemp("environment")
    rng = np.random.default_rng(0)
    cases = [
        (robot, state, by_extension(robot, state))
        for robot in robots(3, 24)
        for state in states(rng, robot.n)
    ]
    written(folder, two_links(INSIDE))
    database(folder, powerball(), bent_link(), base())
    (folder / "cases").write_bytes(pickle.dumps((cases, from_python(folder))))
    cc = compiler("gcc")
    subprocess.run(
        [cc, "-O1", "-shared", "-fPIC", HERE / "environment.c", "-lm", "-o", folder / "fenv.so"],
        check=True,
    )
    # gcc 13 no longer links it into shared libraries by itself; others still carry it.
    startup = subprocess.check_output([cc, "-print-file-name=crtfastmath.o"], text=True).strip()
    subprocess.run(
        [cc, "-shared", "-fPIC", "-ffast-math", "-nostartfiles", startup, "-o", folder / "fast.so"],
        check=True,
    )
    return folder


def run(folder: Path, kind: str, preload: str = "") -> dict[str, Any]:
    answer = subprocess.run(
        [sys.executable, HERE / "environment_run.py", folder / "fenv.so", kind, folder],
        check=True,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(HERE.parent), "LD_PRELOAD": preload},
    )
    return json.loads(answer.stdout)


@pytest.mark.parametrize("kind", KINDS)
def test_each_environment_is_hostile(kind: str, folder: Path) -> None:
    """So that equality below means something: a sum, or a subnormal, differs from the usual."""
    fenv = ctypes.CDLL(str(folder / "fenv.so"))
    fenv.environment.restype = ctypes.c_uint64
    usual = fenv.environment()
    fenv[f"be_{kind}"]()
    changed = fenv.environment()
    fenv.be_normal()
    assert changed != usual
    assert fenv.environment() == usual


@pytest.mark.parametrize("kind", KINDS)
def test_results_and_the_callers_environment_are_as_ever(kind: str, folder: Path) -> None:
    answer = run(folder, kind)
    assert answer["wrong"] == []
    assert answer["changed"] == []


FIRST_USE = """
import ctypes, hashlib, sys, numpy
fenv = ctypes.CDLL(sys.argv[1])
fenv["be_" + sys.argv[2]]()
import modrobust as mr
robot = mr.load_robot("lwa4p-paper")
fenv.be_normal()
points = (robot.nominal, robot.lower, robot.upper)
parts = [robot.before, robot.after, robot.placement, *(point.packed for point in points)]
print(hashlib.sha256(b"".join(part.tobytes() for part in parts)).hexdigest())
"""


def test_the_first_use_may_be_in_any_environment(folder: Path) -> None:
    command = [sys.executable, "-c", FIRST_USE, str(folder / "fenv.so")]
    found = {
        kind: subprocess.run([*command, kind], check=True, stdout=subprocess.PIPE).stdout
        for kind in ("normal", *KINDS)
    }
    assert len(set(found.values())) == 1, found


def test_a_library_built_with_fast_math_changes_nothing(folder: Path) -> None:
    normal = run(folder, "given")
    answer = run(folder, "given", preload=str(folder / "fast.so"))
    assert answer["was"] != normal["was"]  # subnormals are flushed in all of that process
    assert answer["wrong"] == answer["changed"] == []
