"""Where results go: tables and JSON on stdout, the rest on stderr."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, Literal

from modrobust.errors import visible

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.progress import Progress
    from rich.table import Table

    from modrobust.model import Robot


def show(*results: RenderableType, style: str = "") -> None:
    """Write results to stdout; no colour nor bold when it is no terminal or NO_COLOR is set.

    Texts are taken as they are, without rich's markup. Lines do not end in blanks.
    """
    from rich.console import Console
    from rich.table import Table

    plain = True if os.environ.get("NO_COLOR") else None  # rich drops the colours only
    console = Console(
        highlight=False, markup=False, emoji=False, color_system=None if plain else "auto"
    )
    usual = console.width
    with console.capture() as captured:
        for result in results:
            if isinstance(result, Table):  # rather wider than the terminal than unreadable
                console.width = max(usual, _narrowest(result))
            console.print(result, style=style)
            console.width = usual
    for line in captured.get().splitlines():
        # Of a text's own control characters; those of rich's colours start with an escape.
        plain_text = "\x1b".join(map(visible, line.rstrip().split("\x1b")))
        sys.stdout.write(f"{plain_text}\n")
    sys.stdout.flush()  # at once, into a pipe too


def _narrowest(table: Table) -> int:
    """Width below which a number, or a word of a text that can be folded, would be cut."""
    from rich.cells import cell_len

    width = 2
    for column in table.columns:
        texts = [str(cell) for cell in (column.header, *column.cells)]
        whole = texts if column.no_wrap else [word for text in texts for word in text.split()]
        width += 2 + max(map(cell_len, whole), default=0)
    return width


def words(key: str) -> str:
    """The words of a table for a key of the JSON: the same ones."""
    return key.replace("_over_", "/").replace("_", " ")


def table(*columns: str, left: int = 1, folded: Collection[int] = ()) -> Table:
    """An empty compact table; all but the first `left` columns hold numbers, to the right.

    The columns `folded` hold texts that may take several lines. Everything else is a name or a
    number: broken in two it reads as two, so a row stays one line, however long.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    empty = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0), show_header=any(columns))
    for index, column in enumerate(columns):
        side: Literal["left", "right"] = "left" if index < left else "right"
        empty.add_column(Text(column), justify=side, overflow="fold", no_wrap=index not in folded)
    return empty


def number(value: float | None) -> str:
    """Four digits; a dash where there is no number."""
    return "-" if value is None else f"{value:.4g}"


def microseconds(value: float | None) -> str:
    """A time [s], shown in microseconds, or milliseconds from one on."""
    if value is None:
        return "-"
    return f"{value * 1e6:.3g} us" if value < 999.5e-6 else f"{value * 1e3:.3g} ms"


def times(measured: Mapping[str, Mapping[str, float | None]], robot: str) -> Table:
    """Table of times per command; under those of the paper's robot, the paper's own."""
    from modrobust.bench.benchmark import PAPER_ROBOT, PAPER_TIMES

    statistics = ("mean", "max", "std", "p50", "p99")
    rows = table("", *statistics)
    for column in rows.columns[1:]:
        column.min_width = len("0.288 us")  # so that the layout does not change with the times
    paper = {"paper (ianea, 3.5 GHz i7)": PAPER_TIMES} if robot == PAPER_ROBOT else {}
    for label, values in {**measured, **paper}.items():
        rows.add_row(label, *(microseconds(values.get(key)) for key in statistics))
    return rows


def json_text(data: Mapping[str, Any] | list[Any]) -> str:
    """JSON with every number as its shortest text that reads back exactly."""
    return json.dumps(data, indent=2, allow_nan=False) + "\n"


def print_json(data: Mapping[str, Any] | list[Any]) -> None:
    """Write JSON and nothing else to stdout."""
    sys.stdout.write(json_text(data))


def note(text: str) -> None:
    """Say something that is not a result."""
    sys.stderr.write(f"{visible(text)}\n")


class ProgressBar:
    """A bar on stderr for what takes longer than a second; silent in a pipe.

    Call it with the part that is done, from 0 to 1.
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._start = time.monotonic()
        self._bar: Progress | None = None

    def __enter__(self) -> ProgressBar:
        return self

    def __exit__(self, *exception: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def restart(self) -> None:
        """What took time until now was no part of what the bar shows."""
        self._start = time.monotonic()

    def __call__(self, done: float, label: str | None = None) -> None:
        """Shows the part done [1]; the bar appears once the work is bound to take over a second."""
        if self._bar is None:
            elapsed = time.monotonic() - self._start
            if not sys.stderr.isatty() or elapsed < max(0.1, done):  # under a second in all
                return
            from rich.console import Console
            from rich.progress import Progress

            self._bar = Progress(console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task(self._label, total=1.0)
            self._bar.start()
        self._bar.update(self._task, completed=done, description=label or self._label)


def position_unit(robot: Robot) -> str:
    """Unit of positions and of their errors: that of all joints, or both."""
    turns = robot.free_turns
    return "rad" if turns.all() else "m" if not turns.any() else "rad or m"
