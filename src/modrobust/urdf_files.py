"""Which file a URDF is, and its tree: plain, from an installed package, or expanded from xacro."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import subprocess
import sys
from pathlib import Path, PurePosixPath

from modrobust.errors import DescriptionError, FileError, MissingExtraError
from modrobust.formats.overlay import UrdfSource
from modrobust.urdf_xml import Element, parse_xml, read_bytes

PACKAGE = "package:"
_XACRO_SECONDS = 30.0  # [s]
_FRAMES = ("when ", "included from", "in file", "instantiated from")  # of its messages
# In a process of its own, so that macros without end cost neither our time nor our memory.
_EXPAND = (
    "import resource, sys; resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30)); "
    "resource.setrlimit(resource.RLIMIT_CPU, (10, 10)); "
    "import xacro; xacro.main()"
)


def find_file(source: UrdfSource) -> Path:
    """The file that `source` names.

    Raises:
        DescriptionError: ``package:NAME/PATH`` names no installed package, or no file of it.
    """
    if not source.file.startswith(PACKAGE):
        return source.directory / source.file
    name, _, inside = source.file.removeprefix(PACKAGE).partition("/")
    path = PurePosixPath(inside)
    if not name or not inside or path.is_absolute() or ".." in path.parts:
        raise source.where.error(
            "urdf",
            f'"{source.file[:200]}" is not package:NAME/PATH with a path inside the package; '
            "write e.g. package:example_robot_data/robots/ur_description/urdf/ur5_robot.urdf",
        )
    try:
        files = importlib.metadata.files(name) or []
    except (importlib.metadata.PackageNotFoundError, ValueError):
        raise source.where.error(
            "urdf",
            f'package "{name[:80]}" is not installed; its URDF comes with it; '
            f"pip install {name[:80].replace('_', '-')}",
        ) from None
    # Wheels put data where they like: in the package, or in a prefix beside it.
    found = sorted({str(file.locate()) for file in files if _ends_with(file.parts, path.parts)})
    if len(found) != 1:
        what = "no file" if not found else f"{len(found)} files"
        raise source.where.error(
            "urdf",
            f'package "{name}" has {what} whose path ends in "{inside[:200]}"; give the path of '
            "one file inside the package",
        )
    return Path(found[0])


def _ends_with(parts: tuple[str, ...], tail: tuple[str, ...]) -> bool:
    return parts[-len(tail) :] == tail


def load_tree(path: Path, source: UrdfSource) -> Element:
    """The XML tree of a URDF or xacro file.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: It is not one plain XML document, or xacro cannot expand it.
        MissingExtraError: It is xacro and that package is not installed.
    """
    name = str(path)
    tree = parse_xml(read_bytes(path), name)
    if path.suffix.lower() != ".xacro":
        return tree
    if importlib.util.find_spec("xacro") is None:
        raise MissingExtraError(
            f"{name}: a xacro file, and the package that expands it is not installed; "
            'pip install "modrobust[xacro]", or expand it first: xacro FILE > robot.urdf'
        )
    return parse_xml(_expanded(name), f"{name} (expanded)")


def _expanded(name: str) -> bytes:
    """The output of xacro.

    Raises:
        DescriptionError: xacro fails, or does not end.
        FileError: Its output is no text.
    """
    try:
        done = subprocess.run(
            [sys.executable, "-c", _EXPAND, "--", name],
            capture_output=True,
            timeout=_XACRO_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise DescriptionError(
            name,
            None,
            "",
            f"xacro did not end within {_XACRO_SECONDS:g} s; a robot expands in one; look for a "
            "macro that calls itself",
        ) from None
    except OSError as error:
        raise FileError(name, f"xacro cannot be started: {error.strerror}") from None
    if done.returncode != 0:
        lines = [line.strip() for line in done.stderr.decode("utf-8", "replace").splitlines()]
        told = [line for line in lines if line and not line.startswith(_FRAMES)]
        said = told[-1] if told else "no message"
        raise DescriptionError(
            name,
            None,
            "",
            f"xacro cannot expand it: {said[:300]}; expand it where its packages are installed: "
            "xacro FILE > robot.urdf",
        )
    return done.stdout
