"""A path that the system refuses is an error of ours, wherever a file is read."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import modrobust as mr
from modrobust.assembly.modules.catalogue import catalogue
from modrobust.errors import FileError, InputError
from modrobust.model import synthetic_chain
from modrobust.motion import make_trajectory
from modrobust.timor import import_timor

LONG = "x" * 300
READERS: dict[str, tuple[Callable[[str], Any], str]] = {
    "a name": (mr.load_robot, ""),
    "an assembly": (mr.load_robot, ".yaml"),
    "a JSON": (mr.load_robot, ".json"),
    "a URDF": (mr.load_robot, ".urdf"),
    "a motion": (lambda path: make_trajectory(synthetic_chain(2), path), ".csv"),
    "a Timor database": (import_timor, ".json"),
    "a catalogue": (lambda path: catalogue([path]), ""),
}


@pytest.mark.parametrize("reader", READERS)
def test_a_path_that_is_too_long_is_refused(reader: str) -> None:
    read, suffix = READERS[reader]
    with pytest.raises(FileError, match=r"file name too long; .* check"):
        read(LONG + suffix)


@pytest.mark.parametrize("reader", READERS)
def test_a_folder_that_may_not_be_searched_is_refused(
    reader: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who runs as root may search everything: the system's answer is made up."""
    read, suffix = READERS[reader]
    stat = os.stat

    def refuse(path: Any, *args: Any, **named: Any) -> os.stat_result:
        if "locked" in os.fspath(path):
            raise PermissionError(13, "Permission denied", path)
        return stat(path, *args, **named)

    monkeypatch.setattr(os, "stat", refuse)
    with pytest.raises(FileError, match="permission denied; the system refuses this path"):
        read(str(tmp_path / f"locked{suffix}") if suffix else "locked")


@pytest.mark.parametrize("key", ["modules", "urdf"])
def test_a_path_inside_a_description_is_no_exception(tmp_path: Path, key: str) -> None:
    file = tmp_path / "arm.yaml"
    rest = f"urdf: {LONG}.urdf" if key == "urdf" else f"modules: {LONG}\nchain: [scara]"
    file.write_text(f"modrobust: 1\nrobot: arm\n{rest}\n")
    with pytest.raises(InputError, match=r"no directory|file name too long"):
        mr.load_robot(file)
