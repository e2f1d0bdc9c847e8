"""The measuring program, compiled from the kernel's own sources on the machine that measures.

Compiled files are kept in the user's cache, under a key of everything that they are made from.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from modrobust.errors import MissingExtraError, ModrobustError

HERE = Path(__file__).parent
KERNEL = HERE.parents[1] / "kernel"

FLAGS = {
    "native": ("-O3", "-march=native"),
    "shipped": (),
}
"""What comes after the flags of flags.txt; "shipped" is what the installed extension has."""

# Pinocchio's variant of joints has 24 kinds, more than Boost's containers of types hold unasked.
PINOCCHIO_FLAGS = (
    "-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-w", "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)  # fmt: skip
MINUTES = "compiling Pinocchio's headers takes one to three minutes, once"
HEADERS_REMEDY = 'pip install "modrobust[peers]"'

Announce = Callable[[str], None]


class CompilerError(ModrobustError):
    """The compiler refused the measuring program; the message holds its first error."""


@dataclass(frozen=True)
class Toolchain:
    """A C and a C++ compiler."""

    cc: str
    cxx: str

    @property
    def version(self) -> str:
        """The first line of what the C compiler says of itself."""
        return _version(self.cc)


def toolchain() -> Toolchain:
    """The compilers that CC and CXX name, else cc and c++.

    Raises:
        MissingExtraError: There is none.
    """
    found = [os.environ.get(name, usual) for name, usual in (("CC", "cc"), ("CXX", "c++"))]
    for name in found:
        if shutil.which(name) is None:
            raise MissingExtraError(
                f"comparison in C: no compiler {name} on this machine; install gcc and g++ or "
                "clang, or name them in CC and CXX"
            )
    return Toolchain(*found)


def kernel_flags() -> list[str]:
    """Flags of the kernel, as CMake reads them."""
    lines = (KERNEL / "flags.txt").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line.startswith("-")]


def pinocchio_headers() -> list[Path]:
    """Include folders of Pinocchio, Boost and Eigen: those of the wheels, else the system's.

    Raises:
        MissingExtraError: One of them is nowhere; the message says how to get it.
    """
    prefixes = [Path(entry) / "cmeel.prefix" for entry in sys.path]
    prefixes += [Path(os.environ[key]) for key in ("CONDA_PREFIX",) if key in os.environ]
    prefixes += [Path("/usr/local"), Path("/usr")]
    folders = [p / "include" / sub for p in prefixes for sub in ("", "eigen3")]
    found = []
    for header in ("pinocchio/multibody.hpp", "boost/variant.hpp", "Eigen/Core"):
        folder = next((folder for folder in folders if (folder / header).is_file()), None)
        if folder is None:
            raise MissingExtraError(
                f"comparison with Pinocchio in C++: no header {header}; {HEADERS_REMEDY} brings it"
            )
        if folder not in found and folder != Path("/usr/include"):
            found.append(folder)
    return found


def program(tools: Toolchain, flags: str, peer: bool, announce: Announce | None = None) -> Path:
    """The compiled program; the first time with Pinocchio takes one to three minutes.

    Args:
        tools: The compilers.
        flags: A key of `FLAGS`.
        peer: Whether Pinocchio is linked.
        announce: Told when its compilation begins.

    Raises:
        CompilerError: It does not compile.
    """
    c = [tools.cc, *kernel_flags(), *FLAGS[flags], f"-I{KERNEL}", f"-I{HERE}"]
    sources = [HERE / "program.c", *sorted(KERNEL.glob("*.c"))]
    objects = [
        _compiled([*c, *(["-DWITH_PEER"] if peer and source.parent == HERE else [])], source)
        for source in sources
    ]
    if peer:
        includes = [f"-I{folder}" for folder in (KERNEL, HERE, *pinocchio_headers())]
        source = HERE / "pinocchio.cpp"
        objects.append(_compiled([tools.cxx, *PINOCCHIO_FLAGS, *includes], source, announce))
    link = [tools.cxx if peer else tools.cc, *map(str, objects), "-lm"]
    return _made(link, [*objects], "program")


def cache_folder() -> Path:
    """Where compiled files are kept: below XDG_CACHE_HOME, else below ~/.cache."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "modrobust" / "peers"


def _compiled(command: list[str], source: Path, announce: Announce | None = None) -> Path:
    made_of = [source, KERNEL / "mr_kernel.h", HERE / "peer.h"]
    if source.parent == KERNEL:
        made_of += sorted(KERNEL.glob("*.[ch]"))  # files of the kernel include each other
    command = [*command, "-c"]
    name = f"{source.stem}.o"
    if announce is not None and not _place(command, made_of, name).is_file():
        announce(MINUTES)
    return _made(command, made_of, name, [str(source)])


def _made(
    command: Sequence[str], made_of: Iterable[Path], name: str, sources: Sequence[str] = ()
) -> Path:
    """The file that a command makes, from the cache if it has been made from the same before."""
    place = _place(command, made_of, name)
    if place.is_file():
        return place
    place.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=place.parent) as folder:
        new = Path(folder) / name
        done = subprocess.run(
            [*command, *sources, "-o", str(new)], capture_output=True, text=True, check=False
        )
        if done.returncode:
            said = " ".join(done.stderr[max(done.stderr.find("error:"), 0) :].split())[:300]
            raise CompilerError(f"{command[0]} failed on {name}: {said}")
        new.replace(place)  # whole or not at all, if two processes compile at once
    return place


def _place(command: Sequence[str], made_of: Iterable[Path], name: str) -> Path:
    key = hashlib.sha256()
    for part in (_version(command[0]), _processor(), *command):
        key.update(part.encode() + b"\0")
    for path in made_of:
        key.update(path.read_bytes())
    return cache_folder() / key.hexdigest()[:24] / name


@cache
def _version(compiler: str) -> str:
    done = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False)
    return done.stdout.partition("\n")[0]


@cache
def _processor() -> str:
    """What -march=native means may change with the processor: a home can be shared by machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    return "".join(sorted({x for x in lines if x.startswith(("model name", "flags"))}))
