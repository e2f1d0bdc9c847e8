"""Files: what stands at a path, and files that are written whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from modrobust.errors import FileError


def kind_of_path(path: str | Path) -> str:
    """What stands at a path: "file", "directory", "missing", or "other", such as a pipe.

    Raises:
        FileError: The system refuses the path: too long, in a folder that may not be searched.
    """
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError, ValueError):  # the last one: a NUL in it
        return "missing"
    except OSError as error:
        raise FileError(path, f"{reason(error)}; the system refuses this path; check it") from None
    if stat.S_ISDIR(mode):
        return "directory"
    return "file" if stat.S_ISREG(mode) else "other"


def reason(error: OSError) -> str:
    """The system's words for what went wrong, on a line of their own: "file name too long"."""
    return (error.strerror or type(error).__name__).lower()


@contextmanager
def replacing(path: str | Path, suffix: str, what: str) -> Iterator[Path]:
    """A new file beside `path` that takes its place at the end, and is gone after a failure.

    It is made at once: who enters before the work knows early that the place can be written. It is
    on the disk before it takes the place, and has the mode of what it replaces.

    Args:
        path: The place; a link stays a link.
        suffix: What the name must end in, such as ``.json``.
        what: What is written, with its article, for the message.

    Raises:
        FileError: The suffix is another, the place is a directory, missing or read-only, or
            writing fails.
    """
    target = _target(path, suffix, what)
    part = _new_file(path, target, suffix)
    try:
        yield part
        if target.exists():
            os.chmod(part, stat.S_IMODE(target.stat().st_mode))
        _flush(part)
        os.replace(part, target)
        with suppress(OSError):  # the file is in its place
            _flush(target.parent)
    except OSError as error:
        raise FileError(
            path, f"cannot be written: {error.strerror}; what was there is as it was"
        ) from None
    finally:
        part.unlink(missing_ok=True)


def check_writable(path: str | Path, suffix: str, what: str) -> None:
    """Refuse a place that `replacing` would refuse; nothing is left there.

    Raises:
        FileError: See `replacing`.
    """
    _new_file(path, _target(path, suffix, what), suffix).unlink()


def _target(path: str | Path, suffix: str, what: str) -> Path:
    found = Path(path).suffix
    if found.lower() != suffix:  # of the name given: a link may lead to another
        raise FileError(path, f'suffix "{found}"; {what} ends in {suffix}; name it so')
    try:
        target = Path(os.path.realpath(path))
    except FileNotFoundError:
        raise FileError(path, "the working directory is gone; change to one that exists") from None
    except ValueError:
        raise FileError(path, "not a file name; check the path") from None
    there = kind_of_path(target)
    if there == "directory":
        raise FileError(path, "is a directory; give the name of a file in it")
    if kind_of_path(target.parent) != "directory":
        raise FileError(path, f"no directory {Path(path).parent}; make it first")
    if there == "other" or (there == "file" and not os.access(target, os.W_OK)):
        raise FileError(path, "is read-only or no regular file; choose another place")
    return target


def _new_file(path: str | Path, target: Path, suffix: str) -> Path:
    # Shortened, so that a name as long as the system allows has a part file too.
    part = target.with_name(f".{target.stem[:40]}-{secrets.token_hex(4)}{suffix}")
    try:
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    except OSError as error:
        raise FileError(
            path, f"cannot be written: {error.strerror}; choose another place"
        ) from None
    return part


def _flush(path: Path) -> None:
    """Waits until a file, or the names in a directory, are on the disk; where that can be asked."""
    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EROFS, errno.ENOTSUP):
            raise
    finally:
        os.close(handle)
