r"""One mode of the closed loop as the drive runs it: when it is stable, and what moves it.

.. math::
   \hat e &= e + D T \dot e - (D T)^2 \xi u / 2, \qquad \hat{\dot e} = \dot e - D T \xi u \\
   y &= K_d \hat{\dot e} + K_p \hat e, \qquad K_d = \tfrac32 G,\; K_p = \tfrac12 G^2 \\
   e^+ &= e + T \dot e - \pi T^2 \left[(D - D^2/2)\,u + (1 - D)^2 y / 2\right] \\
   \dot e^+ &= \dot e - \pi T \left[D u + (1 - D) y\right], \qquad u^+ = y                \quad (37)

with pi an eigenvalue of M^-1 M_s and xi one of M_c^-1 M_s. The modes of the robot do not part
like this (the matrices do not commute): it is the rule that the gains come from, not a proof.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from modrobust.checks.types import Array
from modrobust.design.spectra import Spectra

LAMBDA = 0.5  # of G
MARGIN = 1.8  # the loop must still be stable at this multiple of the gains
_CRITICAL = 1.328  # G T max(pi_2, 1): 4/3 without the integral, 1.305 with L_i = G^2 / 20
_GRID = 9  # values of xi and of c
_COARSE = np.geomspace(0.02, 1.4, 60)  # of G T, tried upwards
_HALVINGS = 24
_LEAST_SHARE = 0.005
_EDGE = 1e-3  # relative: values of pi that far beyond its range still count


@dataclass(frozen=True)
class LoopTiming:
    """The loop's timing: its period, and how late a command and a velocity are."""

    period: float
    """T [s]."""
    delay: float
    """D, in periods, 0 to 1."""
    corner: float | None = None
    """Of the filter of a velocity differentiated from positions [Hz]; None: it is measured."""


def filter_share(corner: float, period: float) -> float:
    """Share of what is new that a filter of first order takes in a period [s]; its corner [Hz]."""
    return -math.expm1(-2.0 * math.pi * corner * period)


def stable_gain(found: Spectra, timing: LoopTiming) -> float:
    r"""G_stab [1/s]: 1/1.8 of the largest G for which every mode of (37) is stable.

    .. math:: G_{stab} = \frac{0.738}{T \max(\pi_2, 1)} \quad (D = 0), \qquad
              G_{stab} = \frac{1}{T} \max\{g : \text{the loop of } 1.8 g \text{ is stable for all }
              \xi, c\}

    over c in [c_1, c_2], xi in [xi_1, 1] with pi = xi c in [pi_1, pi_2].

    Args:
        found: Ranges (36).
        timing: Of the loop.

    Source: our own; (37) of docs/theory/equations.md.
    """
    least, most = found.light
    if timing.delay == 0.0 and timing.corner is None:
        return _CRITICAL / MARGIN / (timing.period * max(most, 1.0))
    xi, c = np.meshgrid(
        np.geomspace(min(max(found.least_share, _LEAST_SHARE), 1.0), 1.0, _GRID),
        np.geomspace(*found.centre, _GRID),
    )
    pi = (xi * c).ravel()
    inside = (pi >= least * (1.0 - _EDGE)) & (pi <= most * (1.0 + _EDGE))
    # The ends themselves too, whatever falls between the points of the grid.
    pi = np.concatenate([pi[inside], [least, most]])
    xi = np.concatenate([xi.ravel()[inside], np.minimum(1.0, [least / found.centre[0], 1.0])])
    unit = LoopTiming(
        1.0, timing.delay, None if timing.corner is None else timing.corner * timing.period
    )

    def stable(g: float) -> bool:
        loop = matrices(MARGIN * g, pi, xi, unit)[:, :4, :4]  # without the integral
        return bool((np.abs(np.linalg.eigvals(loop)).max(axis=1) < 1.0).all())

    good = 0.0
    for g in _COARSE:
        if not stable(float(g)):
            bad = float(g)
            break
        good = float(g)
    else:
        return good / timing.period
    for _ in range(_HALVINGS):
        g = 0.5 * (good + bad)
        good, bad = (g, bad) if stable(g) else (good, g)
    return good / timing.period


def matrices(G: float, pi: Array, xi: Array, timing: LoopTiming, L_i: float = 0.0) -> Array:
    r"""The loop (37) as x^+ = A x, ``(k, 5, 5)``, for eigenvalues pi and xi ``(k,)``.

    x = (e, de, u, v, sigma): error, its rate, the command that acts until the new one does, the
    rate as a filter gives it from the error of now and of one period ago, and the integral.

    Args:
        G: Gain [1/s]; K_d = 3/2 G, K_p = G^2/2.
        pi: Eigenvalues of M^-1 M_s, ``(k,)``.
        xi: Eigenvalues of M_c^-1 M_s, ``(k,)``.
        timing: Of the loop.
        L_i: Gain of the integral [1/s^2], 0 for none.
    """
    T, D = timing.period, timing.delay
    K_d, K_p = (1.0 + LAMBDA) * G, LAMBDA * G * G
    lam = LAMBDA * G
    k = len(pi)

    def row(e: object, de: object, u: object, v: object, s: object) -> Array:
        return np.stack(
            [np.broadcast_to(np.asarray(x, dtype=float), k) for x in (e, de, u, v, s)], axis=1
        )

    # The rate that the law sees. The error one period ago follows from e, de and what acted since.
    if timing.corner is None:
        rate = row(0.0, 1.0, 0.0, 0.0, 0.0)
        kept = row(0.0, 0.0, 0.0, 0.0, 0.0)
    else:
        a = filter_share(timing.corner, T)
        # v holds (1 - a) v_hat - a e / T of the last period: v_hat = v + a e / T.
        rate = row(a / T, 0.0, 0.0, 1.0, 0.0)
        kept = (1.0 - a) * rate - row(a / T, 0.0, 0.0, 0.0, 0.0)
    held = row(0.0, 0.0, 1.0, 0.0, 0.0) * xi[:, None]
    e_hat = row(1.0, 0.0, 0.0, 0.0, 0.0) + D * T * rate - 0.5 * (D * T) ** 2 * held
    rate_hat = rate - D * T * held
    sigma = row(0.0, 0.0, 0.0, 0.0, 1.0) + T * L_i * (rate_hat + lam * e_hat)
    y = K_d * rate_hat + K_p * e_hat + sigma
    u = row(0.0, 0.0, 1.0, 0.0, 0.0)
    P = pi[:, None]
    e_next = row(1.0, T, 0.0, 0.0, 0.0)
    e_next = e_next - P * T**2 * ((D - 0.5 * D * D) * u + 0.5 * (1.0 - D) ** 2 * y)
    de_next = row(0.0, 1.0, 0.0, 0.0, 0.0) - P * T * (D * u + (1.0 - D) * y)
    return np.stack([e_next, de_next, y, kept, sigma], axis=1)


def compliance(
    G: float, L_i: float, pi: Array, xi: Array, timing: LoopTiming, omega: float
) -> float:
    r"""Largest error per acceleration b of the disturbance, at one frequency [s^2].

    .. math:: |H(\omega)| = \max_{\pi, \xi} \left| (1, 0, \dots)\,(z - A)^{-1} B \right|,
              \quad z = e^{i \omega T},\; B = \pi\,(T^2/2,\, T,\, 0, \dots)

    Args:
        G: Gain of the feedback [1/s].
        L_i: Gain of the integral [1/s^2].
        pi: Eigenvalues of M^-1 M_s, ``(k,)``.
        xi: Eigenvalues of M_c^-1 M_s, ``(k,)``.
        timing: Of the loop.
        omega: Frequency [rad/s].
    """
    T = timing.period
    A = matrices(G, pi, xi, timing, L_i)
    z = complex(math.cos(omega * T), math.sin(omega * T))
    B = np.zeros((len(pi), 5, 1), dtype=complex)
    B[:, 0, 0], B[:, 1, 0] = 0.5 * T * T * pi, T * pi
    found = np.linalg.solve(z * np.eye(5) - A, B)
    return float(np.abs(found[:, 0, 0]).max())
