r"""Rigid transforms in 60 decimals, rounded to doubles once: motions, D-H, their products.

``T_ab`` takes coordinates in frame b to frame a, so that ``T_ac = T_ab @ T_bc``. Lengths are in
[m], angles in [rad]; both may be floats, decimals or rationals: numbers as a description says them.

Descriptions write right angles, and a right angle that is off by 6e-17 makes parallel axes almost
parallel. An angle whose nearest double is the one nearest to k pi/2, abs(k) <= 16, therefore counts
as that right angle, with a cosine and sine of 0, 1 or -1; no other angle is touched.

Errors: with 60 digits those of a thousand products stay below 1e-50. What is left below 1e-40 (of
the lengths that were added, in a translation) is taken as the 0 that was meant. So the doubles of
`Transform.rounded` are the nearest ones, but for cases closer than that to the middle of two.

Source: conventions as in docs/reference/formats.md; standard D-H is (10) and (11) of [GA17].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import (
    MAX_EMAX,
    MIN_EMIN,
    ROUND_HALF_EVEN,
    Context,
    Decimal,
    DivisionByZero,
    InvalidOperation,
    Overflow,
    localcontext,
)
from fractions import Fraction

import numpy as np

from modrobust.checks.types import Array
from modrobust.errors import ValueRangeError

Real = float | Fraction | Decimal
Row = tuple[Decimal, Decimal, Decimal, Decimal]

MAX_ANGLE = 1e5  # [rad], as for a joint: more is a slip
# pi to 100 decimals, truncated. Source: OEIS A000796.
PI_DIGITS = (
    "3.14159265358979323846264338327950288419716939937510"
    "58209749445923078164062862089986280348253421170679"
)

# Our own, whatever the caller's context is: every operation on decimals stands in a `with` of it.
_DIGITS = Context(
    60, ROUND_HALF_EVEN, MIN_EMIN, MAX_EMAX, traps=[InvalidOperation, DivisionByZero, Overflow]
)
_ZERO, _ONE = Decimal(0), Decimal(1)
_LEFT_OF_ZERO = Decimal("1e-40")
_LAST_TERM = Decimal("1e-62")
_QUARTER = _DIGITS.divide(Decimal(PI_DIGITS), Decimal(2))
_RIGHT_ANGLES = {float(k * Fraction(PI_DIGITS) / 2): k for k in range(-16, 17)}


@dataclass(frozen=True)
class Transform:
    """A rigid transform ``(4, 4)`` by its three upper rows; the last one is 0 0 0 1."""

    rows: tuple[Row, Row, Row]

    def __matmul__(self, other: Transform) -> Transform:
        """T_ac = T_ab @ T_bc."""
        with localcontext(_DIGITS):
            *rotated, (px, py, pz) = zip(*other.rows, strict=True)
            small = _LEFT_OF_ZERO * max(abs(row[3]) for row in (*self.rows, *other.rows))
            rows = []
            for a, b, c, d in self.rows:
                entries = (a * x + b * y + c * z for x, y, z in rotated)
                xx, xy, xz = (v if abs(v) > _LEFT_OF_ZERO else _ZERO for v in entries)
                p = a * px + b * py + c * pz + d
                rows.append((xx, xy, xz, p if abs(p) > small else _ZERO))
        return Transform((rows[0], rows[1], rows[2]))

    def inverse(self) -> Transform:
        """[R p; 0 1] becomes [R' -R'p; 0 1]."""
        *rotated, moved = zip(*self.rows, strict=True)
        back = from_rows([(*column, _ZERO) for column in rotated])
        with localcontext(_DIGITS):
            x, y, z = (-entry for entry in moved)
        return back @ translation((x, y, z))

    def rounded(self) -> Array:
        """Every entry as its nearest double, shape ``(4, 4)``, float64."""
        entries = [[float(entry) for entry in row] for row in self.rows]
        # + 0.0 turns -0.0 into 0.0, so that resolved robots do not show "-0.0".
        return np.array([*entries, [0.0, 0.0, 0.0, 1.0]]) + 0.0


def from_rows(rows: Sequence[Sequence[Real]]) -> Transform:
    """The transform of the three upper rows ``(3, 4)``; the caller knows that it is rigid."""
    with localcontext(_DIGITS):
        first, second, third = (
            (_decimal(x), _decimal(y), _decimal(z), _decimal(p)) for x, y, z, p in rows
        )
    return Transform((first, second, third))


def _decimal(value: Real) -> Decimal:
    """A number as a decimal; rationals to the digits of the context."""
    if isinstance(value, Fraction):
        return Decimal(value.numerator) / value.denominator
    return Decimal(value)


def cos_sin(angle: Real) -> tuple[Decimal, Decimal]:
    """Cosine and sine of an angle [rad], exact for the right angles named above.

    Raises:
        ValueRangeError: The angle is beyond 1e5 rad.
    """
    with localcontext(_DIGITS):
        exact = _decimal(angle)
        if not abs(exact) <= MAX_ANGLE:
            raise ValueRangeError(
                f"an angle of {exact:.6g} rad; angles lie within {MAX_ANGLE:g} rad; "
                "reduce it by whole turns"
            )
        turns = _RIGHT_ANGLES.get(float(angle))
        rest = _ZERO
        if turns is None:
            turns = int((exact / _QUARTER).to_integral_value())
            rest = exact - turns * _QUARTER
        return _turned(turns, rest if abs(rest) > _LEFT_OF_ZERO else _ZERO)


def arctan2(y: float, x: float) -> float:
    """Angle [rad] of the direction (x, y), the nearest double: the same on every machine.

    libm's is where it starts, whose last bits depend on the processor; a step of Newton's method in
    60 digits takes their error of 1e-16 to 1e-48.
    """
    start = math.atan2(y, x)
    if x == 0.0 or y == 0.0:
        return start  # a multiple of pi/2 or 0, correctly rounded
    with localcontext(_DIGITS):
        angle, a, b = Decimal(start), Decimal(y), Decimal(x)
        turns = int((angle / _QUARTER).to_integral_value())
        cosine, sine = _turned(turns, angle - turns * _QUARTER)
        return float(angle + (a * cosine - b * sine) / (a * a + b * b).sqrt())


def _turned(turns: int, rest: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine of so many quarter turns and the rest, at most an eighth turn."""
    cosine, sine = _series(rest)
    return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[turns % 4]


def _series(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine of an angle up to pi/4, in the digits of the context."""
    square = angle * angle
    cosine = even = _ONE
    sine = odd = angle
    n = 0
    while abs(odd) > _LAST_TERM or abs(even) > _LAST_TERM:
        n += 2
        even *= -square / (n * (n - 1))
        odd *= -square / (n * (n + 1))
        cosine += even
        sine += odd
    return cosine, sine


def rotation_x(angle: Real) -> Transform:
    """Rx(angle): rotation about x by `angle` [rad]."""
    c, s = cos_sin(angle)
    return from_rows([(1, 0, 0, 0), (0, c, s.copy_negate(), 0), (0, s, c, 0)])


def rotation_y(angle: Real) -> Transform:
    """Ry(angle): rotation about y by `angle` [rad]."""
    c, s = cos_sin(angle)
    return from_rows([(c, 0, s, 0), (0, 1, 0, 0), (s.copy_negate(), 0, c, 0)])


def rotation_z(angle: Real) -> Transform:
    """Rz(angle): rotation about z by `angle` [rad]."""
    c, s = cos_sin(angle)
    return from_rows([(c, s.copy_negate(), 0, 0), (s, c, 0, 0), (0, 0, 1, 0)])


def rotation_to(axis: Sequence[Real]) -> Transform:
    """A rotation that takes z to the direction of `axis` (3,), and z to z as the identity.

    Source: [DU17], free of cancellation for every direction.
    """
    with localcontext(_DIGITS):
        x, y, z = (_decimal(entry) for entry in axis)
        length = (x * x + y * y + z * z).sqrt()
        x, y, z = x / length, y / length, z / length
        sign = _ONE if z >= 0 else -_ONE
        a = -1 / (sign + z)
        b = x * y * a
        return Transform(
            (
                (1 + sign * x * x * a, b, x, _ZERO),
                (sign * b, sign + y * y * a, y, _ZERO),
                (-sign * x, -y, z, _ZERO),
            )
        )


def translation(xyz: Sequence[Real]) -> Transform:
    """Translation by `xyz`, shape ``(3,)`` [m]."""
    x, y, z = xyz
    return from_rows([(1, 0, 0, x), (0, 1, 0, y), (0, 0, 1, z)])


IDENTITY = translation((0, 0, 0))


def _tx(a: Real) -> Transform:
    return translation((a, 0, 0))


def _tz(d: Real) -> Transform:
    return translation((0, 0, d))


def dh_standard(a: Real, alpha: Real, d: Real, theta: Real) -> Transform:
    """Rz(theta) Tz(d) Tx(a) Rx(alpha): lengths [m], angles [rad].

    Source: (10) and (11) of [GA17].
    """
    return rotation_z(theta) @ translation((a, 0, d)) @ rotation_x(alpha)


def dh_modified(a: Real, alpha: Real, d: Real, theta: Real) -> Transform:
    """Rx(alpha) Tx(a) Rz(theta) Tz(d): lengths [m], angles [rad]."""
    return rotation_x(alpha) @ _tx(a) @ rotation_z(theta) @ _tz(d)


def giusti2015(
    p: Real, delta_in: Real, a: Real, alpha: Real, n: Real, delta_out: Real
) -> Transform:
    """Tz(-p) Rz(-delta_in) Tx(a) Rx(alpha) Tz(n) Rz(delta_out): [m] and [rad].

    Source: extended D-H letters of [GA15], in their own signs.
    """
    proximal = (rotation_z(delta_in) @ _tz(p)).inverse()
    return proximal @ _tx(a) @ rotation_x(alpha) @ _tz(n) @ rotation_z(delta_out)


def giusti2015_iit(
    p: Real, delta_in: Real, a: Real, alpha: Real, n: Real, delta_out: Real
) -> Transform:
    """Rz(delta_in) Tz(p) Tx(a) Rx(alpha) Tz(n) Rz(delta_out): [m] and [rad].

    The same letters as `giusti2015`, with p and delta_in of the opposite sign, as the Istituto
    Italiano di Tecnologia's module files write them.
    """
    proximal = rotation_z(delta_in) @ _tz(p)
    return proximal @ _tx(a) @ rotation_x(alpha) @ _tz(n) @ rotation_z(delta_out)


def from_xyz_rpy(xyz: Sequence[Real] = (0, 0, 0), rpy: Sequence[Real] = (0, 0, 0)) -> Transform:
    """Translation by `xyz` (3,) [m], then Rz(yaw) Ry(pitch) Rx(roll) of `rpy` (3,) [rad]."""
    roll, pitch, yaw = rpy
    return translation(xyz) @ rotation_z(yaw) @ rotation_y(pitch) @ rotation_x(roll)


def from_xyz_quaternion(xyz: Sequence[Fraction], xyzw: Sequence[Fraction]) -> Transform:
    r"""Translation by `xyz` (3,) [m], then the rotation of a quaternion `xyzw` (4,), w the last.

    .. math:: R = \frac{1}{x^2 + y^2 + z^2 + w^2} \begin{pmatrix}
        w^2 + x^2 - y^2 - z^2 & 2 (x y - w z) & 2 (x z + w y) \\
        2 (x y + w z) & w^2 - x^2 + y^2 - z^2 & 2 (y z - w x) \\
        2 (x z - w y) & 2 (y z + w x) & w^2 - x^2 - y^2 + z^2 \end{pmatrix}

    Rational in the four numbers, so that it needs no square root; any length but 0 will do.

    Source: the definition R p = q p q* of a rotation by a quaternion, multiplied out.
    """
    x, y, z, w = xyzw
    square = x * x + y * y + z * z + w * w
    rows = [
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    ]
    return from_rows(
        [(*(entry / square for entry in row), p) for row, p in zip(rows, xyz, strict=True)]
    )
