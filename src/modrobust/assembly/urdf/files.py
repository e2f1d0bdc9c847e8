"""Which file a URDF is, and its tree: plain, from an installed package, or expanded from xacro."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path, PurePosixPath

from modrobust.assembly.urdf.xacro import expanded
from modrobust.assembly.urdf.xml import Element, parse_xml, read_bytes
from modrobust.checks import did_you_mean
from modrobust.errors import DescriptionError
from modrobust.formats.overlay import UrdfSource

PACKAGE = "package:"
SCHEME = "package://"


def find_file(source: UrdfSource) -> Path:
    """The file that `source` names.

    Raises:
        DescriptionError: ``package:NAME/PATH`` names no installed package, or no file of it;
            ``package://NAME/PATH`` a package whose folder is not given.
    """
    if source.file.startswith(SCHEME):
        return _in_folder(source)
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


def _in_folder(source: UrdfSource) -> Path:
    """The file of ``package://NAME/PATH``, in the folder that is given for NAME."""
    name, _, inside = source.file.removeprefix(SCHEME).partition("/")
    if not inside:
        raise source.where.error(
            "urdf",
            f'"{source.file[:200]}" is not {SCHEME}NAME/PATH; write the path of the file inside '
            "the package",
        )
    if name not in source.packages:
        known = ", ".join(source.packages) or "none"
        raise source.where.error(
            "urdf",
            f'the folder of package "{name[:80]}" is not given; '
            f"{did_you_mean(name, source.packages)}given: {known}; give it (packages: "
            f"{{{name[:80]}: FOLDER}})",
        )
    return source.packages[name] / inside


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
    if path.suffix.lower() == ".xacro":
        text = expanded(name, source.xacro, source.packages)
        return parse_xml(text, f"{name} (expanded)")
    if source.xacro:
        raise DescriptionError(
            name,
            None,
            "xacro",
            f"an argument ({next(iter(source.xacro))[:60]}) for a file that is not xacro; only "
            "xacro files take arguments, and end in .xacro; remove it or rename the file",
        )
    return tree
