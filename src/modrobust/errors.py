"""The exceptions of modrobust.

Every message says where, what was found, the rule and the remedy::

    ModrobustError
    +-- InputError                 the input is at fault; the command line exits with 2
    |   +-- DescriptionError       a module or robot description, with file, line and field
    |   |   +-- SeveralFaultsError several of them, found in one reading
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
from collections.abc import Sequence
from pathlib import Path

_MOST_SHOWN = 50  # faults of one file; who has more mends these first
# Control characters, line ends, and those that turn the direction of what is read around them.
_UNSEEN = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def visible(text: str) -> str:
    """A text with its control characters escaped, so that it reads as it is on every screen."""
    return _UNSEEN.sub(lambda found: ascii(found[0])[1:-1], text)


class ModrobustError(Exception):
    """Base of every exception that modrobust raises on purpose; its message is one line a fault.

    A control character that a name or a path brought in is shown escaped.
    """

    def __init__(self, message: str = "") -> None:
        super().__init__(visible(message))


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
        if line is None and re.match(rf"{re.escape(where)}(\.|\[|$)", field):
            where = ""  # an argument, whose name the field begins with
        super().__init__(": ".join(part for part in (where, field, message) if part))


class SeveralFaultsError(DescriptionError):
    """Several faults of a description, each on a line of its own; file, line, ... of the first.

    Args:
        faults: What was found, in the order of the text; at least one.
        overlay: What follows them: lines to paste that mend figures.
    """

    def __init__(self, faults: Sequence[DescriptionError], overlay: str = "") -> None:
        first = faults[0]
        super().__init__(first.file, first.line, first.field, first.message)
        self.faults = tuple(faults)
        self.overlay = overlay
        lines = [str(fault) for fault in faults[:_MOST_SHOWN]]
        if len(faults) > _MOST_SHOWN:
            lines.append(f"and {len(faults) - _MOST_SHOWN} more faults")
        self.args = ("\n".join([*lines, *([overlay] if overlay else [])]),)


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
