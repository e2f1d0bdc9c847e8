"""What the scripts beside this one share: the robot, the machine's name, printing, skipping."""

from __future__ import annotations

import datetime
import os
import platform
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import modrobust as mr
from modrobust.bench.peers import PeerReport
from modrobust.bench.peers.timing import Comparison
from modrobust.cli.bench_peers import print_peers
from modrobust.errors import MissingExtraError
from modrobust.model import Robot


def processor() -> str:
    """Its name, where the system says it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(x.partition(":")[2].strip() for x in lines if x.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def machine() -> str:
    """Date, processor, number of processors, load and Python's version, in a line."""
    today = datetime.datetime.now(datetime.UTC).date()
    return (
        f"{today:%d %B %Y}, {processor()}, {os.cpu_count()} processors, "
        f"load {os.getloadavg()[0]:.1f}, Python {platform.python_version()}"
    )


def markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, *rows)]
    lines.insert(1, "|" + "---|" * len(head))
    return "\n".join(lines)


def main(peer: str, compare: Callable[[Robot], Comparison]) -> None:
    """Print the comparison for each robot named on the command line; say what is not installed."""
    print(machine())
    for name in sys.argv[1:] or ["lwa4p-paper"]:
        robot = mr.load_robot(name)
        try:
            comparison = compare(robot)
        except MissingExtraError as problem:
            print(f"skipped: {problem}")
            return
        print_peers(PeerReport(robot.name, robot.n, {peer: comparison}).to_dict())
        if comparison.disagreement is not None:
            print(
                f"\nLargest difference of torques: {comparison.disagreement:.1e} of the largest\n"
            )


def announce(text: str) -> None:
    """Say on stderr that something takes minutes."""
    print(text, file=sys.stderr)
