"""Containment cases: the kernel's results for a random robot and state against exact torques.

A case is one robot, state and parameter point. The exact torques come in two readings: real
arithmetic on the doubles of `to_dict()`, or exact rotations and the constants as written. Friction
follows the smooth law, or Coulomb's with any sign where the joint (nearly) rests, (20).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from ball_dynamics import BallRobot, Coefficients, State, coefficients, from_doubles
from extreme_points import monomials, parameter_points
from extreme_states import Signals, auxiliary, random_signals
from flint import arb, arb_mat, ctx
from parameter_boxes import make_robot, skewed
from written_robots import Written, exact_robot, random_written

import modrobust as mr
from modrobust import _kernel
from modrobust.control import RobustController
from modrobust.kernel import METHODS
from modrobust.robot import Robot

PRECISION = 320  # [bits]; a product of three doubles and a sum of many are far within
WIDEST = 5120  # tried once more where a comparison cannot be decided
STATES = 3  # a robot
MOST_EXTREMES = 24  # points a state


@dataclass
class Outcome:
    """What was found, summed over blocks."""

    cases: int = 0
    states: int = 0
    refused: int = 0  # states that the kernel answered with an error
    violations: list[str] = field(default_factory=list)
    used_hull: float = 0.0  # largest share of the hull's slack that exact torques needed
    used_rounding: float = 0.0  # largest error of NE* over its proved bound

    def add(self, other: Outcome) -> None:
        self.cases += other.cases
        self.states += other.states
        self.refused += other.refused
        self.violations += other.violations
        self.used_hull = max(self.used_hull, other.used_hull)
        self.used_rounding = max(self.used_rounding, other.used_rounding)


@dataclass(frozen=True)
class Bound:
    """One answer of the kernel. A perturbation is the torque minus u0 minus the disturbance."""

    name: str
    lo: Any  # (n,)
    hi: Any
    drives: bool
    nominal: Any = None  # u0 (n,), of a perturbation
    slack: Any = None  # (n,) what the kernel added for rounding, where it tells


Change = Callable[[Robot, "Query", list[Bound]], list[Bound]]


@dataclass(frozen=True)
class Query:
    """One state of one robot, as the kernel is asked."""

    signals: Signals
    dq_a: Any
    ddq_a: Any

    def vectors(self) -> tuple[Any, Any, Any, Any]:
        return self.signals.q, self.signals.dq, self.dq_a, self.ddq_a


def robot_of(seed: int) -> tuple[np.random.Generator, Written, Robot, bool]:
    """The seed's generator, robot, and whether only the reading by doubles holds for it."""
    rng = np.random.default_rng([4, seed])
    size = rng.random()
    n = int(rng.integers(1, 4) if size < 0.3 else rng.integers(4, 9))
    if size > 0.95:
        n = int(rng.integers(9, 31) if size > 0.99 else rng.integers(9, 15))
    followers = int(rng.integers(1, 3)) if rng.random() < 0.2 else 0
    written = random_written(rng, n, followers)
    robot = make_robot(rng, written)
    skew = rng.random() < 0.1
    return rng, written, skewed(rng, robot) if skew else robot, skew


def run_seed(seed: int, change: Change | None = None) -> Outcome:
    """All cases of one robot; `change` alters the kernel's answers, to see a check fail."""
    ctx.prec = PRECISION
    rng, written, robot, skew = robot_of(seed)
    outcome = Outcome()
    for number in range(STATES):
        exact = not skew and rng.random() < 0.5
        as_given = rng.random() < 0.2  # the reference velocity in real arithmetic too
        kind, signals = random_signals(rng, robot)
        dq_a, ddq_a = auxiliary(robot, signals)
        query = Query(signals, dq_a, ddq_a)
        label = f"seed {seed} state {number} ({kind}, {'written' if exact else 'doubles'})"

        def build(exact: bool = exact, as_given: bool = as_given, query: Query = query) -> Any:
            model = exact_robot(written) if exact else from_doubles(robot)
            return model, coefficients(model, _state(robot, query, as_given))

        outcome.states += 1
        try:
            bounds = list(answers(robot, query, as_given))
        except mr.ModrobustError:
            outcome.refused += 1
            continue
        if change:
            bounds = change(robot, query, bounds)
        outcome.add(_check(rng, robot, query, bounds, build, label, rounding=not as_given))
    return outcome


def _state(robot: Robot, query: Query, as_given: bool) -> State:
    """The state in balls; with `as_given`, (4) in real arithmetic on the signals."""
    q, dq = ([arb(x) for x in v.tolist()] for v in (query.signals.q, query.signals.dq))
    if not as_given:
        dq_a, ddq_a = ([arb(x) for x in v.tolist()] for v in (query.dq_a, query.ddq_a))
        return State(q, dq, dq_a, ddq_a)
    K_r = [arb(k) for k in robot.controller.K_r]
    q_des, dq_des, ddq_des = ([arb(x) for x in v.tolist()] for v in query.signals[2:])
    return State(
        q,
        dq,
        [v + k * (x_des - x) for v, k, x_des, x in zip(dq_des, K_r, q_des, q, strict=True)],
        [a + k * (v_des - v) for a, k, v_des, v in zip(ddq_des, K_r, dq_des, dq, strict=True)],
    )


def answers(robot: Robot, query: Query, as_given: bool) -> Iterator[Bound]:
    """The kernel's bounds for one state, all functions and methods."""
    state = query.vectors()
    for method in METHODS:
        controller = RobustController(robot, bound=method)
        command = controller.command(0.0, *query.signals)
        yield Bound(f"command {method}", command.phi_lo, command.phi_hi, True, command.nominal)
        if as_given:
            continue
        nominal = mr.inverse_dynamics(robot, *state)
        lo, hi = mr.perturbation_bounds(robot, *state, method=method)
        yield Bound(f"perturbation {method}", lo, hi, True, nominal)
        for drives in (True, False):
            lo, hi = mr.inverse_dynamics_bounds(robot, *state, method=method, drives=drives)
            slack = bounds_slack(robot, query, drives) if method == "hull" else None
            yield Bound(f"torque {method}, drives {drives}", lo, hi, drives, slack=slack)


def bounds_slack(robot: Robot, query: Query, drives: bool) -> Any:
    """What the hull of the torques holds for rounding, (n,)."""
    box = (robot.nominal.packed, robot.lower.packed, robot.upper.packed)
    state = [np.ascontiguousarray(x, dtype=float) for x in query.vectors()]
    return _kernel.bounds_slack(robot.model, *box, *state, METHODS["hull"], drives)


def _signs(
    rng: np.random.Generator, robot: Robot, rows: Coefficients, count: int
) -> list[list[arb]]:
    """For each point and joint, a sign of (20): smooth, sgn(dq), or any where |dq| <= v_c."""
    speeds = robot.coulomb_speed.tolist()
    options = []
    for dq, smooth, v_c in zip(rows.dq, rows.smooth_sign, speeds, strict=True):
        slow = bool(abs(dq) < 0.999 * v_c)
        # far below v_c any sign is allowed; above, the sign of dq is known
        options.append([smooth, arb(1), arb(-1)] if slow else [smooth, arb(1 if dq > 0 else -1)])
    picks = rng.integers(0, 6, (count, robot.j)).tolist()
    return [
        [choice[k % len(choice)] for choice, k in zip(options, row, strict=True)] for row in picks
    ]


def exact_torques(
    robot: Robot, rows: Coefficients, points: Any, signs: list[list[arb]]
) -> dict[str, list[list[arb]]]:
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


def _check(
    rng: np.random.Generator,
    robot: Robot,
    query: Query,
    bounds: list[Bound],
    build: Callable[[], tuple[BallRobot, Coefficients]],
    label: str,
    rounding: bool,
) -> Outcome:
    _, rows = build()
    points = parameter_points(rng, robot, rows, MOST_EXTREMES)
    picks = np.random.default_rng(rng.integers(1 << 62))
    again = picks.bit_generator.state
    torques = exact_torques(robot, rows, points, _signs(picks, robot, rows, len(points)))
    outcome = Outcome(cases=len(points))
    problems, decided = _compare(robot, bounds, torques, outcome)
    if not decided:
        ctx.prec = WIDEST
        _, rows = build()
        picks.bit_generator.state = again
        torques = exact_torques(robot, rows, points, _signs(picks, robot, rows, len(points)))
        problems, decided = _compare(robot, bounds, torques, outcome)
        ctx.prec = PRECISION
    outcome.violations += [f"{label}: {problem}" for problem in problems]
    if rounding and hasattr(_kernel, "inverse_dynamics_rounding"):
        _check_rounding(robot, query, points, torques, label, outcome)
    return outcome


def _compare(
    robot: Robot, bounds: list[Bound], torques: dict[str, list[list[arb]]], outcome: Outcome
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
    torques: dict[str, list[list[arb]]],
    label: str,
    outcome: Outcome,
) -> None:
    """|NE* in doubles - exact| stays within the bound that the kernel states."""
    state = [np.ascontiguousarray(x, dtype=float) for x in query.vectors()]
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
