"""What the kernel promises of its memory, and of builds that it must not be trusted in."""

from __future__ import annotations

import ctypes
import subprocess
from pathlib import Path

import pytest
from native import FLAGS, FOLDER, Memory, Native, build, compiler

from modrobust.synthetic import synthetic_chain

SOURCES = sorted(FOLDER.glob("*.c"))
SIZES = ("folded", "prepared", "workspace", "batch_workspace")
OK = 0  # MR_OK


def compiles(*flags: str) -> subprocess.CompletedProcess[str]:
    """Tries all of the kernel without writing anything."""
    command = [compiler("gcc"), *FLAGS, *flags, "-fsyntax-only", *SOURCES]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_memory_grows_with_the_joints_and_no_faster(tmp_path: Path) -> None:
    """Else an array of joints times joints would make long robots fail, and no short one tells."""
    library = ctypes.CDLL(str(build("gcc", ["-O0"], tmp_path)))
    sizes = []
    for n in (64, 128, 192):  # whole registers of any width
        with Memory() as memory:
            native = Native(library, synthetic_chain(n), memory)
            sizes.append([native.size(name) for name in SIZES])
    for name, one, two, three in zip(SIZES, *sizes, strict=True):
        assert three - two == two - one > 0, name


def test_no_array_has_a_variable_length() -> None:
    """Else a long robot could run over the stack, which no workspace size tells of."""
    answer = compiles("-Wvla", "-Werror=vla")
    assert answer.returncode == 0, answer.stderr


def test_fast_math_does_not_compile() -> None:
    """Else NaN checks and the order of sums would be the compiler's to drop."""
    answer = compiles("-ffast-math")
    assert answer.returncode != 0
    assert "#error" in answer.stderr


def test_the_self_test_refuses_fused_products(tmp_path: Path) -> None:
    """Else a build with contraction would load, with bounds whose rounding nobody counted."""
    if "fma" not in Path("/proc/cpuinfo").read_text().split():
        pytest.skip("this machine has no fused multiply-add")
    fused = ctypes.CDLL(str(build("gcc", ["-march=native", "-ffp-contract=fast"], tmp_path)))
    assert fused.mr_self_test() != OK
