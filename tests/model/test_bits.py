"""The same file gives the same bits on every machine: no BLAS nor libm on the way to a bound.

What is tried is what changes code by the processor: OpenBLAS's kernels, NumPy's vector code, the
variants of the C library. What is read is that nobody calls them between a file and its arrays.
"""

from __future__ import annotations

import ast
import hashlib
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.motion.trajectory import paper_trajectory
from modrobust.timor import import_timor
from support.paths import ROOT
from support.states import state_of
from support.timor_databases import base, bent_link, database, powerball
from support.urdf_texts import two_links, written

PACKAGE = Path(mr.__file__).parent
# Reports, searches, pictures, exports and plants of other engines: behind the bound, or beside it.
BESIDE = {
    "bench",
    "campaign",
    "cli",
    "design",
    "export",
    "pictures",
    "reference",
    "assembly.magnitudes",
    "assembly.summary",
    "model.orientation",
    "control.rate",
    "simulation.divergence",
    "simulation.integration",
    "simulation.metrics",
    "simulation.plants",
    "simulation.remarks",
    "simulation.result",
}
TRANSFORMS = {  # their @ is that of `Transform`
    "assembly.construction",
    "assembly.load",
    "assembly.options",
    "assembly.urdf.robot",
    "assembly.urdf.tree",
    "model.dh",
    "model.geometry",
    "timor.importer",
}
LIBM = {"sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "pow", "arctan2",
        "arcsin", "arccos", "arctan", "power", "float_power", "cbrt", "dot", "vdot", "inner",
        "matmul", "einsum", "tensordot", "linalg"}  # fmt: skip
NAMES = ("lwa4p", "lwa4p-payload", "scara")  # quick ones, with tensors whose axes are turned
URDF = (
    '<origin xyz="0.1 0.2 0.3" rpy="0.7 0.11 -0.3"/><axis xyz="0.1 0.3 0.7"/>'
    '<limit lower="-2.1" upper="2.3" effort="31" velocity="1.7"/>'
)


def packed(folder: Path) -> dict[str, bytes]:
    """Bits of robots, of points of their boxes, of bounds and of a motion, by name."""
    found: dict[str, bytes] = {}
    overlay = "links: {arm: {inertia: {xx: 0.021, yy: 0.03, zz: 0.012, xy: 1e-4 ± 10%}}}\n"
    urdf = written(folder, two_links(URDF))
    (folder / "over.yaml").write_text(
        f"modrobust: 1\nrobot: over\nurdf: {urdf.name}\n{overlay}tolerance: {{inertia: 10%}}\n"
    )
    places: list[str | Path] = [*NAMES, urdf, folder / "over.yaml"]
    for robot in (mr.load_robot(place) for place in places):
        name, b = robot.name, hashlib.sha256()
        points = [robot.nominal, robot.lower, robot.upper, robot.sample_parameters(1)]
        points += [robot.physical_corner(which, 1)[0] for which in ("lower", "upper", "corner")]
        b.update(repr(robot.to_dict()).encode())
        found[f"{name}, file"] = b.digest()
        found[f"{name}, points"] = b"".join(point.packed.tobytes() for point in points)
        state = state_of(np.random.default_rng(2).uniform(-1.0, 1.0, (4, robot.n)))
        bounds = (mr.inverse_dynamics_bounds(robot, *state, bound=m) for m in ("hull", "ianea"))
        found[f"{name}, bounds"] = b"".join(end.tobytes() for pair in bounds for end in pair)
    sines = paper_trajectory(mr.load_robot("lwa4p-paper"))
    found["motion"] = b"".join(x.tobytes() for x in sines.sample(np.linspace(0.0, 10.0, 1001)))
    modules = import_timor(database(folder, powerball(), bent_link(), base())).modules
    found["timor"] = "".join(module.text for module in modules).encode()
    return found


def main(folder: str) -> None:
    """Prints what `packed` has, by name; for a process of another environment."""
    for name, data in packed(Path(folder)).items():
        print(f"{name}: {hashlib.sha256(data).hexdigest()}")


def environments() -> dict[str, dict[str, str]]:
    """Variables that make the libraries take other code; only what this processor has."""
    flags = set(Path("/proc/cpuinfo").read_text().split()) if sys.platform == "linux" else set()
    needs = {"Prescott": "sse2", "Nehalem": "sse4_2", "Sandybridge": "avx", "Haswell": "avx2",
             "Zen": "avx2", "SkylakeX": "avx512vl", "NEOVERSEN1": "asimddp"}  # fmt: skip
    found = {
        f"OpenBLAS as on {core}": {"OPENBLAS_CORETYPE": core}
        for core, flag in needs.items()
        if flag in flags
    }
    wide = ("AVX512F", "AVX512CD", "AVX512_SKX", "AVX2", "FMA3")
    found["NumPy without wide registers"] = {"NPY_DISABLE_CPU_FEATURES": " ".join(wide)}
    unusual = "-AVX2,-FMA,-FMA4,-AVX512F,-AVX2_Usable,-FMA_Usable"
    found["C library without fused products"] = {"GLIBC_TUNABLES": f"glibc.cpu.hwcaps={unusual}"}
    return found


def test_every_code_path_of_the_libraries_gives_the_same_bits(tmp_path: Path) -> None:
    program = "import sys; from model import test_bits; test_bits.main(sys.argv[1])"
    command = [sys.executable, "-W", "ignore", "-c", program, str(tmp_path)]
    expected = [f"{k}: {hashlib.sha256(v).hexdigest()}" for k, v in packed(tmp_path).items()]
    for name, variables in environments().items():
        answer = subprocess.run(
            command,
            check=True,
            capture_output=True,
            text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT / "tests"), **variables},
        )
        assert answer.stdout.splitlines() == expected, name


def test_nobody_calls_numpy_linalg_on_the_way_to_a_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(name: str) -> Callable[..., Any]:
        def called(*_: Any, **__: Any) -> None:
            raise AssertionError(f"numpy.linalg.{name} was called")

        return called

    for name in np.linalg.__all__:
        if callable(getattr(np.linalg, name)) and name != "LinAlgError":
            monkeypatch.setattr(np.linalg, name, refuse(name))
    assert packed(tmp_path)


def test_nothing_before_the_bound_names_blas_or_libm() -> None:
    for path in PACKAGE.rglob("*.py"):
        module = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        if {module, module.split(".")[0]} & BESIDE:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            place = f"{path.name}:{getattr(node, 'lineno', 0)}"
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
                assert module in TRANSFORMS, place
            if isinstance(node, ast.Attribute) and node.attr in LIBM:
                of_libraries = isinstance(node.value, ast.Name) and node.value.id in ("np", "math")
                assert not of_libraries or allowed(module, node.attr), place


def allowed(module: str, name: str) -> bool:
    """A start that is made exact, and what no bit of a result comes from."""
    return (module, name) == ("model.geometry", "atan2")
