"""The exceptions of modrobust.

Every message says where, what was found, the rule and the remedy::

    ModrobustError
    +-- InputError                 the input is at fault; the command line exits with 2
    |   +-- DescriptionError       a module or robot description, with file, line and field
    |   +-- FileError              a file cannot be read or written
    |   +-- ShapeError             an array has the wrong shape
    |   +-- ValueRangeError        a number is not finite or outside its range
    |   +-- MissingExtraError      an optional dependency is not installed
    +-- TimeOrderError             a controller was called with a time before its last one
    +-- SingularMassMatrixError    the mass matrix cannot be inverted
    +-- DivergenceError            a computed state left the range that the kernel can handle
"""

from __future__ import annotations

import re
from pathlib import Path

_BREAKS = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")


class ModrobustError(Exception):
    """Base of every exception that modrobust raises on purpose; its message is one line.

    A control character that a name or a path brought in is shown escaped.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(_BREAKS.sub(lambda found: ascii(found[0])[1:-1], message))


class InputError(ModrobustError):
    """The input is at fault; nothing was computed."""


class DescriptionError(InputError):
    """A description says something that it must not: ``file:line: field: what; rule; remedy``.

    Args:
        file: File as the user named it, or None for a description that came from memory.
        line: Line in the file, from 1, or None.
        field: Dotted path of the field, possibly empty.
        message: What was found, the rule and the remedy, in one line.
    """

    def __init__(self, file: str | Path | None, line: int | None, field: str, message: str) -> None:
        self.file = None if file is None else str(file)
        self.line = line
        self.field = field
        self.message = message
        where = "" if self.file is None else self.file if line is None else f"{self.file}:{line}"
        if line is None and where and f"{field}.".startswith(f"{where}."):
            where = ""  # an argument, whose name the field begins with
        super().__init__(": ".join(part for part in (where, field, message) if part))


class FileError(InputError):
    """A file cannot be read or written: ``file: what; rule; remedy``."""

    def __init__(self, file: str | Path, message: str) -> None:
        self.file = str(file)
        self.message = message
        super().__init__(f"{file}: {message}")


class ShapeError(InputError):
    """An array has the wrong shape."""


class ValueRangeError(InputError):
    """A number is not finite, or outside the range that its meaning allows."""


class MissingExtraError(InputError):
    """An optional dependency is not installed; the message names the extra that brings it."""


class TimeOrderError(ModrobustError):
    """A controller was called with a time before that of its previous call."""


class SingularMassMatrixError(ModrobustError):
    """The mass matrix is not positive definite."""


class DivergenceError(ModrobustError):
    """A state left the range that the kernel can handle (not finite, or beyond 1e5)."""
