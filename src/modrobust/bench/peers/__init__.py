"""Our times beside those of other libraries, measured in one run on one robot.

Peers: Pinocchio's recursive Newton-Euler algorithm, compiled from its headers and from Python, and
a plain NumPy transcription of Algorithm 1. A peer that is not installed is named, with its remedy.
Other libraries give nominal torques only: what is compared with one such pass is our whole robust
command.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from modrobust.bench.peers.compile import Announce, CompilerError
from modrobust.bench.peers.native import pinocchio_cpp, require_comparable
from modrobust.bench.peers.python_calls import numpy_transcription, pinocchio_python
from modrobust.bench.peers.timing import Comparison
from modrobust.errors import MissingExtraError
from modrobust.model import Robot

__all__ = ["PEERS", "PeerReport", "compare_with_peers"]

PEERS = ("Pinocchio, C++", "Pinocchio, Python", "NumPy, Algorithm 1")


@dataclass
class PeerReport:
    """What was compared on one robot, and what could not be."""

    robot: str
    joints: int
    comparisons: dict[str, Comparison] = field(default_factory=dict)
    absent: dict[str, str] = field(default_factory=dict)
    """Peers that are not installed, each with a sentence that says how to get it."""
    interrupted: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {
            "robot": self.robot,
            "joints": self.joints,
            "peers": [
                {"peer": name, **comparison.to_dict()}
                for name, comparison in self.comparisons.items()
            ],
            "absent": dict(self.absent),
            "interrupted": self.interrupted,
        }


def compare_with_peers(robot: Robot, announce: Announce | None = None) -> PeerReport:
    """Measure our times beside those of every peer that is installed; Ctrl-C keeps what is done.

    Args:
        robot: Any robot without mimic joints.
        announce: Told when something begins that takes minutes.

    Raises:
        ValueRangeError: The robot has mimic joints, or a peer's torques differ from ours.
    """
    require_comparable(robot)
    report = PeerReport(robot.name, robot.n)
    functions: tuple[Callable[[Robot], Comparison], ...] = (
        partial(pinocchio_cpp, announce=announce),
        pinocchio_python,
        numpy_transcription,
    )
    try:
        for name, compare in zip(PEERS, functions, strict=True):
            try:
                report.comparisons[name] = compare(robot)
            except (MissingExtraError, CompilerError) as problem:
                report.absent[name] = str(problem)
    except KeyboardInterrupt:
        report.interrupted = True
    return report
