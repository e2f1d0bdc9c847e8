"""Small frozen parts of a `Robot`: settings of controller and motion, mimic joints, module tree."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from modrobust.checks.types import Array, Ints
from modrobust.model.parameters import freeze, remade


@dataclass(frozen=True)
class ControllerSettings:
    """Gains of the control law; see docs/theory/equations.md, (3) to (8) and (29) to (34).

    Args:
        K_r: Diagonal of K_r, positive, n of them [1/s].
        law: ``"norm"``, the paper's (7); ``"componentwise"``; ``"sampled"``, for a held command;
            ``"auto"``, ``"sampled"`` with gains that are chosen for the loop.
        bound: ``"hull"`` or ``"ianea"``.
        kappa_P, kappa_I: Gains of kappa, not negative [s/rad], [1/rad^2].
        phi_P, phi_I: Gains of phi, not negative [N m s/rad], [N m/rad^2].
        epsilon: Norm of the tracking error within which the integral rests, positive [rad] or [m].
        kappa_max, phi_max: Ceilings of kappa and phi, positive [s/rad], [N m s/rad].
        leak: How fast the integral of kappa and phi decays [1/s].
        hold_aware: Whether ``norm`` and ``componentwise`` allow for the hold.
        G, Lambda, L_i: Gains of ``sampled`` [1/s], [1/s], [1/s^2]; None for the other laws.
        blend: Time in which ``sampled`` leads from the state at the start to the motion [s].
        integral, predictor, vector_saturation: Parts of ``sampled`` that can be left out.

    What takes them, such as `RobustController`, checks them.
    """

    K_r: tuple[float, ...]
    law: str = "norm"
    bound: str = "hull"
    kappa_P: float = 2.0
    kappa_I: float = 100.0
    phi_P: float = 1.0
    phi_I: float = 200.0
    epsilon: float = 0.01
    kappa_max: float = math.inf
    phi_max: float = math.inf
    leak: float = 0.0
    hold_aware: bool = False
    G: float | None = None
    Lambda: float | None = None
    L_i: float | None = None
    blend: float = 0.4
    integral: bool = True
    predictor: bool = True
    vector_saturation: bool = True


def default_gains(G: float) -> tuple[float, float]:
    """Lambda and L_i of ``sampled`` where G alone is given, [1/s] and [1/s^2]; (35) has both."""
    return G / 2.0, 0.05 * G * G


SENSOR_SIZES = (
    *("noise_position", "noise_velocity"),
    *("quantisation_position", "quantisation_velocity"),
)
"""Fields of `LoopSettings` that have one size a joint, or none."""
NOISES, VELOCITIES = ("uniform", "worst"), ("measured", "differentiated")
DISTURBANCES = ("constant", "sine", "random", "worst")


@dataclass(frozen=True)
class LoopSettings:
    """The loop as the drive runs it; see docs/theory/equations.md, (28).

    Args:
        rate: Commands a second [Hz]; each is held until the next takes its place.
        delay: How late a command acts, in periods, 0 to 1 [1].
        noise_position, noise_velocity: Largest error of the measured q and dq, n of each [rad],
            [rad/s] or [m], [m/s]; empty where there is none.
        noise: ``"uniform"`` in that box, or ``"worst"``: always at the end that hides the error.
        quantisation_position, quantisation_velocity: Steps of the measured q and dq, n of each
            [rad], [rad/s] or [m], [m/s]; empty where there are none.
        velocity: ``"measured"``, or ``"differentiated"`` from the measured q.
        filter: Corner of the first-order filter of a differentiated velocity [Hz].
        saturation: Whether the drive cuts torques at the effort limits.
        disturbance: ``"constant"``, ``"sine"``, ``"random"`` at every tick, or ``"worst"``, the end
            of [d] that pushes away from the motion.
        frequency: Of a sine [Hz].

    What takes them, such as `simulate`, checks them.

    Source: our own; (28) of docs/theory/equations.md.
    """

    rate: float = 1000.0
    delay: float = 0.0
    noise_position: tuple[float, ...] = ()
    noise_velocity: tuple[float, ...] = ()
    noise: str = "uniform"
    quantisation_position: tuple[float, ...] = ()
    quantisation_velocity: tuple[float, ...] = ()
    velocity: str = "measured"
    filter: float = 100.0
    saturation: bool = False
    disturbance: str = "constant"
    frequency: float = 1.0

    @property
    def noisy(self) -> bool:
        """Whether the measurement has errors: no torque is without any fast part then."""
        sizes = (getattr(self, name) for name in SENSOR_SIZES)
        return self.velocity == "differentiated" or any(any(size) for size in sizes)

    def to_dict(self) -> dict[str, Any]:
        """Plain Python, ready for JSON."""
        return {k: list(v) if isinstance(v, tuple) else v for k, v in asdict(self).items()}


@dataclass(frozen=True)
class TrajectorySettings:
    """The description's own trajectory: `kind` and its numbers, resolved per joint.

    kind "sines": q_des = amplitude * prod_k sin(omega_k t); amplitude (n,), omega (k,) [rad/s].
    kind "quintic": rest-to-rest through points (k, n) at times (k,) [s], or drawn ones.
    kind "csv": file, splined.
    """

    kind: str
    duration: float | None = None
    amplitude: tuple[float, ...] = ()
    omega: tuple[float, ...] = ()
    times: tuple[float, ...] = ()
    points: tuple[tuple[float, ...], ...] = ()
    file: str | None = None


@dataclass(frozen=True)
class ModuleNode:
    """One mounted module, for showing how the robot was put together."""

    instance: str
    module: str
    name: str
    joints: tuple[str, ...]
    bodies: tuple[str, ...]
    children: tuple[ModuleNode, ...] = ()


@dataclass(frozen=True, eq=False)
class MimicJoints:
    """Joints that follow a free one: q = multiplier * q_leader + offset.

    Equation (15) of docs/theory/equations.md. They have their place in every array of joint data:
    `joints`, the indices there, ascending; left empty, they stand after the n free joints. A vector
    of positions, velocities or torques holds the free joints only; `leaders` are indices into such
    a vector.
    """

    names: tuple[str, ...] = ()
    leaders: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    multiplier: Array = field(default_factory=lambda: np.zeros(0))
    offset: Array = field(default_factory=lambda: np.zeros(0))  # [rad] or [m]
    joints: Ints = field(default_factory=lambda: np.zeros(0, np.int32))

    __reduce__ = remade

    def __post_init__(self) -> None:
        freeze(self)
