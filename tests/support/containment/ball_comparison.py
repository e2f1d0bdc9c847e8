"""One state of a robot: the kernel's answers against exact torques at many parameter points.

The exact torques come in two readings: real arithmetic on the doubles of `to_dict()`, or exact
rotations and the constants as written. Friction follows the smooth law, or Coulomb's with any sign
where the joint (nearly) rests, (20).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

import modrobust as mr
from modrobust import _kernel
from modrobust.model import Robot
from support.containment.ball_dynamics import Coefficients, State, coefficients, from_doubles
from support.containment.extreme_points import monomials, parameter_points
from support.containment.extreme_states import Signals, auxiliary
from support.containment.kernel_answers import Bound, Query, answers
from support.containment.written_robots import Written, exact_robot
from support.states import doubles

PRECISION = 320  # [bits]; a product of three doubles and a sum of many are far within
WIDEST = 5120  # tried once more where a comparison cannot be decided
MOST_EXTREMES = 24  # points a state
TOUCHED = -1.0  # an exact torque within twice the slack from an end
WIDE = 1e3  # slacks; narrower hulls are touched by any point

Change = Callable[[Robot, Query, list[Bound]], list[Bound]]
Torques = dict[str, list[list[arb]]]


@dataclass
class Outcome:
    """What was found, summed over blocks. Cases are distinct parameter points of their state."""

    cases: int = 0
    states: int = 0
    refused: int = 0  # states that the kernel answered with an error
    kinds: dict[str, int] = field(default_factory=dict)  # states of each, refused ones left out
    violations: list[str] = field(default_factory=list)
    used_hull: float = 0.0  # largest share of the hull's slack that exact torques needed
    used_rounding: float = 0.0  # largest error of NE* over its proved bound

    def add(self, other: Outcome) -> None:
        self.cases += other.cases
        self.states += other.states
        self.refused += other.refused
        self.violations += other.violations
        for kind, states in other.kinds.items():
            self.kinds[kind] = self.kinds.get(kind, 0) + states
        self.used_hull = max(self.used_hull, other.used_hull)
        self.used_rounding = max(self.used_rounding, other.used_rounding)

    def summary(self) -> str:
        return (
            f"{self.cases:,} cases, {self.states:,} states, {self.refused:,} refused, "
            f"{len(self.violations)} violations; exact torques used at most {self.used_hull:.2g} "
            f"of the hull's slack and {self.used_rounding:.2g} of the stated rounding of NE*"
        )


def check_state(
    robot: Robot,
    signals: Signals,
    rng: np.random.Generator,
    label: str,
    written: Written | None = None,
    as_given: bool = False,
    change: Change | None = None,
) -> Outcome:
    """All cases of one state.

    written: The geometry as written, for that reading; None = the doubles. as_given: only the
    command's bounds, with (4) in real arithmetic on its signals. change: Alters the kernel's
    answers, to see a check fail.
    """
    query = Query(signals, *auxiliary(robot, signals))
    try:
        bounds = list(answers(robot, query, as_given))
    except mr.ModrobustError:
        return Outcome(states=1, refused=1)
    if change:
        bounds = change(robot, query, bounds)
    seed = int(rng.integers(1 << 62))

    def torques(precision: int) -> tuple[Any, Torques]:
        ctx.prec = precision
        model = exact_robot(written, robot.framed.tolist()) if written else from_doubles(robot)
        rows = coefficients(model, _state(robot, query, as_given))
        draw = np.random.default_rng(seed)
        points, signs = parameter_points(draw, robot, rows, MOST_EXTREMES)
        return points, exact_torques(robot, rows, points, signs)

    before = ctx.prec
    try:
        points, exact = torques(PRECISION)
        outcome = Outcome(cases=len(np.unique(points, axis=0)), states=1)
        problems, decided = _compare(robot, bounds, exact, outcome)
        if not decided:
            points, exact = torques(WIDEST)
            problems, _ = _compare(robot, bounds, exact, outcome)
        outcome.violations += [f"{label}: {problem}" for problem in problems]
        if not as_given:
            _check_rounding(robot, query, points, exact, label, outcome)
    finally:
        ctx.prec = before
    return outcome


def _state(robot: Robot, query: Query, as_given: bool) -> State:
    """The state in balls; with `as_given`, (4) in real arithmetic on the signals."""
    q, dq = ([arb(x) for x in v.tolist()] for v in (query.signals.q, query.signals.dq))
    if not as_given:
        dq_a, ddq_a = ([arb(x) for x in v.tolist()] for v in (query.dq_a, query.ddq_a))
        return State(q, dq, dq_a, ddq_a)
    K_r = [arb(k) for k in robot.controller.K_r]
    _, dq_des, ddq_des = ([arb(x) for x in v.tolist()] for v in query.signals[2:])
    return State(
        q,
        dq,
        [
            v + k * e
            for v, k, e in zip(dq_des, K_r, exact_errors(robot, query.signals), strict=True)
        ],
        [a + k * (v_des - v) for a, k, v_des, v in zip(ddq_des, K_r, dq_des, dq, strict=True)],
    )


def exact_errors(robot: Robot, signals: Signals) -> list[arb]:
    """The error e of (4) with the whole turns that the kernel chose, and 2 pi itself."""
    found = robot.tracking_error(signals.q, signals.q_des)
    errors = []
    for q, q_des, e, wraps in zip(signals.q, signals.q_des, found, robot.wraps, strict=True):
        error = arb(float(q_des)) - arb(float(q))
        if wraps:
            assert abs(e) <= np.pi
            turns = round(float((error - arb(float(e))) / (2 * arb.pi())))
            error -= 2 * arb.pi() * turns
        errors.append(error)
    return errors


def exact_torques(robot: Robot, rows: Coefficients, points: Any, signs: list[list[arb]]) -> Torques:
    """Torques of every point (k, n): of the bodies alone, with drives, with smooth friction."""
    columns = [
        monomials(robot, point, rows, sign) for point, sign in zip(points, signs, strict=True)
    ]
    parts = [
        _product([column[0] for column in columns], rows.bodies),
        _product([column[1] for column in columns], rows.drives),
        _product([column[2] for column in columns], rows.drives),
    ]
    sums = [
        [[x + y for x, y in zip(a, b, strict=True)] for a, b in zip(parts[0], part, strict=True)]
        for part in parts[1:]
    ]
    return {"bodies": parts[0], "drives": sums[0], "smooth": sums[1]}


def _product(points: list[list[arb]], rows: list[list[arb]]) -> list[list[arb]]:
    if not rows[0]:
        return [[arb(0)] * len(rows) for _ in points]
    left = arb_mat(len(points), len(rows[0]), [x for point in points for x in point])
    right = arb_mat(len(rows), len(rows[0]), [x for row in rows for x in row])
    return (left * right.transpose()).tolist()


def _compare(
    robot: Robot, bounds: list[Bound], torques: Torques, outcome: Outcome
) -> tuple[list[str], bool]:
    """What lies outside, and whether every comparison could be decided."""
    problems = []
    decided = True
    ends = {name: _ends(torques[name]) for name in ("drives", "bodies")}
    for bound in bounds:
        lowest, highest = ends["drives" if bound.drives else "bodies"]
        for i in range(robot.n):
            low, high = lowest[i], highest[i]
            if bound.nominal is not None:  # (12)
                u0 = float(bound.nominal[i])
                low = low - u0 - float(robot.disturbance.hi[i])
                high = high - u0 - float(robot.disturbance.lo[i])
            for side, lower, upper in (
                ("lower", arb(float(bound.lo[i])), low),
                ("upper", high, arb(float(bound.hi[i]))),
            ):
                if bound.slack is not None and bound.slack[i] > 0.0:
                    share = 1 - float((upper - lower) / float(bound.slack[i]))
                    outcome.used_hull = max(outcome.used_hull, share)
                    if share > TOUCHED and bound.hi[i] - bound.lo[i] > WIDE * bound.slack[i]:
                        which = "drives" if bound.drives else "bodies"
                        outcome.kinds[f"{side} end of a wide hull touched, {which}"] = 1
                if lower <= upper:
                    continue
                decided &= bool(lower > upper)
                gap = float(lower - upper)
                problems.append(
                    f"{bound.name}, joint {i}: {side} bound missed by {gap:.3g}; the bounds are "
                    f"[{bound.lo[i]!r}, {bound.hi[i]!r}]"
                )
    return problems, decided


def _ends(torques: list[list[arb]]) -> tuple[list[arb], list[arb]]:
    """Smallest and largest of each joint's torques over the points."""
    low, high = list(torques[0]), list(torques[0])
    for row in torques[1:]:
        for i, x in enumerate(row):
            low[i], high[i] = low[i].min(x), high[i].max(x)
    return low, high


def _check_rounding(
    robot: Robot,
    query: Query,
    points: Any,
    torques: Torques,
    label: str,
    outcome: Outcome,
) -> None:
    """|NE* in doubles - exact| stays within the bound that the kernel states."""
    state = doubles(query.vectors())
    for k, point in enumerate(points):
        name = "smooth" if k % 2 else "bodies"
        tau, error = _kernel.inverse_dynamics_rounding(robot.model, point, *state, bool(k % 2))
        for i, exact in enumerate(torques[name][k]):
            gap = abs(exact - float(tau[i]))
            if gap <= float(error[i]):
                if error[i] > 0.0:
                    outcome.used_rounding = max(outcome.used_rounding, float(gap / float(error[i])))
            else:
                outcome.violations.append(
                    f"{label}: rounding of NE* ({name}), joint {i}, point {k}: error "
                    f"{float(gap):.3g}, stated {float(error[i]):.3g}"
                )
