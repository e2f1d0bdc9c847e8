"""Small frozen parts of a `Robot`: settings of controller and motion, mimic joints, module tree."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from modrobust.checks.types import Array, Ints
from modrobust.model.parameters import freeze, remade


@dataclass(frozen=True)
class ControllerSettings:
    """Gains of the robust control law; see docs/theory/equations.md, (3) to (8).

    Args:
        K_r: Diagonal of K_r, positive, n of them [1/s].
        law: ``"norm"``, the paper's (7).
        bound: ``"hull"`` or ``"ianea"``.
        kappa_P, kappa_I: Gains of kappa, not negative [s/rad], [1/rad^2].
        phi_P, phi_I: Gains of phi, not negative [N m s/rad], [N m/rad^2].
        epsilon: Norm of the tracking error within which the integral rests, positive [rad] or [m].

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
