"""What the kernel promises of its memory, and of builds that it must not be trusted in."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from modrobust.model import synthetic_chain
from support.kernel.native import FLAGS, FOLDER, Memory, Native, build, compile_objects, compiler

SOURCES = sorted(FOLDER.glob("*.c"))
SIZES = ("precomputed", "prepared", "workspace", "batch_workspace")
OK = 0  # MR_OK
MACROS = ("__FAST_MATH__", "__RECIPROCAL_MATH__", "__ASSOCIATIVE_MATH__", "__NO_SIGNED_ZEROS__")


LICENCES = (  # what compilers may be told that the proof does not allow
    ["-ffinite-math-only"],
    ["-freciprocal-math"],
    ["-fno-signed-zeros"],
    ["-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"],
    ["-funsafe-math-optimizations"],
    ["-ffast-math"],
)


def compiles(*flags: str, name: str = "gcc") -> subprocess.CompletedProcess[str]:
    """Tries all of the kernel without writing anything."""
    command: list[str | Path] = [compiler(name), *FLAGS, *flags, "-fsyntax-only", *SOURCES]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def self_test_alone(name: str, flags: Sequence[str], out: Path) -> ctypes.CDLL:
    """The self-test and what it calls, since a build of all the kernel takes seconds."""
    sources = [FOLDER / f"mr_{part}.c" for part in ("self_test", "sincos", "environment")]
    objects = compile_objects(name, flags, sources, out)
    library = out / "self_test.so"
    subprocess.run([compiler(name), "-shared", *objects, "-lm", "-o", library], check=True)
    return ctypes.CDLL(str(library))


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


@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_fast_math_and_no_nan_do_not_compile(name: str) -> None:
    """Else NaN checks and the order of sums would be the compiler's to drop."""
    for flag in ("-ffast-math", "-ffinite-math-only"):
        answer = compiles(flag, name=name)
        assert answer.returncode != 0
        assert "compile without -ffast-math and its parts" in answer.stderr


@pytest.mark.parametrize("flags", LICENCES, ids=" ".join)
@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_the_self_test_sees_a_licence_without_its_macro(
    tmp_path: Path, name: str, flags: list[str]
) -> None:
    """Not every compiler says what it was allowed: the arithmetic itself must show it."""
    if name == "gcc" and "-fno-signed-zeros" in flags and len(flags) == 1:
        pytest.skip("gcc keeps the sign of the zero there, and has the macro")
    silent = [f"-U{macro}" for macro in MACROS] + ["-D__FINITE_MATH_ONLY__=0"]
    library = self_test_alone(name, [*flags, *silent], tmp_path)
    assert library.mr_self_test() != OK


@pytest.mark.parametrize("optimisation", ["-O0", "-O1", "-O2", "-O3"])
@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_the_self_test_answers_the_same_in_every_rounding_mode(
    tmp_path: Path, name: str, optimisation: str
) -> None:
    """Else a compiler that moves an operation past the restored mode would refuse a good build."""
    library = self_test_alone(name, [optimisation], tmp_path)
    source = str(Path(__file__).with_name("environment.c"))
    fenv_path = str(tmp_path / "fenv.so")
    command = [compiler(name), "-shared", "-fPIC", source, "-lm", "-o", fenv_path]
    subprocess.run(command, check=True)
    fenv = ctypes.CDLL(str(tmp_path / "fenv.so"))
    fenv.environment.restype = ctypes.c_uint64
    for kind in ("upward", "downward", "towards_zero", "flushing_upward", "trapping"):
        fenv[f"be_{kind}"]()
        before = fenv.environment()
        answer = library.mr_self_test()
        after = fenv.environment()
        fenv.be_normal()
        assert (kind, answer, before) == (kind, OK, after)


def test_the_self_test_refuses_fused_products(tmp_path: Path) -> None:
    """Else a build with contraction would load, with bounds whose rounding nobody counted."""
    if "fma" not in Path("/proc/cpuinfo").read_text().split():
        pytest.skip("this machine has no fused multiply-add")
    fused = self_test_alone("gcc", ["-march=native", "-ffp-contract=fast"], tmp_path)
    assert fused.mr_self_test() != OK
