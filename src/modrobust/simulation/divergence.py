r"""Why a loop diverged: the joint whose inertia is too small for a gain that is held.

Between two ticks the command stands still for T. A robust torque v = k r brakes a joint of inertia
J by the share k T / J of its velocity in one hold: from 2 on it leaves the joint faster than it
was, in the other direction. With all joints coupled

.. math:: T\,\lambda_{\max}(M^{-1} K) < 2

for the gain K: :math:`k\,1` with :math:`k = \kappa\|\rho\| + \varphi` of the law ``norm``,
:math:`\mathrm{diag}(\kappa\rho_i + \varphi)` of ``componentwise``, and
:math:`(G + \Lambda)\,M_s` of ``sampled``. This explains runs that diverged; it proves nothing of
those that did not.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.control.rate import fastest_mode, hertz
from modrobust.design.points import central_parameters, light_parameters
from modrobust.model import ControllerSettings, Parameters, Robot

_HELD = 2.0  # share from which a held gain drives a joint
_LIKELY = 1.0  # between two logged ticks it may have grown from here to 2
_QUIET = 0.5  # share at which a held gain brakes without overshoot, with some room
_ROWS = 1000  # looked at, at most, besides the last
_LAST = 100


@dataclass(frozen=True)
class Divergence:
    """Where a diverged loop broke, and what would help.

    joint: Name of the joint that the gain drives most; None where no tick was logged.
    kind: Its type, "revolute" or "prismatic"; None where there is no joint.
    t: When the gain was too large for the hold, for the first time seen [s].
    gain: Entry of K of that joint at that time [N m s/rad] or [N s/m].
    inertia: What it acts on: gain times hold over `share` [kg m^2] or [kg].
    hold: T [s].
    share: T lambda_max(M^-1 K), true parameters; 2 is the limit of what is stable.
    rate: Rate that would brake without overshoot at that gain [Hz].
    law: The law that the gain is of.

    All but `joint`, `kind`, `hold` and `law` are None where the gain does not explain the
    divergence.
    """

    joint: str | None
    kind: str | None
    hold: float
    t: float | None = None
    gain: float | None = None
    inertia: float | None = None
    share: float | None = None
    rate: float | None = None
    law: str = "norm"

    @property
    def cause(self) -> str:
        """What broke, in words that follow "the loop diverged at ... s: "."""
        if self.joint is None:
            return "in its first steps"
        if self.gain is None or self.inertia is None or self.share is None:
            return f'joint "{self.joint}" moved fastest; the gain does not explain it'
        turns = self.kind == "revolute"
        gain, inertia = ("N m s/rad", "kg m^2") if turns else ("N s/m", "kg")
        return (
            f'joint "{self.joint}": the gain of law "{self.law}", {self.gain:.3g} {gain}, held for '
            f"{self.hold * 1e3:.3g} ms, is {self.share:.3g} times the inertia of "
            f"{self.inertia:.3g} {inertia} that it acts on; a held gain is stable below "
            f"{_HELD:g} times"
        )

    @property
    def remedy(self) -> str:
        """What helps best."""
        if self.law != "sampled":
            return 'the law "auto", which chooses gains for this rate and this box'
        if self.rate is not None:
            return f'the law "auto" instead of a G of one\'s own, or a rate of {hertz(self.rate)}'
        return "a start nearer to the motion, or a slower one"

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {**asdict(self), "cause": self.cause, "remedy": self.remedy}


def find_divergence(
    robot: Robot,
    parameters: Parameters,
    controller: ControllerSettings,
    hold: float,
    t: Array,
    q: Array,
    dq: Array,
    error: Array,
    rho: Array,
) -> Divergence:
    """The first logged tick at which the gain was too large for the hold, and its joint.

    Args:
        robot: Robot with n joints.
        parameters: True parameters of the plant.
        controller: The gains of the run.
        hold: T, time between two commands [s].
        t: Logged instants ``(m,)`` [s].
        q: Positions, ``(m, n)`` [rad] or [m].
        dq: Velocities, ``(m, n)`` [rad/s] or [m/s].
        error: Norm of the tracking error, ``(m,)``.
        rho: Worst cases (8), ``(m, n)``.
    """
    if not len(t):
        return Divergence(None, None, hold)
    gains = _gains(controller, t, error, rho)
    light = None
    if controller.law == "sampled":
        light = light_parameters(robot, central_parameters(robot))
    worst: tuple[float, int, int, float] | None = None  # share, row, joint, gain
    for k in _rows(len(t)):
        found = _share(robot, parameters, light, controller, q[k], gains[k])
        if found is None:
            continue
        share, joint, gain = found
        if worst is None or share * hold > worst[0]:
            worst = share * hold, k, joint, gain
        if share * hold >= _HELD:
            break
    law = controller.law
    if worst is None or worst[0] < _LIKELY or controller.hold_aware:
        joint = int(np.argmax(np.nan_to_num(np.abs(dq[-1]), nan=np.inf)))
        return Divergence(robot.joint_names[joint], robot.free_types[joint], hold, law=law)
    share, k, joint, gain = worst
    return Divergence(
        joint=robot.joint_names[joint],
        kind=robot.free_types[joint],
        hold=hold,
        t=float(t[k]),
        gain=gain,
        inertia=gain * hold / share,
        share=share,
        rate=_rounded_up(share / (_QUIET * hold)),
        law=law,
    )


def _gains(c: ControllerSettings, t: Array, error: Array, rho: Array) -> Array:
    """Entries of the diagonal K at the logged ticks ``(m, n)``, the integral summed over them."""
    with np.errstate(over="ignore", invalid="ignore"):
        grown = np.where(error < c.epsilon, 0.0, error)[:-1] * np.diff(t)
        integral = np.concatenate([[0.0], np.cumsum(grown)])[:, None]
        kappa = np.minimum(c.kappa_P + c.kappa_I * integral, c.kappa_max)
        phi = np.minimum(c.phi_P + c.phi_I * integral, c.phi_max)
        size = rho if c.law == "componentwise" else np.linalg.norm(rho, axis=1)[:, None]
        result: Array = np.broadcast_to(kappa * size + phi, rho.shape)
    return result


def _rows(count: int) -> list[int]:
    """Indices looked at: evenly spaced ones, and all of the end, where it goes fast."""
    spread = np.linspace(0, count - 1, min(count, _ROWS)).astype(int)
    return sorted({*spread.tolist(), *range(max(0, count - _LAST), count)})


def _share(
    robot: Robot,
    parameters: Parameters,
    light: Parameters | None,
    controller: ControllerSettings,
    q: Array,
    gain: Array,
) -> tuple[float, int, float] | None:
    """lambda_max(M^-1 K), the joint that it is found on and its gain; None where there is none."""
    try:
        M = _kernel.mass_matrix(robot.model, parameters.packed, q, True)
        if light is None:
            K = np.diag(gain)
        else:
            feedback = float(controller.G or 0.0) + float(controller.Lambda or 0.0)
            K = feedback * _kernel.mass_matrix(robot.model, light.packed, q, True)
    except _kernel.KernelError:
        return None
    if not (np.isfinite(K).all() and np.linalg.eigvalsh(M)[0] > 0.0):
        return None
    value, joint = fastest_mode(M, K)
    return value, joint, float(K[joint, joint])


def _rounded_up(rate: float) -> float:
    """The rate with one or two digits, never less."""
    step = 10.0 ** (math.floor(math.log10(rate)) - 1) * 5.0
    return math.ceil(rate / step) * step


__all__ = ["Divergence", "find_divergence"]
