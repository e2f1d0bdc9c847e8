"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from modrobust.errors import FileError


@contextmanager
def replacing(path: str | Path, suffix: str, what: str) -> Iterator[Path]:
    """A new file beside `path` that takes its place at the end, and is gone after a failure.

    It is made at once: who enters before the work knows early that the place can be written.

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
        os.replace(part, target)
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
    if target.is_dir():
        raise FileError(path, "is a directory; give the name of a file in it")
    if not target.parent.is_dir():
        raise FileError(path, f"no directory {Path(path).parent}; make it first")
    if target.exists() and not (target.is_file() and os.access(target, os.W_OK)):
        raise FileError(path, "is read-only or no regular file; choose another place")
    return target


def _new_file(path: str | Path, target: Path, suffix: str) -> Path:
    part = target.with_name(f".{target.stem}-{secrets.token_hex(4)}{suffix}")
    try:
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    except OSError as error:
        raise FileError(
            path, f"cannot be written: {error.strerror}; choose another place"
        ) from None
    return part
