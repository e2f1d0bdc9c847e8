"""The robot as frozen arrays: what every computation takes.

Frames: joint i moves link i; T_i = before_i J_i(q_i) after_i takes coordinates in link frame i
to those of its parent's link frame (or of the base frame, parent -1). Interface:
docs/reference/formats.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from modrobust import _kernel
from modrobust.arguments import as_integer
from modrobust.dh import DHTable, dh_table
from modrobust.errors import ValueRangeError
from modrobust.kernel import own_environment
from modrobust.parameters import Bounded, Parameters, freeze, remade
from modrobust.robot_checks import check_box, check_lengths, check_rigid, check_tree
from modrobust.robot_parts import ControllerSettings, Followers, ModuleNode, TrajectorySettings
from modrobust.sampling import corner_point, physical_pull, sample_point

__all__ = [
    "Bounded",
    "ControllerSettings",
    "Followers",
    "ModuleNode",
    "Parameters",
    "Robot",
    "TrajectorySettings",
    "check_robot",
]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot with n free joints, j joints in all and b bodies, checked when made; immutable."""

    name: str
    gravity: Array  # (3,) [m/s^2], world axes
    base: Array  # (4, 4), world to base frame
    joint_names: tuple[str, ...]
    joint_types: tuple[str, ...]  # (j) "revolute" or "prismatic"
    parents: NDArray[np.int32]  # (j,), -1 = base; parents[i] < i
    before: Array  # (j, 4, 4)
    after: Array  # (j, 4, 4)
    position_limits: Array  # (n, 2) [rad] or [m], infinite where not given
    velocity_limits: Array  # (n,) [rad/s] or [m/s], infinite where not given
    effort_limits: Array  # (n,) [N m] or [N], infinite where not given
    gear_ratio: Array  # (j,), 0 where there is no drive
    coulomb_speed: Array  # (j,) [rad/s] or [m/s]
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
    notes: tuple[
        str, ...
    ] = ()  # assumptions and remarks for the user, e.g. a payload as a point mass
    scenarios: Mapping[str, Parameters] = field(default_factory=dict)
    trajectory: TrajectorySettings | None = None
    initial_q: Array | None = None  # (n,), None = start on the trajectory
    initial_dq: Array | None = None
    modules: tuple[ModuleNode, ...] = ()
    followers: Followers = field(default_factory=Followers)
    version: int = 1
    # (n,) [rad/s^2] or [m/s^2], infinite where not given; left out by to_dict
    acceleration_limits: Array = field(default_factory=lambda: np.zeros(0))
    scenario_notes: Mapping[str, str] = field(default_factory=dict)

    __reduce__ = remade

    def __repr__(self) -> str:
        return f'<Robot "{self.name}": {self.n} joints, {self.b} bodies>'

    @own_environment()
    def __post_init__(self) -> None:
        if not self.acceleration_limits.size:
            object.__setattr__(self, "acceleration_limits", np.full(self.n, np.inf))
        freeze(self)
        for name in ("scenarios", "scenario_notes"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        self._check()

    def _check(self) -> None:
        n, j, b = self.n, self.j, self.b
        f, d = self.followers, self.disturbance
        owner = f'robot "{self.name}" has {n} free joints, {j} joints and {b} bodies'
        check_lengths(
            {
                "gravity": (self.gravity, (3,)),
                "base": (self.base, (4, 4)),
                "parents": (self.parents, (j,)),
                "before": (self.before, (j, 4, 4)),
                "after": (self.after, (j, 4, 4)),
                "position_limits": (self.position_limits, (n, 2)),
                "velocity_limits": (self.velocity_limits, (n,)),
                "effort_limits": (self.effort_limits, (n,)),
                "acceleration_limits": (self.acceleration_limits, (n,)),
                "gear_ratio": (self.gear_ratio, (j,)),
                "coulomb_speed": (self.coulomb_speed, (j,)),
                "body_joints": (self.body_joints, (b,)),
                "placement": (self.placement, (b, 4, 4)),
                "followers.leaders": (f.leaders, (j - n,)),
                "followers.multiplier": (f.multiplier, (j - n,)),
                "followers.offset": (f.offset, (j - n,)),
                "nominal.mass": (self.nominal.mass, (b,)),
                "nominal.viscous": (self.nominal.viscous, (j,)),
                "disturbance": (d.nominal, (n,)),
            },
            owner,
        )
        check_tree(self.joint_types, self.parents, self.body_joints, f.leaders, n)
        for name in ("base", "before", "after", "placement"):
            check_rigid(name, getattr(self, name))
        for name in ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb"):
            ends = (getattr(point, name) for point in (self.lower, self.nominal, self.upper))
            check_box(name, *ends, signed=name in ("com", "inertia"))
        check_box("disturbance", d.lo, d.nominal, d.hi, signed=True)

    @property
    def n(self) -> int:
        """Number of joints that move freely."""
        return len(self.joint_names)

    @property
    def j(self) -> int:
        """Number of joints, those that follow another included."""
        return len(self.joint_types)

    @property
    def b(self) -> int:
        """Number of bodies, base-fixed ones and the payload included."""
        return len(self.body_names)

    @property
    def all_joint_names(self) -> tuple[str, ...]:
        """Names of the j joints, the free ones first."""
        return self.joint_names + self.followers.names

    @own_environment()
    def all_positions(self, q: Array) -> Array:
        """Positions of the j joints (..., j) for those of the free ones (..., n), (15)."""
        f = self.followers
        return np.concatenate([q, f.multiplier * q[..., f.leaders] + f.offset], axis=-1)

    @cached_property
    @own_environment()
    def model(self) -> _kernel.Model:
        """The kernel's view of the geometry, made once.

        The kernel works in the base frame, so gravity is turned there: base' g, summed in order,
        so that it has the same bits on every machine.
        """
        x, y, z = (row * g for row, g in zip(self.base[:3, :3], self.gravity, strict=True))
        return _kernel.Model(
            np.array([kind == "prismatic" for kind in self.joint_types], dtype=np.int32),
            self.parents,
            self.before,
            self.after,
            x + y + z,
            self.body_joints,
            self.placement,
            self.gear_ratio,
            self.coulomb_speed,
            self.followers.leaders,
            self.followers.multiplier,
            self.followers.offset,
        )

    @cached_property
    @own_environment()
    def dh(self) -> DHTable | None:
        """Standard D-H table in the base frame, for display; None when joints branch."""
        if self.j != self.n or not np.array_equal(self.parents, np.arange(-1, self.n - 1)):
            return None
        return dh_table(self.parents, self.before, self.after)

    @own_environment()
    def sample_parameters(self, rng: np.random.Generator | int) -> Parameters:
        """A physical point of the box, uniform in each entry; tensors by rejection per body.

        Every tensor is positive definite and keeps the triangle inequality (as far as the nominal
        one does). Where 1,365 draws in a row are not physical, the last one is pulled straight
        towards nominal until it is. Exact entries stay exact.

        Args:
            rng: A numpy Generator, or an int that seeds one.
        """
        return sample_point(self.nominal, self.lower, self.upper, _generator(rng))

    @own_environment()
    def corner_parameters(self, rng: np.random.Generator | int) -> Parameters:
        """A vertex of the box, each entry lower or upper by a coin; perhaps not a physical one.

        Args:
            rng: A numpy Generator, or an int that seeds one.
        """
        return corner_point(self.lower, self.upper, _generator(rng))

    @own_environment()
    def physical_corner(
        self, which: str, rng: np.random.Generator | int = 0
    ) -> tuple[Parameters, tuple[str, ...]]:
        """A vertex of the box that a real robot could have, as nearly as the box allows.

        Tensors that no body can have are pulled straight towards nominal until one can.

        Args:
            which: "lower", "upper", or "corner" for the one that `corner_parameters` draws.
            rng: A numpy Generator, or an int that seeds one; used by "corner".

        Returns:
            The point, and the names of the bodies whose tensor was pulled, for reporting.

        Raises:
            ValueRangeError: `which` is something else.
        """
        if which not in ("lower", "upper", "corner"):
            raise ValueRangeError(f'which: "{which}" is none of lower, upper, corner')
        ends = {"lower": self.lower, "upper": self.upper}
        vertex = ends[which] if which in ends else self.corner_parameters(rng)
        point, pulled = physical_pull(self.nominal, vertex)
        return point, tuple(self.body_names[k] for k in pulled)

    def to_dict(self) -> dict[str, Any]:
        """The resolved robot as plain Python, ready for JSON; numbers round-trip exactly.

        Keys and conventions: docs/reference/formats.md, "The resolved robot".
        """
        joints = [self._joint_dict(i) for i in range(self.j)]
        bodies = [
            {
                "name": name,
                "joint": int(self.body_joints[k]),
                "placement": self.placement[k].tolist(),
                "mass": self._bounded("mass", k),
                "com": self._bounded("com", k),
                "inertia": self._bounded("inertia", k),
            }
            for k, name in enumerate(self.body_names)
        ]
        d = self.disturbance
        return {
            "robot": self.name,
            "version": self.version,
            "gravity": self.gravity.tolist(),
            "base": self.base.tolist(),
            "joints": joints,
            "bodies": bodies,
            "disturbance": [_q(d.nominal[i], d.lo[i], d.hi[i]) for i in range(self.n)],
            "dh": None if self.dh is None else _dh_dict(self.dh),
            "exact": list(self.exact),
            "not_modelled": list(self.not_modelled),
        }

    def _joint_dict(self, i: int) -> dict[str, Any]:
        free = i < self.n
        position = self.position_limits[i] if free else np.full(2, np.inf)
        follower = {} if free else {"mimic": self._mimic_dict(i - self.n)}
        return {
            "name": self.all_joint_names[i],
            "type": self.joint_types[i],
            "parent": int(self.parents[i]),
            "before": self.before[i].tolist(),
            "after": self.after[i].tolist(),
            "limits": {
                "position": position.tolist() if np.isfinite(position).all() else None,
                "velocity": _finite(self.velocity_limits[i]) if free else None,
                "effort": _finite(self.effort_limits[i]) if free else None,
            },
            **follower,
            "drive": {
                "gear_ratio": float(self.gear_ratio[i]),
                "rotor_inertia": self._bounded("rotor_inertia", i),
            },
            "friction": {
                "viscous": self._bounded("viscous", i),
                "coulomb": self._bounded("coulomb", i),
                "coulomb_speed": float(self.coulomb_speed[i]),
            },
        }

    def _mimic_dict(self, k: int) -> dict[str, Any]:
        return {
            "joint": int(self.followers.leaders[k]),
            "multiplier": float(self.followers.multiplier[k]),
            "offset": float(self.followers.offset[k]),
        }

    def _bounded(self, name: str, index: int) -> dict[str, Any]:
        points = (self.nominal, self.lower, self.upper)
        return _q(*(getattr(point, name)[index] for point in points))


def check_robot(robot: object) -> None:
    """Refuse what is no robot, such as the name of one, before an attribute of it is missed.

    Raises:
        ValueRangeError: It is no `Robot`.
    """
    if not isinstance(robot, Robot):
        found = type(robot).__name__
        raise ValueRangeError(f"robot: expected a Robot, got {found}; load_robot(...) makes one")


def _generator(rng: np.random.Generator | int) -> np.random.Generator:
    """The generator itself, or one that the number seeds."""
    if isinstance(rng, np.random.Generator):
        return rng
    return np.random.default_rng(as_integer("rng", rng, 0))


def _q(nominal: Any, lo: Any, hi: Any) -> dict[str, Any]:
    return {"nominal": nominal.tolist(), "lo": lo.tolist(), "hi": hi.tolist()}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _dh_dict(table: DHTable) -> dict[str, Any]:
    rows = [
        {
            "a": row.a,
            "alpha": row.alpha,
            "d": row.d,
            "theta": row.theta,
            "near_parallel": row.near_parallel,
        }
        for row in table.rows
    ]
    return {"base": table.base.tolist(), "tool": table.tool.tolist(), "rows": rows}
