"""Stdout that fails by a name of its own, so that a full disk is told from every other fault."""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

PIPE_CLOSED = 141  # what a shell reports for a process that SIGPIPE ended


class StdoutError(Exception):
    """The results could not be written; `code` is what the command then exits with."""

    def __init__(self, problem: OSError) -> None:
        pipe = isinstance(problem, BrokenPipeError)
        self.code = PIPE_CLOSED if pipe else 2
        # Who closed the pipe, such as head, has seen enough: there is nothing to say.
        self.message = "" if pipe else f"stdout: cannot be written: {problem.strerror}\n"
        super().__init__(self.message)


class _Results(TextIOWrapper):
    """Stdout whose faults typer and rich do not take for those of other files."""

    def write(self, text: str, /) -> int:
        try:
            return super().write(text)
        except OSError as problem:
            raise StdoutError(problem) from None

    def flush(self) -> None:
        try:
            super().flush()
        except OSError as problem:
            raise StdoutError(problem) from None


def guard_streams() -> None:
    """Make stdout raise `StdoutError`; letters that a terminal lacks are escaped.

    Raises:
        StdoutError: Stdout is closed.
    """
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115  # for as long as the process lives
    if sys.stdout is None:
        raise StdoutError(OSError(0, "it is closed"))
    if isinstance(sys.stderr, TextIOWrapper):
        sys.stderr.reconfigure(errors="backslashreplace")
    if type(sys.stdout) is TextIOWrapper:
        encoding, by_line = sys.stdout.encoding, sys.stdout.line_buffering
        buffer = sys.stdout.detach()
        sys.stdout = _Results(buffer, encoding, "backslashreplace", line_buffering=by_line)


def drop_results() -> None:
    """Send what is still buffered nowhere, or the interpreter would try it again at its end."""
    if sys.stdout is not None:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
