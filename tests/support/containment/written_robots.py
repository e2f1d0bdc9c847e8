"""Random geometry as a file would write it: decimals and degrees, exactly, and its doubles.

A span is a row of elementary moves (D-H, roll-pitch-yaw and the letters of module files are such
rows); its exact matrix is a product of balls with the angles as written, pi included, and the
robot's matrix is the nearest double of each entry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, fmpq

from support.containment.ball_dynamics import BallRobot, Pose
from support.containment.ball_vectors import ZERO, Matrix, add, back, product, times

Move = tuple[str, Fraction]  # "x", "y", "z" [m]; "rx", "ry", "rz" [half turns], "sx" ... [rad]


@dataclass(frozen=True)
class Written:
    """What a file says of a robot's geometry and constants; of the box, see parameter_boxes."""

    prismatic: list[bool]  # (j)
    parents: list[int]  # (j)
    base: list[Move]
    before: list[list[Move]]  # (j)
    after: list[list[Move]]  # (j)
    gravity: list[Fraction]  # world axes
    body_joints: list[int]
    placement: list[list[Move]]
    gear_ratio: list[Fraction]  # (j)
    coulomb_speed: list[Fraction]  # (j)
    moves: list[int]  # (j) the free joints, then those that mimic
    leaders: list[int]  # (j - n)
    multiplier: list[Fraction]
    offset: list[Move]  # one angle or length for each mimic joint

    @property
    def n(self) -> int:
        return len(self.parents) - len(self.leaders)


def ball(x: Fraction) -> arb:
    return arb(fmpq(x.numerator, x.denominator))


def nearest(x: arb) -> float:
    """The nearest double; exact zeros and ones that only cancel to a ball are taken as such."""
    for whole in (0, 1, -1):
        if x.contains(arb(whole)):
            return float(whole)
    man, exp = (int(part) for part in x.mid().man_exp())
    return float(man << exp) if exp >= 0 else man / (1 << -exp)  # int / int rounds correctly


def turn(move: Move) -> tuple[arb, arb]:
    """Sine and cosine of a written angle."""
    letter, value = move
    if letter.startswith("s"):
        return ball(value).sin_cos()
    quotient = fmpq(value.numerator, value.denominator)
    return arb.sin_pi_fmpq(quotient), arb.cos_pi_fmpq(quotient)


def amount(move: Move) -> arb:
    """A written angle [rad] or length [m]."""
    letter, value = move
    return ball(value) * arb.pi() if letter.startswith("r") else ball(value)


def exact_pose(moves: Sequence[Move]) -> Pose:
    """The product of elementary moves."""
    one, zero = arb(1), arb(0)
    R: Matrix = (one, zero, zero, zero, one, zero, zero, zero, one)
    p = ZERO
    for move in moves:
        axis = "xyz".index(move[0][-1])
        if len(move[0]) == 1:
            step = [zero, zero, zero]
            step[axis] = ball(move[1])
            p = add(p, times(R, tuple(step)))  # type: ignore[arg-type]
        else:
            s, c = turn(move)
            entries = [one if i == k else zero for i in range(3) for k in range(3)]
            i, k = (axis + 1) % 3, (axis + 2) % 3
            entries[4 * i] = entries[4 * k] = c
            entries[3 * i + k], entries[3 * k + i] = -s, s
            R = product(R, tuple(entries))  # type: ignore[arg-type]
    return Pose(R, p)


def nearest_matrix(pose: Pose) -> Any:
    """The 4x4 whose entries are the nearest doubles."""
    T = np.eye(4)
    T[:3, :3] = np.array([nearest(x) for x in pose.R]).reshape(3, 3)
    T[:3, 3] = [nearest(x) for x in pose.p]
    return T


def exact_robot(written: Written, framed: Sequence[bool]) -> BallRobot:
    """The robot with exact rotations and the constants as written; tensors are of the box."""
    g = [ball(x) for x in written.gravity]
    return BallRobot(
        prismatic=written.prismatic,
        parents=written.parents,
        before=[exact_pose(moves) for moves in written.before],
        after=[exact_pose(moves) for moves in written.after],
        gravity=back(exact_pose(written.base).R, (g[0], g[1], g[2])),
        body_joints=written.body_joints,
        placement=[exact_pose(moves) for moves in written.placement],
        framed=framed,
        gear_ratio=[ball(x) for x in written.gear_ratio],
        coulomb_speed=[ball(x) for x in written.coulomb_speed],
        moves=written.moves,
        leaders=written.leaders,
        multiplier=[ball(x) for x in written.multiplier],
        offset=[amount(move) for move in written.offset],
    )


def decimal(rng: np.random.Generator, size: float) -> Fraction:
    """A number up to `size` with one to six digits, as a file would write it."""
    digits = int(rng.integers(1, 7))
    exponent = int(np.floor(np.log10(size))) - digits + 1
    whole = int(rng.integers(-(10**digits), 10**digits + 1))
    return Fraction(whole) * Fraction(10) ** exponent


def angle(rng: np.random.Generator, axis: str) -> Move:
    """A right angle, one near to it, whole degrees, or radians."""
    kind = rng.random()
    right = Fraction(int(rng.integers(-2, 3)), 2)
    if kind < 0.35:
        return f"r{axis}", right
    if kind < 0.5:  # a right angle missed by little
        return f"r{axis}", right + Fraction(
            int(rng.integers(-9, 10)), 10 ** int(rng.integers(3, 18))
        )
    if kind < 0.8:
        return f"r{axis}", Fraction(int(rng.integers(-1800, 1801)), 1800)
    return f"s{axis}", decimal(rng, 3.0)


def length(rng: np.random.Generator, axis: str, reach: float) -> Move:
    if reach == 0.0 or rng.random() < 0.3:
        return axis, Fraction(0)
    if rng.random() < 0.15:  # from an atom's breadth to a kilometre
        reach = 10.0 ** rng.uniform(-9, 3)
    return axis, decimal(rng, reach)


def span(rng: np.random.Generator, reach: float) -> list[Move]:
    """Nothing, a D-H row, or xyz and rpy; sometimes two in a row."""
    kind = rng.random()
    if kind < 0.2:
        return []
    if kind < 0.6:
        moves = [angle(rng, "z"), length(rng, "z", reach)]
        moves += [length(rng, "x", reach), angle(rng, "x")]
    else:
        moves = [length(rng, axis, reach) for axis in "xyz"] + [angle(rng, axis) for axis in "zyx"]
    return moves + span(rng, reach) if rng.random() < 0.1 else moves


def random_written(
    rng: np.random.Generator, n: int, mimic_joints: int, sparse: bool = False
) -> Written:
    """A random robot with n free joints and that many mimic joints, half of the time anywhere.

    sparse: Without gravity and with few lengths, so that no large torque hides the rounding of
    another.
    """
    j = n + mimic_joints
    share = rng.choice([0.0, 0.3, 1.0], p=[0.4, 0.5, 0.1])  # of prismatic joints
    tree = rng.random() < 0.3
    parents = [int(rng.integers(-1, i)) if tree and i else i - 1 for i in range(j)]
    reach = 0.4 if rng.random() < 0.8 else 10.0 ** rng.uniform(-9, 3)
    counts = rng.integers(1, 4 if j <= 8 else 2, j)
    if rng.random() < 0.2:  # a link without a body
        counts[rng.integers(j)] = 0
    if j == 1:
        counts[0] = max(counts[0], 1)
    body_joints = [i for i in range(-1, j) for _ in range(1 if i < 0 else counts[i])]
    gravity = [Fraction(0), Fraction(0), Fraction(-981, 100)]
    if rng.random() < 0.3:
        gravity = [decimal(rng, 10.0) for _ in range(3)]
    if sparse:
        gravity = [Fraction(0)] * 3

    def some_reach() -> float:
        return 10.0 ** rng.uniform(-9, 3) * (rng.random() < 0.4) if sparse else reach

    drive = rng.random() < 0.7
    mimic = list(range(n, j))
    if mimic_joints and rng.random() < 0.5:
        mimic = sorted(rng.permutation(j)[:mimic_joints].tolist())
    return Written(
        prismatic=(rng.random(j) < share).tolist(),
        parents=parents,
        base=span(rng, some_reach()),
        before=[span(rng, some_reach()) if rng.random() < 0.4 else [] for _ in range(j)],
        after=[span(rng, some_reach()) for _ in range(j)],
        gravity=gravity,
        body_joints=body_joints,
        placement=[span(rng, some_reach()) if rng.random() < 0.5 else [] for _ in body_joints],
        gear_ratio=[abs(decimal(rng, 200.0)) * drive for _ in range(j)],
        coulomb_speed=[
            Fraction(int(rng.integers(1, 100))) * Fraction(10) ** int(rng.integers(-6, -1))
            for _ in range(j)
        ],
        moves=[*(i for i in range(j) if i not in mimic), *mimic],
        leaders=[int(k) for k in rng.integers(0, n, mimic_joints)],
        multiplier=[decimal(rng, 3.0) for _ in range(mimic_joints)],
        offset=[
            angle(rng, "z") if rng.random() < 0.7 else length(rng, "z", 1.0)
            for _ in range(mimic_joints)
        ],
    )
