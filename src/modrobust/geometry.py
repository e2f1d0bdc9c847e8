r"""Rigid transforms as 4x4 matrices: elementary motions, D-H in its conventions, the inverse.

``T_ab`` takes coordinates in frame b to frame a, so that ``T_ac = T_ab @ T_bc``. Lengths are in
[m], angles in [rad]. Every function returns a fresh C-contiguous float64 array, shape ``(4, 4)``.

Descriptions write right angles, and a right angle that is off by 6e-17 makes parallel axes almost
parallel. The cosine and sine of an angle that is the very double nearest to k pi/2, abs(k) <= 16,
are therefore the exact 0, 1 or -1; no other angle is touched.

Source: conventions as in docs/formats.md; standard D-H is (10) and (11) of Giusti and Althoff 2017.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_QUARTERS = 16
# pi to 50 decimals: float(Fraction) rounds k pi/2 once, where k * (math.pi / 2) would round twice.
_PI = Fraction("3.14159265358979323846264338327950288419716939937510")
_COS_SIN = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
_EXACT = {float(k * _PI / 2): _COS_SIN[k % 4] for k in range(-_QUARTERS, _QUARTERS + 1)}


def cos_sin(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle [rad], exact at the nearest doubles of k pi/2, abs(k) <= 16."""
    exact = _EXACT.get(float(angle))
    return (math.cos(angle), math.sin(angle)) if exact is None else exact


def _matrix(rows: Sequence[Sequence[float]]) -> Array:
    # + 0.0 turns -0.0 into 0.0, so that resolved robots do not show "-0.0".
    return np.array([*rows, [0.0, 0.0, 0.0, 1.0]], dtype=np.float64) + 0.0


def rotation_x(angle: float) -> Array:
    """Rx(angle): rotation about x by `angle` [rad], shape ``(4, 4)``."""
    c, s = cos_sin(angle)
    return _matrix([[1.0, 0.0, 0.0, 0.0], [0.0, c, -s, 0.0], [0.0, s, c, 0.0]])


def rotation_y(angle: float) -> Array:
    """Ry(angle): rotation about y by `angle` [rad], shape ``(4, 4)``."""
    c, s = cos_sin(angle)
    return _matrix([[c, 0.0, s, 0.0], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, 0.0]])


def rotation_z(angle: float) -> Array:
    """Rz(angle): rotation about z by `angle` [rad], shape ``(4, 4)``."""
    c, s = cos_sin(angle)
    return _matrix([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])


def translation(xyz: Sequence[float] | Array) -> Array:
    """Translation by `xyz`, shape ``(3,)`` [m], as a ``(4, 4)`` transform."""
    x, y, z = (float(value) for value in xyz)
    return _matrix([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]])


def dh_standard(a: float, alpha: float, d: float, theta: float) -> Array:
    """Rz(theta) Tz(d) Tx(a) Rx(alpha): lengths [m], angles [rad], shape ``(4, 4)``.

    Source: (10) and (11) of Giusti and Althoff 2017.
    """
    ct, st = cos_sin(theta)
    ca, sa = cos_sin(alpha)
    return _matrix(
        [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0.0, sa, ca, d]]
    )


def dh_modified(a: float, alpha: float, d: float, theta: float) -> Array:
    """Rx(alpha) Tx(a) Rz(theta) Tz(d): lengths [m], angles [rad], shape ``(4, 4)``."""
    ct, st = cos_sin(theta)
    ca, sa = cos_sin(alpha)
    return _matrix(
        [
            [ct, -st, 0.0, a],
            [st * ca, ct * ca, -sa, -d * sa],
            [st * sa, ct * sa, ca, d * ca],
        ]
    )


def giusti2015(
    p: float, delta_in: float, a: float, alpha: float, n: float, delta_out: float
) -> Array:
    """Tz(-p) Rz(-delta_in) Tx(a) Rx(alpha) Tz(n) Rz(delta_out): [m] and [rad], ``(4, 4)``.

    Source: extended D-H letters of Giusti and Althoff 2015, in their own signs.
    """
    proximal = translation((0.0, 0.0, -p)) @ rotation_z(-delta_in)
    return _extended(proximal, a, alpha, n, delta_out)


def giusti2015_iit(
    p: float, delta_in: float, a: float, alpha: float, n: float, delta_out: float
) -> Array:
    """Rz(delta_in) Tz(p) Tx(a) Rx(alpha) Tz(n) Rz(delta_out): [m] and [rad], ``(4, 4)``.

    The same letters as `giusti2015`, with p and delta_in of the opposite sign, as the Istituto
    Italiano di Tecnologia's module files write them.
    """
    proximal = rotation_z(delta_in) @ translation((0.0, 0.0, p))
    return _extended(proximal, a, alpha, n, delta_out)


def _extended(proximal: Array, a: float, alpha: float, n: float, delta_out: float) -> Array:
    middle = translation((a, 0.0, 0.0)) @ rotation_x(alpha)
    distal = translation((0.0, 0.0, n)) @ rotation_z(delta_out)
    return proximal @ middle @ distal + 0.0


def from_xyz_rpy(
    xyz: Sequence[float] | Array = (0.0, 0.0, 0.0), rpy: Sequence[float] | Array = (0.0, 0.0, 0.0)
) -> Array:
    """Translation by `xyz` (3,) [m], then Rz(yaw) Ry(pitch) Rx(roll) of `rpy` (3,) [rad]."""
    roll, pitch, yaw = (float(value) for value in rpy)
    turned = rotation_z(yaw) @ rotation_y(pitch) @ rotation_x(roll)
    return translation(xyz) @ turned + 0.0


def inverse(transform: Array) -> Array:
    """Inverse of a rigid transform, shape ``(4, 4)``: [R p; 0 1] becomes [R' -R'p; 0 1]."""
    turned = transform[:3, :3].T
    result = np.eye(4)
    result[:3, :3] = turned
    result[:3, 3] = -turned @ transform[:3, 3]
    return result + 0.0
