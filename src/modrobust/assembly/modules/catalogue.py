"""Where modules and built-in robots are found, and what can be mounted on what."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from modrobust.assembly.modules.connectors import incompatibility
from modrobust.checks import unknown_name
from modrobust.checks.files import kind_of_path
from modrobust.errors import FileError
from modrobust.formats import Module, Where, load_module
from modrobust.kernel import own_environment

_SUFFIXES = (".yaml", ".yml", ".json")  # where two files have one stem, the first suffix wins


def data_directory(kind: str) -> Path:
    """Directory of the built-in "modules" or "assemblies".

    In an installed package they lie in its ``data`` folder; in a checkout, at its top.
    """
    package = Path(__file__).resolve().parents[2]
    installed = package / "data" / kind
    return installed if installed.is_dir() else package.parents[1] / kind


def builtin_robots() -> dict[str, Path]:
    """Files of the robots that come with modrobust, by name."""
    return _files(data_directory("assemblies"))


@own_environment()
def catalogue(directories: Iterable[str | Path] | None = None) -> list[Module]:
    """Every module of some directories, in the order of their ids.

    Args:
        directories: Where to look; None = the catalogue that comes with modrobust. Of two modules
            with one id, the one in the earlier directory counts.

    Raises:
        DescriptionError: A module file is at fault.
        FileError: A directory does not exist, or a file cannot be read.
    """
    chosen = [data_directory("modules")] if directories is None else [Path(d) for d in directories]
    found: dict[str, Path] = {}
    for directory in chosen:
        if kind_of_path(directory) != "directory":
            raise FileError(directory, "no such directory; give a directory with module files")
        found = _files(directory) | found
    return [load_module(found[name]) for name in sorted(found)]


def mounts(modules: Sequence[Module]) -> dict[str, tuple[str, ...]]:
    """For each module, by id: the ids of those that mount on it, ``in`` on its ``out``."""
    return {
        below.id: tuple(
            above.id
            for above in modules
            if below.connector_out is not None
            and above.connector_in is not None
            and incompatibility(below.connector_out, above.connector_in) is None
        )
        for below in modules
    }


class Library:
    """The modules that an assembly can name: its own directories first, then the built-in ones."""

    def __init__(self, directories: Sequence[Path]) -> None:
        builtin = data_directory("modules")
        self._looked_in = [f"{_tidy(d)}{os.sep}" for d in directories]
        if not any(_same(d, builtin) for d in directories):
            self._looked_in.append("the built-in catalogue")
        self._files: dict[str, Path] = {}
        for directory in (*directories, builtin):
            self._files = _files(_tidy(directory)) | self._files

    def path(self, module: str, where: Where, field: str) -> Path:
        """File of a module; `where` and `field` say which entry asks for it.

        Raises:
            DescriptionError: No module has that id; the message lists those known.
        """
        if module not in self._files:
            known = sorted(self._files)
            raise where.error(
                field,
                unknown_name(f'no module named "{module}"', module, known)
                + f" (looked in {' and '.join(self._looked_in)})",
            )
        return self._files[module]


def _files(directory: Path) -> dict[str, Path]:
    """Description files of a directory by stem."""
    found: dict[str, Path] = {}
    if kind_of_path(directory) != "directory":
        return found
    for suffix in _SUFFIXES:
        for path in sorted(directory.glob(f"*{suffix}")):
            found.setdefault(path.stem, path)
    return found


def _same(one: Path, other: Path) -> bool:
    # Those of os.path say no where the system refuses a path; those of pathlib raise.
    return os.path.isdir(one) and os.path.isdir(other) and os.path.samefile(one, other)


def _tidy(directory: Path) -> Path:
    """``assemblies/../modules`` as ``modules``, unless a link makes that another place."""
    tidy = Path(os.path.normpath(directory))
    return tidy if _same(tidy, directory) else directory
