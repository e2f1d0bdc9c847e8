"""The command line: typer and rich live here and nowhere else; nothing imports this package.

Exit codes: 0 fine; 1 ran, but the answer is bad; 2 bad input or usage; 130 interrupted. Results go
to stdout, everything else to stderr. A traceback means a bug in modrobust.
"""

from __future__ import annotations

import sys
from io import TextIOWrapper

from modrobust.errors import InputError, ModrobustError


def main() -> None:
    """Run the command line; what modrobust raises on purpose ends as one line on stderr."""
    from modrobust.cli.app import app  # late: typer is not needed to import the package

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # where a terminal lacks a letter
    try:
        app(prog_name="modrobust")
    except ModrobustError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(2 if isinstance(error, InputError) else 1)
