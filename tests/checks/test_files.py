"""Files are written whole or not at all."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from modrobust.checks import check_writable, replacing
from modrobust.errors import FileError

KIND = (".json", "a report")


def test_a_file_takes_its_place_only_at_the_end(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    file.write_text("old")
    with replacing(file, *KIND) as part:
        part.write_text("new")
        assert file.read_text() == "old"
    assert file.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.json"]


def test_a_failure_leaves_what_was_there_and_nothing_else(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    file.write_text("old")

    def fail_half_way() -> None:
        with replacing(file, *KIND) as part:
            part.write_text("half")
            raise KeyError

    with pytest.raises(KeyError):
        fail_half_way()
    assert file.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.json"]


def test_a_full_disk_is_a_file_error(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    with pytest.raises(FileError) as caught, replacing(file, *KIND):
        raise OSError(28, "No space left on device")
    assert str(caught.value) == (
        f"{file}: cannot be written: No space left on device; what was there is as it was"
    )
    assert os.listdir(tmp_path) == []


def test_a_link_stays_a_link_and_permissions_follow_the_umask(tmp_path: Path) -> None:
    (tmp_path / "real.json").touch()
    link = tmp_path / "link.json"
    link.symlink_to("real.json")
    with replacing(link, *KIND) as part:
        part.write_text("new")
    assert link.is_symlink()
    assert (tmp_path / "real.json").read_text() == "new"
    plain = tmp_path / "plain"
    plain.touch()
    assert link.stat().st_mode == plain.stat().st_mode


@pytest.mark.parametrize("mode", [0o600, 0o644, 0o664])
def test_a_file_that_is_rewritten_keeps_its_mode(tmp_path: Path, mode: int) -> None:
    file = tmp_path / "a.json"
    file.touch()
    file.chmod(mode)
    with replacing(file, *KIND) as part:
        part.write_text("new")
    assert stat.S_IMODE(file.stat().st_mode) == mode


def test_what_is_written_is_on_the_disk_before_it_takes_the_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else a power cut could leave an empty file where the old one was."""
    order: list[str] = []
    fsync, replace = os.fsync, os.replace

    def flushed(handle: int) -> None:
        directory = stat.S_ISDIR(os.fstat(handle).st_mode)
        order.append("directory" if directory else f"{os.fstat(handle).st_size} bytes")
        fsync(handle)

    def replaced(one: Path, other: Path) -> None:
        order.append("rename")
        replace(one, other)

    monkeypatch.setattr(os, "fsync", flushed)
    monkeypatch.setattr(os, "replace", replaced)
    with replacing(tmp_path / "a.json", *KIND) as part:
        part.write_text("whole")
    assert order == ["5 bytes", "rename", "directory"]


def test_a_name_as_long_as_the_system_allows_can_be_written(tmp_path: Path) -> None:
    name = "a" * 250 + ".json"
    with replacing(tmp_path / name, *KIND) as part:
        part.write_text("new")
    assert os.listdir(tmp_path) == [name]
    too_long = tmp_path / f"a{name}"
    with pytest.raises(FileError) as caught:
        check_writable(too_long, *KIND)
    assert str(caught.value) == (
        f"{too_long}: file name too long; the system refuses this path; check it"
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.txt", 'suffix ".txt"; a report ends in .json; name it so'),
        ("folder.json", "is a directory; give the name of a file in it"),
        ("pipe.json", "is read-only or no regular file; choose another place"),
        ("device.json", "is read-only or no regular file; choose another place"),
    ],
)
def test_a_wrong_place_is_refused_before_the_work(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder.json").mkdir()
    os.mkfifo(tmp_path / "pipe.json")
    (tmp_path / "device.json").symlink_to("/dev/full")
    before = sorted(os.listdir(tmp_path))
    with pytest.raises(FileError) as caught:
        check_writable(tmp_path / name, *KIND)
    assert str(caught.value) == f"{tmp_path / name}: {message}"
    check_writable(tmp_path / "fine.json", *KIND)
    assert sorted(os.listdir(tmp_path)) == before


def test_a_link_to_a_file_of_another_suffix_is_written_through(tmp_path: Path) -> None:
    (tmp_path / "real.txt").touch()
    (tmp_path / "link.json").symlink_to("real.txt")
    with replacing(tmp_path / "link.json", *KIND) as part:
        assert part.suffix == ".json"  # numpy adds the suffix of its own where another stands
        part.write_text("new")
    assert (tmp_path / "real.txt").read_text() == "new"


def test_a_working_directory_that_is_gone_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    with pytest.raises(FileError) as caught:
        check_writable("a.json", *KIND)
    assert str(caught.value) == ("a.json: the working directory is gone; change to one that exists")
