"""What the kernel answers for one state of a robot: every function, both kinds of bound."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import modrobust as mr
from modrobust import _kernel
from modrobust.control import RobustController
from modrobust.kernel import BOUNDS
from modrobust.model import Robot
from support.containment.extreme_states import Signals
from support.states import doubles


@dataclass(frozen=True)
class Query:
    """One state of one robot, as the kernel is asked."""

    signals: Signals
    dq_a: Any
    ddq_a: Any

    def vectors(self) -> tuple[Any, Any, Any, Any]:
        return self.signals.q, self.signals.dq, self.dq_a, self.ddq_a


@dataclass(frozen=True)
class Bound:
    """One answer of the kernel. A perturbation is the torque minus u0 minus the disturbance."""

    name: str
    lo: Any  # (n,)
    hi: Any
    drives: bool
    nominal: Any = None  # u0 (n,), of a perturbation
    slack: Any = None  # (n,) what the kernel added for rounding, where it tells


def answers(robot: Robot, query: Query, as_given: bool) -> Iterator[Bound]:
    """The kernel's bounds for one state, all functions and kinds of bound."""
    state = query.vectors()
    for bound in BOUNDS:
        controller = RobustController(robot, law="norm", bound=bound)
        command = controller.command(0.0, *query.signals)
        yield Bound(f"command {bound}", command.phi_lo, command.phi_hi, True, command.nominal)
        if as_given:
            continue
        nominal = mr.inverse_dynamics(robot, *state)
        lo, hi = mr.perturbation_bounds(robot, *state, bound=bound)
        yield Bound(f"perturbation {bound}", lo, hi, True, nominal)
        for drives in (True, False):
            lo, hi = mr.inverse_dynamics_bounds(robot, *state, bound=bound, drives=drives)
            slack = bounds_slack(robot, query, drives) if bound == "hull" else None
            yield Bound(f"torque {bound}, drives {drives}", lo, hi, drives, slack=slack)


def bounds_slack(robot: Robot, query: Query, drives: bool) -> Any:
    """What the hull of the torques holds for rounding, (n,)."""
    box = (robot.nominal.packed, robot.lower.packed, robot.upper.packed)
    return _kernel.bounds_slack(robot.model, *box, *doubles(query.vectors()), drives)
