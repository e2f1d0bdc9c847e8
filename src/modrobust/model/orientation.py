r"""Angles and quaternions that give a rotation matrix back to the last few bits."""

from __future__ import annotations

import math

import numpy as np

from modrobust.checks.types import Array

_GIMBAL = 2.0**-52  # cos(pitch) below which roll and yaw are one angle


def roll_pitch_yaw(R: Array) -> tuple[float, float, float]:
    r"""Fixed-axis angles of a rotation, accurate also where the pitch is near a right angle.

    .. math:: R = R_z(y)\,R_y(p)\,R_x(r)

    The yaw comes first; roll and pitch are then read from Rz(-y) R, so that an ill-determined yaw
    is made good by the roll. asin of one entry would lose half of the digits there.

    Args:
        R: Rotation matrix, shape ``(3, 3)``.

    Returns:
        r, p, y [rad].
    """
    yaw = 0.0 if math.hypot(R[0, 0], R[1, 0]) < _GIMBAL else math.atan2(R[1, 0], R[0, 0])
    c, s = math.cos(yaw), math.sin(yaw)
    x = c * R[0] + s * R[1]
    y = c * R[1] - s * R[0]
    return math.atan2(-y[2], y[1]), math.atan2(-R[2, 0], x[0]), yaw


def quaternion(R: Array) -> tuple[float, float, float, float]:
    """Unit quaternion w, x, y, z of a rotation ``(3, 3)``, w >= 0.

    The largest of the four is computed from a square root, the others by division, so that nothing
    cancels.

    Source: [SH78].
    """
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    squares = [1.0 + trace, *(1.0 - trace + 2.0 * R[k, k] for k in range(3))]
    largest = int(np.argmax(squares))
    if largest == 0:
        q = [squares[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q = [R[k, j] - R[j, k], 0.0, 0.0, 0.0]
        q[1 + i] = squares[largest]
        q[1 + j] = R[i, j] + R[j, i]
        q[1 + k] = R[i, k] + R[k, i]
    norm = math.copysign(math.sqrt(math.fsum(x * x for x in q)), q[0] if q[0] else 1.0)
    w, x, y, z = (float(part) / norm for part in q)
    return w, x, y, z
