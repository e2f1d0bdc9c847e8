r"""Gains of the law ``sampled`` for a robot's box and the loop it runs in, and why they are so.

Source: our own; (30) and (35) to (39) of docs/theory/equations.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from reprlib import repr as short
from typing import Any

import numpy as np

from modrobust.checks import as_number
from modrobust.design.choice import GainChoice, choose, integral_gain, measured_noise, timing
from modrobust.design.need import Need
from modrobust.design.points import central_parameters
from modrobust.design.remedies import Help, remedies
from modrobust.design.scalar import LAMBDA, LoopTiming, compliance
from modrobust.design.spectra import Spectra
from modrobust.design.states import MotionStates, states_along, states_of_any_motion
from modrobust.dynamics import mass_matrix
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.kernel import own_environment
from modrobust.model import (
    SENSOR_SIZES,
    ControllerSettings,
    LoopSettings,
    Parameters,
    Robot,
    check_robot,
)
from modrobust.motion import Trajectory, make_trajectory
from modrobust.motion.trajectory import (
    QUINTIC_PEAK_ACCELERATION,
    QUINTIC_PEAK_RATE,
)

BLEND, LONGEST_BLEND = 0.4, 1.0  # [s]
WIDE = 20.0  # pi_2 / pi_1 beyond which a light and a heavy robot ask for different gains
_DIGITS = 3  # of a gain: below them a processor's rounding would show
_FAST = 50.0  # parts of a period: a loop so fast counts as continuous


@dataclass(frozen=True)
class Design:
    """What was chosen, and what bounds it. Gains are those of (35), ranges those of (36).

    Everything here is an estimate and no theorem: ranges and accelerations are the largest found.
    """

    settings: ControllerSettings
    """Law ``sampled`` with its gains, ready for `RobustController`."""
    loop: LoopSettings
    """The loop that they are for."""
    motion: str
    """The motion that they are for, in words."""
    central: Parameters
    """D_c of (30)."""
    light: Parameters
    """D_s of (30)."""
    spectra: Spectra
    """Ranges of eigenvalues, (36)."""
    need: Need
    """Accelerations that the unknown can give, (38)."""
    G_stab: float
    """Largest gain that the loop's rate and delay allow, (37) [1/s]."""
    G_noise: float
    """Largest gain that noise and effort limits allow, (39); infinite without limits [1/s]."""
    G_eps: float
    """Gain that epsilon asks for, sqrt(4 b / epsilon) [1/s]."""
    binding: str
    """What G stops at: "stability", "noise", "epsilon", or "floor", 20/s."""
    reachable: bool
    """Whether epsilon can be met: G_eps is at most G_stab and G_noise."""
    epsilon_reached: float
    """The least epsilon for which it could be, 4 b / min(G_stab, G_noise)^2 [rad] or [m]."""
    expected: Mapping[str, float]
    """Error by cause, norms over joints [rad] or [m]; see `expected_error`."""
    remarks: tuple[str, ...]
    """What a user should know of it, in sentences."""
    robot: Robot = field(repr=False)
    """The robot that it is for."""
    states: MotionStates = field(repr=False)
    """Where the robot was looked at."""
    choice: GainChoice = field(repr=False)
    """The rule's own numbers, before they were rounded."""

    @property
    def G(self) -> float:
        """Gain of the feedback, K_d = 3/2 G and K_p = G^2/2 [1/s]."""
        return float(self.settings.G or 0.0)

    @property
    def error(self) -> float:
        """Sum of the expected errors [rad] or [m]."""
        return sum(self.expected.values())

    @cached_property
    def helps(self) -> tuple[Help, ...]:
        """What would help, the best first; nothing where epsilon is met.

        Each is the rule once more on a changed input; see `modrobust.design.remedies`.
        """
        if self.reachable:
            return ()
        return remedies(self.robot, self.loop, self.states, self.settings.epsilon, self.choice)

    def to_dict(self, helps: bool = False) -> dict[str, Any]:
        """Plain Python, ready for JSON; an infinite number is null.

        Args:
            helps: Whether `helps` are worked out too, which takes seconds.
        """
        s = self.settings
        found: dict[str, Any] = {
            "robot": self.robot.name,
            "motion": self.motion,
            "loop": self.loop.to_dict(),
            "gains": {
                "law": s.law,
                "G": s.G,
                "Lambda": s.Lambda,
                "L_i": s.L_i,
                "blend": s.blend,
                "epsilon": s.epsilon,
            },
            "bounds": {
                "G_stab": self.G_stab,
                "G_noise": self.G_noise if math.isfinite(self.G_noise) else None,
                "G_eps": self.G_eps,
                "binding": self.binding,
            },
            "reachable": self.reachable,
            "epsilon_reached": self.epsilon_reached,
            "spectra": {
                "pi": list(self.spectra.light),
                "c": list(self.spectra.centre),
                "xi": self.spectra.least_share,
            },
            "need": asdict(self.need),
            "expected": dict(self.expected),
            "error": self.error,
            "remarks": list(self.remarks),
        }
        return found | {"helps": [item.to_dict() for item in self.helps]} if helps else found


@own_environment()
def design(
    robot: Robot,
    loop: LoopSettings | None = None,
    *,
    epsilon: float | None = None,
    motion: Trajectory | None = None,
) -> Design:
    r"""Gains of the law ``sampled`` that are the least that meet epsilon, as far as the loop lets.

    .. math:: G = \min\left(G_{stab},\; G_{noise},\; \max(G_{eps},\; 20/\mathrm{s})\right), \quad
              \Lambda = G/2, \quad L_i = G^2 \min(0.05,\; \pi_1)

    Deterministic: seeds are its own, and gains are rounded to three digits, so that they are the
    same on every machine but for a rare tie.

    Args:
        robot: Robot with ``n`` joints; its bounds are what the gains must be good for.
        loop: As the drive runs it; None = the robot's own.
        epsilon: Norm of the tracking error to stay within [rad] or [m]; None = that of the
            robot's controller settings.
        motion: What the robot is to follow; None = any motion within its joint and velocity
            limits, which costs more gain.

    Returns:
        The gains, with what bounds them; `Design.reachable` says whether epsilon can be met.

    Raises:
        ShapeError: Noise of the loop, or the motion, is not that of ``n`` joints.
        ValueRangeError: ``robot`` or ``loop`` is none, or a number is out of its range.
        SingularMassMatrixError: The mass matrix at the centre of the box is not positive definite.

    Source: our own; (30) and (35) to (39) of docs/theory/equations.md.
    """
    check_robot(robot)
    loop = robot.loop if loop is None else loop
    check_loop(robot, loop)
    wanted = as_number("epsilon", robot.controller.epsilon if epsilon is None else epsilon)
    if not (math.isfinite(wanted) and wanted > 0.0):
        raise ValueRangeError(
            f"epsilon: {wanted:g}; must be positive and finite: it is the radius that the tracking "
            "error is to stay in; such as 0.01"
        )
    states = _states(robot, motion)
    found = choose(robot, loop, states, wanted)
    G = _rounded(found.gain)
    settings = ControllerSettings(
        K_r=(LAMBDA * G,) * robot.n,
        law="sampled",
        bound="hull",
        epsilon=wanted,
        G=G,
        Lambda=LAMBDA * G,
        L_i=_rounded(integral_gain(G, found.spectra)),
        blend=blend_time(robot, found.central, motion),
    )
    return Design(
        settings=settings,
        loop=loop,
        motion=states.of,
        central=found.central,
        light=found.light,
        spectra=found.spectra,
        need=found.need,
        G_stab=found.stability,
        G_noise=found.noise,
        G_eps=found.accuracy,
        binding=found.binding,
        reachable=found.reachable,
        epsilon_reached=found.reached,
        expected=expected_error(settings, loop, found, states),
        remarks=_remarks(robot, loop, found, wanted),
        robot=robot,
        states=states,
        choice=found,
    )


def expected_error(
    settings: ControllerSettings, loop: LoopSettings, found: GainChoice, states: MotionStates
) -> Mapping[str, float]:
    r"""Estimate of the error by cause, norms over joints [rad] or [m].

    .. math::
       \text{parameters} &= |H_0(\omega)|\,b_\Delta, \quad
       \text{hold} = (|H_T(\omega)| - |H_0(\omega)|)\,b_\Delta, \quad
       \text{delay} = (|H_{T,D}(\omega)| - |H_T(\omega)|)\,b_\Delta \\
       \text{friction} &= 2 b_f / G^2, \qquad \text{disturbance} = 2 b_d / G^2 \\
       \text{noise} &= 3 \lVert \sigma \rVert \sqrt{T / (\tfrac32 G^3)}, \quad
       \sigma_i = (\tfrac32 G n_{v,i} + \tfrac12 G^2 n_{q,i}) / \sqrt3

    H is the response of (37) with the integral, at the pace of the motion, for the worst of three
    modes; the index 0 stands for a loop without hold and delay. Friction turns round too suddenly
    for the integral, and the disturbance may: they count in full. Noise of the worst sign moves the
    robot by n_q + 3 n_v / G. The largest accelerations found stand for all, without the 2 of (38).

    Args:
        settings: Law ``sampled`` with its gains.
        loop: As the drive runs it.
        found: What the rule found.
        states: Of the motion.

    Source: our own.
    """
    G, L_i = float(settings.G or 0.0), float(settings.L_i or 0.0)
    real, push = timing(loop), found.need
    least, most = found.spectra.light
    pi = np.array([least, min(max(1.0, least), most), most])
    xi = np.minimum(
        1.0, [max(found.spectra.least_share, least / found.spectra.centre[1]), 1.0, 1.0]
    )
    fast = min(real.period, 1.0 / (G * _FAST))
    response = [
        compliance(G, L_i, pi, xi, when, states.pace)
        for when in (
            LoopTiming(fast, 0.0),
            LoopTiming(real.period, 0.0, real.corner),
            LoopTiming(real.period, real.delay, real.corner),
        )
    ]
    q, v = measured_noise(loop, len(settings.K_r))
    if loop.noise == "worst":
        noise = float(np.linalg.norm(q + (1.0 + LAMBDA) / LAMBDA * v / G))
    else:
        spread = ((1.0 + LAMBDA) * G * v + LAMBDA * G * G * q) / math.sqrt(3.0)
        damping = 2.0 * LAMBDA * (1.0 + LAMBDA) * G**3
        noise = 3.0 * float(np.linalg.norm(spread)) * math.sqrt(real.period / damping)
    still = 1.0 / (LAMBDA * G * G)
    return {
        "parameters": response[0] * push.parameters,
        "friction": still * push.friction,
        "disturbance": still * push.disturbance,
        "noise": noise,
        "hold": max(response[1] - response[0], 0.0) * push.parameters,
        "delay": max(response[2] - response[1], 0.0) * push.parameters,
    }


def blend_time(robot: Robot, central: Parameters, motion: Trajectory | None) -> float:
    r"""Time in which the reference is led from the start to the motion [s].

    .. math:: t = \max\left(0.4\,\mathrm{s},\; \max_i \frac{1.875\,|o_i|}{\dot q_{max,i}/2},\;
              \max_i \sqrt{\frac{5.77\,|M_c o|_i}{\overline\tau_i / 2}}\right)
              \le 1\,\mathrm{s}

    so that a quintic over the offset o takes half of a speed limit and half of an effort limit at
    most. The offset is that of the description's own start from its motion; 0 where it has none.

    Args:
        robot: Robot with ``n`` joints.
        central: D_c of (30).
        motion: Desired motion, or None.

    Source: our own; peaks of the quintic as in `modrobust.motion.Quintic`.
    """
    if robot.initial_q is None or motion is None:
        return BLEND
    start = motion.sample([0.0])[0][0]
    offset = np.abs(robot.tracking_error(robot.initial_q, start))
    torque = np.abs(mass_matrix(robot, start, central)) @ offset
    slow = QUINTIC_PEAK_RATE * offset / (0.5 * robot.velocity_limits)
    weak = np.sqrt(QUINTIC_PEAK_ACCELERATION * torque / (0.5 * robot.effort_limits))
    return float(min(max(BLEND, slow.max(), weak.max()), LONGEST_BLEND))


def check_loop(robot: Robot, loop: LoopSettings) -> None:
    """Refuse a loop that no drive runs.

    Raises:
        ShapeError: Noise or steps are not one a joint.
        ValueRangeError: It is no `LoopSettings`, or a number is out of its range.
    """
    if not isinstance(loop, LoopSettings):
        raise ValueRangeError(f"loop: {short(loop)}; must be LoopSettings, such as robot.loop")
    for name, unit in (("rate", "Hz"), ("filter", "Hz")):
        value = as_number(name, getattr(loop, name), unit)
        if not (math.isfinite(value) and value > 0.0):
            raise ValueRangeError(f"{name}: {value:g} {unit}; must be positive and finite")
    delay = as_number("delay", loop.delay)
    if not 0.0 <= delay <= 1.0:
        raise ValueRangeError(f"delay: {delay:g} periods; must be from 0 to 1")
    for name, known in (
        ("velocity", ("measured", "differentiated")),
        ("noise", ("uniform", "worst")),
    ):
        if getattr(loop, name) not in known:
            raise ValueRangeError(
                f"{name}: {short(getattr(loop, name))} is not known; known: {', '.join(known)}"
            )
    for name in SENSOR_SIZES:
        values = getattr(loop, name)
        if len(values) not in (0, robot.n):
            raise ShapeError(
                f"{name}: expected {robot.n} numbers or none, got {len(values)}; robot "
                f'"{robot.name}" has {robot.n} joints'
            )
        for value in values:
            if not 0.0 <= as_number(name, value) < math.inf:
                raise ValueRangeError(f"{name}: {value:g}; must be finite and not negative")


def _states(robot: Robot, motion: Trajectory | None) -> MotionStates:
    if motion is None:
        return states_of_any_motion(robot, central_parameters(robot))
    return states_along(make_trajectory(robot, motion))


def _remarks(
    robot: Robot, loop: LoopSettings, found: GainChoice, epsilon: float
) -> tuple[str, ...]:
    said = []
    unit = "rad" if robot.free_turns.all() else "m" if not robot.free_turns.any() else ""
    if not unit:
        said.append("epsilon and errors are norms over joints in rad and joints in m together")
    if not found.reachable:
        what = "noise" if found.noise < found.stability else f"a loop at {loop.rate:g} Hz"
        if found.noise >= found.stability and loop.delay > 0.0:
            what += f", {loop.delay:g} period{'s' * (loop.delay != 1.0)} late,"
        said.append(
            f"epsilon {epsilon:g}{unit and ' '}{unit} is not reachable at this rate: it asks for "
            f"G = {found.accuracy:.3g}/s, {what} allows {found.limit:.3g}/s; epsilon "
            f"{found.reached:.2g}{unit and ' '}{unit} is"
        )
    if found.spectra.spread > WIDE:
        said.append(
            f"the heaviest robot of the box is {found.spectra.spread:.3g} times as heavy as the "
            "lightest in some direction: one gain is slow for the one or fast for the other; "
            "drive: figures, or a payload box that begins above 0 kg, bring them together"
        )
    return tuple(said)


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
