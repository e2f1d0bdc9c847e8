"""What `simulate` says before a run: its heading, and how long a long one will take."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from modrobust.cli.output import ProgressBar, note

LONG = 100.0  # [s] of motion
_MEASURED = 0.05  # [s] of wall time, from which the rest is estimated


class Start:
    """Called with simulated and total time [s], first before the run; then passes the part done on.

    Args:
        heading: Settings of the run for its heading but the duration; None = print none.
        rate: Control rate [Hz].
        bar: Takes the part that is done.
    """

    def __init__(self, heading: Mapping[str, Any] | None, rate: float, bar: ProgressBar) -> None:
        self._heading, self._rate, self._bar = heading, rate, bar
        self._begun: float | None = None
        self._estimated = False

    def __call__(self, done: float, total: float) -> None:
        """Takes simulated and total time [s]."""
        if self._begun is None:
            self._announce(total)
            self._begun = time.monotonic()
            self._bar.restart()
            return
        elapsed = time.monotonic() - self._begun
        if total >= LONG and not self._estimated and elapsed >= _MEASURED:
            self._estimated = True
            note(f"about {_shown(elapsed * (total - done) / done)} to go")
        self._bar(done / total)

    def _announce(self, total: float) -> None:
        if self._heading is not None:
            from modrobust.cli.simulate_report import print_heading

            print_heading({**self._heading, "duration": total})
        if total >= LONG:
            note(
                f"{total:g} s of motion, {total * self._rate:,.0f} commands; Ctrl-C ends the run "
                "early and keeps what was computed"
            )


def _shown(seconds: float) -> str:
    """A time for people."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"
