"""The robot as frozen arrays: what every computation takes.

Frames: joint i moves link i; T_i = before_i J_i(q_i) after_i takes coordinates in link frame i
to those of its parent's link frame (or of the base frame, parent -1). interface: docs/formats.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Bounded:
    """A nominal value with hard closed bounds, arrays of one shape."""

    nominal: Array
    lo: Array
    hi: Array


@dataclass(frozen=True, eq=False)
class Parameters:
    """One point of the dynamic parameters, in the order of the robot's bodies and joints.

    mass (b,) [kg]; com (b, 3) [m] in body axes; inertia (b, 3, 3) [kg m^2] about the COM in body
    axes, tensor entries; rotor_inertia (n,) [kg m^2] motor side; viscous (n,) [N m s/rad] or
    [N s/m]; coulomb (n,) [N m] or [N], joint side.
    """

    mass: Array
    com: Array
    inertia: Array
    rotor_inertia: Array
    viscous: Array
    coulomb: Array

    @cached_property
    def packed(self) -> Array:
        """All parameters in the kernel's order, one contiguous vector (10 b + 3 n,)."""
        i = self.inertia
        six = np.stack([i[:, 0, 0], i[:, 0, 1], i[:, 0, 2], i[:, 1, 1], i[:, 1, 2], i[:, 2, 2]], 1)
        parts = (self.mass, self.com, six, self.rotor_inertia, self.viscous, self.coulomb)
        return np.concatenate([np.ravel(part) for part in parts])


@dataclass(frozen=True)
class ControllerSettings:
    """Gains of the robust control law; see docs/equations.md, (3) to (8).

    K_r (n,) [1/s] positive; the others non-negative; epsilon [rad] or [m] positive.
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
    kind "quintic": rest-to-rest through points (k, n) at times (k,) [s].
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
class Robot:
    """A robot with n joints and b bodies, resolved and checked; immutable."""

    name: str
    gravity: Array  # (3,) [m/s^2], world axes
    base: Array  # (4, 4), world to base frame
    joint_names: tuple[str, ...]
    joint_types: tuple[str, ...]  # "revolute" or "prismatic"
    parents: NDArray[np.int32]  # (n,), -1 = base; parents[i] < i
    before: Array  # (n, 4, 4)
    after: Array  # (n, 4, 4)
    position_limits: Array  # (n, 2) [rad] or [m], infinite where not given
    velocity_limits: Array  # (n,) [rad/s] or [m/s], infinite where not given
    effort_limits: Array  # (n,) [N m] or [N], infinite where not given
    gear_ratio: Array  # (n,), 0 where there is no drive
    coulomb_speed: Array  # (n,) [rad/s] or [m/s]
    body_names: tuple[str, ...]
    body_joints: NDArray[np.int32]  # (b,), -1 = fixed to the base
    placement: Array  # (b, 4, 4), body frame in the link frame
    nominal: Parameters
    lower: Parameters
    upper: Parameters
    disturbance: Bounded  # (n,) [N m] or [N]
    controller: ControllerSettings
    exact: tuple[str, ...] = ()
    not_modelled: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()  # assumptions and remarks for the user, e.g. a payload as a point mass
    scenarios: Mapping[str, Parameters] = field(default_factory=dict)
    trajectory: TrajectorySettings | None = None
    initial_q: Array | None = None  # (n,), None = start on the trajectory
    initial_dq: Array | None = None
    modules: tuple[ModuleNode, ...] = ()
    version: int = 1

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joint_names)
