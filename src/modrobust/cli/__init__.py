"""The command line: typer and rich live here and nowhere else; nothing imports this package.

Exit codes: 0 fine; 1 ran, but the answer is bad; 2 bad input or usage; 130 interrupted; 143 ended
by SIGTERM (129 by SIGHUP); 141 who read the results closed the pipe. Results
go to stdout, everything else to stderr. A traceback means a bug in modrobust.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from typing import NoReturn

# Before numpy and pydantic are imported; existing values take precedence.
_QUICK_START = {
    "OPENBLAS_NUM_THREADS": "1",  # no product here is large enough for a second thread
    "PYDANTIC_DISABLE_PLUGINS": "__all__",  # else it searches every installed package for some
}

# Imports make many objects that stay: looking through them for garbage is a tenth of the start.
_COLLECT_EVERY = 50_000  # objects; Python's default is 700


def main() -> None:
    """Run the command line; what modrobust raises on purpose ends as one line on stderr."""
    for name, value in _QUICK_START.items():
        os.environ.setdefault(name, value)
    gc.set_threshold(_COLLECT_EVERY)
    for ending in (signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)):
        if signal.getsignal(ending) is signal.SIG_DFL:  # nohup takes precedence
            signal.signal(ending, _end)
    try:
        code = _guarded()
    except KeyboardInterrupt:  # the commands handle their own; this one came while they load
        sys.stderr.write("interrupted\n")
        code = 130
    gc.freeze()  # what is left goes with the process, without one more look for garbage
    sys.exit(code)


def _end(number: int, _: object) -> NoReturn:
    """Ends as the signal asks, but by an exception: files that are half written go."""
    sys.exit(128 + number)


def _guarded() -> str | int | None:
    from modrobust.cli.results_stream import StdoutError, drop_results, guard_streams

    try:
        guard_streams()
        code = _run()
        sys.stdout.flush()
    except StdoutError as problem:
        drop_results()
        sys.stderr.write(problem.message)
        return problem.code
    return code


def _run() -> str | int | None:
    from modrobust.cli.app import app  # late: typer is not needed to import the package
    from modrobust.errors import InputError, ModrobustError

    try:
        app(prog_name="modrobust")
    except ModrobustError as error:
        sys.stderr.write(f"{error}\n")
        return 2 if isinstance(error, InputError) else 1
    except SystemExit as end:
        return end.code
    return 0
