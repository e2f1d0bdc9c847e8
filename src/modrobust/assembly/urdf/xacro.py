"""Expanding xacro in a process of its own: macros without end cost neither our time nor memory."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from modrobust.checks import unknown_name
from modrobust.errors import DescriptionError, FileError, MissingExtraError

_SECONDS = 30.0  # [s]
_FRAMES = ("when ", "included from", "in file", "instantiated from")  # of its messages
# xacro asks ROS's index for the folder of a package; ours answers first, with or without ROS.
_EXPAND = r"""
import json, re, resource, sys, types
resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
resource.setrlimit(resource.RLIMIT_CPU, (10, 10))
wanted = json.load(sys.stdin)
try:
    import ament_index_python.packages as index
    beyond = index.get_package_share_directory
except ImportError:
    index = types.ModuleType("ament_index_python.packages")
    sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
    sys.modules["ament_index_python.packages"] = sys.modules["ament_index_python"].packages = index
    beyond = None

def folder(name, *others, **more):
    if name in wanted["packages"]:
        return wanted["packages"][name]
    try:
        return beyond(name)
    except Exception:
        raise LookupError("no folder of package <" + name + ">") from None

index.get_package_share_directory = folder
import xacro
given = [f"{name}:={value}" for name, value in wanted["arguments"].items()]
sys.argv = ["xacro", "--", wanted["file"], *given]
xacro.main()
said = ""
for name in [wanted["file"], *getattr(xacro, "all_includes", [])]:
    with open(name, encoding="utf-8", errors="replace") as file:
        said += file.read()
known = set(re.findall(r"<xacro:arg\b[^>]*?\bname\s*=\s*[\"']([^\"']+)", said))
known |= set(re.findall(r"\$\(arg\s+(\w+)\s*\)", said))
unused = sorted(set(wanted["arguments"]) - known)
if unused:
    sys.exit("unused argument <" + unused[0] + "> of <" + " ".join(sorted(known)) + ">")
"""


def expanded(name: str, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> bytes:
    """The output of xacro.

    Args:
        name: The file.
        arguments: What its ``<xacro:arg>`` are, by name.
        packages: Folder of each package that ``$(find NAME)`` asks for, by name.

    Raises:
        MissingExtraError: The package xacro is not installed.
        DescriptionError: xacro fails, does not end, or has no such argument.
        FileError: xacro cannot be started.
    """
    if importlib.util.find_spec("xacro") is None:
        raise MissingExtraError(
            f"{name}: a xacro file, and the package that expands it is not installed; "
            'pip install "modrobust[xacro]", or expand it first: xacro FILE > robot.urdf'
        )
    wanted = {
        "file": name,
        "arguments": dict(arguments),
        "packages": {package: str(folder.absolute()) for package, folder in packages.items()},
    }
    try:
        done = subprocess.run(
            [sys.executable, "-c", _EXPAND],
            input=json.dumps(wanted).encode(),
            capture_output=True,
            timeout=_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise _fault(
            name,
            f"xacro did not end within {_SECONDS:g} s; a robot expands in one; look for a macro "
            "that calls itself",
        ) from None
    except OSError as error:
        raise FileError(name, f"xacro cannot be started: {error.strerror}") from None
    if done.returncode != 0:
        raise _fault(name, _reason(done.stderr.decode("utf-8", "replace")))
    return done.stdout


def _fault(name: str, message: str) -> DescriptionError:
    return DescriptionError(name, None, "", message)


def _reason(stderr: str) -> str:
    """What went wrong, from what xacro said, and what helps."""
    package = re.search(r"no folder of package <([^>]*)>", stderr)
    if package:
        return (
            f'xacro asks for the folder of package "{package[1]}", which is not known; give it '
            f"(packages: {{{package[1]}: FOLDER}}), or expand the file where its packages are "
            "installed: xacro FILE > robot.urdf"
        )
    unused = re.search(r"unused argument <([^>]*)> of <([^>]*)>", stderr)
    if unused:
        known = unused[2].split()
        told_name = unknown_name(f'no xacro argument "{unused[1]}"', unused[1], known)
        return f"{told_name}; correct or remove it"
    lines = [line.strip() for line in stderr.splitlines()]
    told = [line for line in lines if line and not line.startswith(_FRAMES)]
    said = (told[-1] if told else "no message")[:300]
    missing = re.search(r"Undefined substitution argument:? *(\w+)?", stderr)
    if missing:
        argument = missing[1] or "NAME"
        return (
            f"xacro cannot expand it: {said}; it takes an argument without a default; give it "
            f"(xacro: {{{argument}: ...}})"
        )
    return (
        f"xacro cannot expand it: {said}; expand it where its packages are installed: "
        "xacro FILE > robot.urdf"
    )
