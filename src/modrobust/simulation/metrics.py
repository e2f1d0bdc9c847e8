"""Figures drawn from a logged run: chattering, times, widths."""

from __future__ import annotations

from typing import Any

import numpy as np

from modrobust.checks.types import Array

LARGEST_ERROR = 0.3  # [rad] or [m], late error of a good run
MOST_AT_LIMIT = 0.05  # of the ticks of a good run, that torque limits may cut a command
CHATTERING_WINDOW = 5.0  # [s]
CHATTERING_LIMIT = 1.1
_SLOW = 0.1  # [s], sampling at 10 Hz


def chattering(t: Array, tau: Array, total_variation: Array) -> Array | None:
    """How much more each torque moves than the same signal sampled at 10 Hz does, ``(n,)``.

    Over the last 5 s, the total variation over all ticks divided by that of the logged signal at
    10 Hz. 1 is a signal without any fast part; above 1.1 counts as chattering. None for runs that
    are shorter. A torque that does not move at all gets 1.

    Args:
        t: Logged instants, (m,) [s], about 1 ms apart.
        tau: Torques, (m, n).
        total_variation: Sum of |tau_k - tau_(k-1)| over all ticks so far, (m, n).
    """
    if len(t) < 2 or t[-1] - t[0] < CHATTERING_WINDOW - 1e-9:
        return None
    instants = t[-1] - CHATTERING_WINDOW + _SLOW * np.arange(round(CHATTERING_WINDOW / _SLOW) + 1)
    # The nearest logged instant; they lie on a grid that 10 Hz divides at the usual rates.
    right = np.clip(np.searchsorted(t, instants), 1, len(t) - 1)
    index = np.where(instants - t[right - 1] < t[right] - instants, right - 1, right)
    slow = np.abs(np.diff(tau[index], axis=0)).sum(axis=0)
    fast = total_variation[index[-1]] - total_variation[index[0]]
    still = slow <= 1e-12 * (1.0 + np.abs(tau[index]).max(axis=0))
    ratio = np.where(still, 1.0, fast / np.where(still, 1.0, slow))
    # Standing still at 10 Hz but moving in between is the worst there is.
    return np.where(still & (fast > 1e-9 * (1.0 + np.abs(tau[index]).max(axis=0))), np.inf, ratio)


def time_statistics(seconds: Array) -> dict[str, float | None]:
    """Mean, largest, standard deviation, percentiles and least of times [s]; None when empty."""
    if len(seconds) == 0:
        return dict.fromkeys(("mean", "max", "std", "p50", "p99", "min"))
    return {
        "mean": float(np.mean(seconds)),
        "max": float(np.max(seconds)),
        "std": float(np.std(seconds)),
        "p50": float(np.percentile(seconds, 50)),
        "p99": float(np.percentile(seconds, 99)),
        "min": float(np.min(seconds)),
    }


def ratio(numerator: Array, denominator: Array) -> Array:
    """Element-wise quotient; nan where the denominator is not positive."""
    positive = denominator > 0.0
    return np.where(positive, numerator / np.where(positive, denominator, 1.0), np.nan)


def plain(value: Any) -> Any:
    """Arrays and numbers as plain Python for JSON; what is not finite becomes None."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    return value
