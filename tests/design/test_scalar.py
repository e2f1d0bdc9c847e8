"""One mode of the loop: where it is stable, against its own simulation and by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from modrobust.design.scalar import MARGIN, LoopTiming, compliance, matrices, stable_gain
from modrobust.design.spectra import Spectra

ONE = Spectra((1.0, 1.0), (1.0, 1.0), 1.0)
WIDE = Spectra((0.1, 1.06), (0.55, 5.5), 0.18)
NARROW = Spectra((0.67, 1.01), (0.83, 1.25), 0.8)


def radius(G, pi, xi, timing):
    A = matrices(G, np.array([pi]), np.array([xi]), timing)[0, :4, :4]
    return float(np.abs(np.linalg.eigvals(A)).max())


def played(G, pi, xi, T, D, ticks, L_i=0.0, corner=None, b=0.0):
    """The mode tick by tick, with the acceleration of each part of a period integrated exactly."""
    e, de, u, sigma, last, filtered = 0.01, 0.0, 0.0, 0.0, 0.01, 0.0
    K_d, K_p, lam = 1.5 * G, 0.5 * G * G, 0.5 * G
    a = None if corner is None else 1.0 - math.exp(-2.0 * math.pi * corner * T)
    seen = []
    for _ in range(ticks):
        rate = de
        if a is not None:
            filtered += a * ((e - last) / T - filtered)
            last, rate = e, filtered
        e_hat = e + D * T * rate - 0.5 * (D * T) ** 2 * xi * u
        rate_hat = rate - D * T * xi * u
        sigma += T * L_i * (rate_hat + lam * e_hat)
        y = K_d * rate_hat + K_p * e_hat + sigma
        for part, acting in ((D * T, u), ((1.0 - D) * T, y)):
            acceleration = pi * (b - acting)
            e, de = e + part * de + 0.5 * part**2 * acceleration, de + part * acceleration
        u = y
        seen.append(e)
    return np.array(seen)


@pytest.mark.parametrize("rate", [250.0, 1000.0, 4000.0])
@pytest.mark.parametrize("pi_2", [0.9, 1.0, 1.6])
def test_without_delay_the_loop_is_stable_at_nearly_twice_the_gain_and_not_above(rate, pi_2):
    timing = LoopTiming(1.0 / rate, 0.0)
    G = stable_gain(Spectra((0.5, pi_2), (0.5, pi_2), 0.5), timing)
    assert pytest.approx(1.328 / MARGIN * rate / max(pi_2, 1.0)) == G
    heaviest = max(pi_2, 1.0)
    assert radius(0.95 * MARGIN * G, heaviest, 1.0, timing) < 1.0
    assert radius(1.05 * MARGIN * G, heaviest, 1.0, timing) > 1.0
    decayed = played(0.95 * MARGIN * G, heaviest, 1.0, 1.0 / rate, 0.0, 400)
    grown = played(1.05 * MARGIN * G, heaviest, 1.0, 1.0 / rate, 0.0, 400)
    assert np.abs(decayed[-50:]).max() < 1e-3 * 0.01
    assert np.abs(grown[-50:]).max() > 0.01


@pytest.mark.parametrize("spectra", [ONE, WIDE, NARROW])
@pytest.mark.parametrize(
    ("delay", "corner"), [(1.0, None), (0.4, None), (0.0, 100.0), (1.0, 100.0)]
)
def test_twice_the_gain_is_the_border_for_the_worst_mode(spectra, delay, corner):
    timing = LoopTiming(1e-3, delay, corner)
    G = stable_gain(spectra, timing)
    least, most = spectra.light
    modes = [
        (xi * c, xi)
        for xi in np.geomspace(spectra.least_share, 1.0, 25)
        for c in np.geomspace(spectra.centre[0], spectra.centre[1], 25)
        if least <= xi * c <= most
    ]
    assert modes
    assert max(radius(0.95 * MARGIN * G, pi, xi, timing) for pi, xi in modes) < 1.0
    assert max(radius(1.08 * MARGIN * G, pi, xi, timing) for pi, xi in modes) > 1.0


@pytest.mark.parametrize(("delay", "corner"), [(0.0, None), (0.3, None), (1.0, None), (1.0, 80.0)])
def test_the_matrices_are_the_loop_tick_by_tick(delay, corner):
    G, T, L_i, pi, xi = 120.0, 1e-3, 700.0, 0.7, 0.6
    A = matrices(G, np.array([pi]), np.array([xi]), LoopTiming(T, delay, corner), L_i)[0]
    x = np.array([0.01, 0.0, 0.0, 0.0, 0.0])
    if corner is not None:  # v of a filter at rest on this error
        x[3] = -(1.0 - math.exp(-2.0 * math.pi * corner * T)) * 0.01 / T
    expected = played(G, pi, xi, T, delay, 300, L_i, corner)
    for k in range(300):
        x = A @ x
        assert x[0] == pytest.approx(expected[k], rel=1e-9, abs=1e-12)


def test_the_delays_gain_follows_the_one_without_delay_continuously():
    gains = [stable_gain(NARROW, LoopTiming(1e-3, d)) for d in (0.0, 1e-6, 0.1, 0.5, 1.0)]
    assert gains[1] == pytest.approx(gains[0], rel=0.01)
    assert min(gains) == gains[-1]


@pytest.mark.parametrize("spectra", [ONE, WIDE, NARROW])
@pytest.mark.parametrize("delay", [0.0, 0.5, 1.0])
def test_gain_times_period_is_the_same_at_every_rate(spectra, delay):
    gains = [stable_gain(spectra, LoopTiming(1.0 / rate, delay)) / rate for rate in (250.0, 4000.0)]
    assert gains[0] == pytest.approx(gains[1], rel=1e-12)


def test_a_slow_filter_costs_gain():
    measured, quick, slow = (
        stable_gain(NARROW, LoopTiming(1e-3, 1.0, corner)) for corner in (None, 200.0, 50.0)
    )
    assert slow < quick < measured


def test_a_steady_push_moves_a_loop_without_integral_by_two_over_the_square_of_the_gain():
    pi = np.array([0.4])
    G = 80.0
    assert compliance(G, 0.0, pi, pi, LoopTiming(1e-3, 0.0), 1e-6) == pytest.approx(
        2.0 / G**2, rel=1e-3
    )
    settled = played(G, 0.4, 0.4, 1e-3, 0.0, 3000, b=5.0)[-1]
    assert settled == pytest.approx(5.0 * 2.0 / G**2, rel=1e-6)


def test_a_sine_moves_the_loop_as_far_as_its_response_says():
    G, L_i, T, omega = 60.0, 180.0, 1e-3, 6.0
    pi, xi = np.array([0.7]), np.array([0.9])
    timing = LoopTiming(T, 1.0)
    A = matrices(G, pi, xi, timing, L_i)[0]
    x, seen = np.zeros(5), []
    for k in range(8000):
        push = math.sin(omega * k * T) * 0.7
        x = A @ x + np.array([0.5 * T * T * push, T * push, 0.0, 0.0, 0.0])
        seen.append(x[0])
    assert compliance(G, L_i, pi, xi, timing, omega) == pytest.approx(max(seen[-2000:]), rel=1e-3)


def test_the_integral_takes_a_slow_push_away():
    pi = np.array([1.0])
    timing = LoopTiming(1e-3, 0.0)
    without, with_it = (compliance(100.0, L_i, pi, pi, timing, 0.1) for L_i in (0.0, 500.0))
    assert with_it < 0.05 * without
