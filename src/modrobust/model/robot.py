"""The robot as frozen arrays: what every computation takes.

Frames: joint i moves link i; T_i = before_i J_i(q_i) after_i takes coordinates in link frame i
to those of its parent's link frame (or of the base frame, parent -1). Interface:
docs/reference/formats.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.checks import as_integer, shape_error
from modrobust.checks.types import Array, Flags, Ints
from modrobust.errors import ShapeError, ValueRangeError, visible
from modrobust.kernel import own_environment
from modrobust.model.checks import (
    check_abouts,
    check_box,
    check_endless,
    check_lengths,
    check_payloads,
    check_rigid,
    check_tree,
)
from modrobust.model.definite import is_definite, pulled_to_definite, seeded_poses
from modrobust.model.dh import DHTable, dh_table
from modrobust.model.parameters import Bounded, Parameters, freeze, remade
from modrobust.model.parts import (
    ControllerSettings,
    LoopSettings,
    MimicJoints,
    ModuleNode,
    TrajectorySettings,
)
from modrobust.model.physical import ABOUT_COM, ABOUT_FRAME, excess, inertia_about_com
from modrobust.model.sampling import corner_point, physical_pull, sample_point

__all__ = [
    "Bounded",
    "ControllerSettings",
    "LoopSettings",
    "MimicJoints",
    "ModuleNode",
    "Parameters",
    "Robot",
    "TrajectorySettings",
    "check_robot",
]


_REDRAWS = 64


@dataclass(frozen=True, eq=False)
class Robot:
    r"""A robot with n free joints, j joints in all and b bodies, checked when made; immutable.

    .. math:: T_i = \mathrm{before}_i\, J_i(q_i)\, \mathrm{after}_i

    takes coordinates in link frame i to those of its parent's, (14).

    Raises:
        ShapeError: An array does not fit the number of joints or bodies.
        ValueRangeError: A number is not finite, a transform not rigid, bounds do not enclose the
            nominal value, or parents do not make a tree.

    Source: (14) to (16); [GA17] for a serial arm.
    """

    name: str
    gravity: Array
    """In world axes, ``(3,)`` [m/s^2]."""
    base: Array
    """World to base frame, ``(4, 4)`` [m]."""
    joint_names: tuple[str, ...]
    """Of the n joints that move freely."""
    joint_types: tuple[str, ...]
    """Of the j joints: "revolute", "continuous" or "prismatic"; see `free_types`."""
    parents: Ints
    """Index of the parent of each joint, ``(j,)``; -1 = base; parents[i] < i."""
    before: Array
    """B of (14), ``(j, 4, 4)`` [m]."""
    after: Array
    """E of (14), ``(j, 4, 4)`` [m]."""
    position_limits: Array
    """``(n, 2)`` [rad] or [m], infinite where not given."""
    velocity_limits: Array
    """``(n,)`` [rad/s] or [m/s], infinite where not given."""
    effort_limits: Array
    """``(n,)`` [N m] or [N], infinite where not given."""
    gear_ratio: Array
    """Motor over joint, ``(j,)`` [1] or [rad/m]; 0 where there is no drive."""
    coulomb_speed: Array
    """Speed at which Coulomb friction is full, (20), ``(j,)`` [rad/s] or [m/s]."""
    body_names: tuple[str, ...]
    body_joints: Ints
    """Joint that each body moves with, ``(b,)``; -1 = fixed to the base."""
    placement: Array
    """Body frame in the link frame, ``(b, 4, 4)`` [m]."""
    nominal: Parameters
    lower: Parameters
    upper: Parameters
    disturbance: Bounded
    """[d] of (9), ``(n,)`` [N m] or [N]."""
    controller: ControllerSettings
    exact: tuple[str, ...] = ()
    not_modelled: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    """Assumptions and remarks for the user, e.g. a payload as a point mass."""
    scenarios: Mapping[str, Parameters] = field(default_factory=dict)
    trajectory: TrajectorySettings | None = None
    initial_q: Array | None = None
    """``(n,)`` [rad] or [m]; None = start on the trajectory."""
    initial_dq: Array | None = None
    """``(n,)`` [rad/s] or [m/s]; None = start on the trajectory."""
    modules: tuple[ModuleNode, ...] = ()
    mimic: MimicJoints = field(default_factory=MimicJoints)
    version: int = 1
    acceleration_limits: Array = field(default_factory=lambda: np.zeros(0))
    """``(n,)`` [rad/s^2] or [m/s^2], infinite where not given."""
    scenario_notes: Mapping[str, str] = field(default_factory=dict)
    inertia_about: tuple[str, ...] = ()
    """Of the b tensors: "com" or "frame"; none given = the COM for all."""
    loop: LoopSettings = field(default_factory=LoopSettings)
    """The loop that the robot is run in where nothing else is said."""
    payloads: Mapping[str, tuple[Parameters, Parameters, Parameters]] = field(default_factory=dict)
    """Nominal, lower and upper figures with each payload by name, inside the robot's own box."""

    __reduce__ = remade

    def __repr__(self) -> str:
        return f'<Robot "{visible(self.name)}": {self.n} joints, {self.b} bodies>'

    @own_environment()
    def __post_init__(self) -> None:
        if not self.acceleration_limits.size:
            object.__setattr__(self, "acceleration_limits", np.full(self.n, np.inf))
        if not self.inertia_about:
            object.__setattr__(self, "inertia_about", (ABOUT_COM,) * self.b)
        if not self.mimic.joints.size:
            behind = np.arange(self.n, self.j, dtype=np.int32)
            object.__setattr__(self, "mimic", replace(self.mimic, joints=behind))
        freeze(self)
        for name in ("scenarios", "scenario_notes", "payloads"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        self._check()

    def _check(self) -> None:
        n, j, b = self.n, self.j, self.b
        f, d = self.mimic, self.disturbance
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
                "mimic.joints": (f.joints, (j - n,)),
                "mimic.leaders": (f.leaders, (j - n,)),
                "mimic.multiplier": (f.multiplier, (j - n,)),
                "mimic.offset": (f.offset, (j - n,)),
                "nominal.mass": (self.nominal.mass, (b,)),
                "nominal.viscous": (self.nominal.viscous, (j,)),
                "disturbance": (d.nominal, (n,)),
            },
            owner,
        )
        check_abouts(self.inertia_about, b, owner)
        check_tree(self.joint_types, self.parents, self.body_joints, f, n)
        check_endless(self.joint_names, self.free_types, self.position_limits)
        for name in ("base", "before", "after", "placement"):
            check_rigid(name, getattr(self, name))
        for name in ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb"):
            ends = (getattr(point, name) for point in (self.lower, self.nominal, self.upper))
            check_box(name, *ends, signed=name in ("com", "inertia"))
        check_box("disturbance", d.lo, d.nominal, d.hi, signed=True)
        check_payloads(self.payloads, self.lower, self.upper)

    @property
    def n(self) -> int:
        """Number of joints that move freely."""
        return len(self.joint_names)

    @property
    def j(self) -> int:
        """Number of joints, mimic joints included."""
        return len(self.joint_types)

    @property
    def b(self) -> int:
        """Number of bodies, base-fixed ones and the payload included."""
        return len(self.body_names)

    @cached_property
    def framed(self) -> Flags:
        """Whether the tensor of each body is about its frame's origin, not its COM, (b,)."""
        flags = np.array([about == ABOUT_FRAME for about in self.inertia_about], dtype=np.bool_)
        flags.setflags(write=False)
        return flags

    @property
    def uncertain(self) -> bool:
        """Whether any parameter or the disturbance has a width.

        Else there is nothing to be robust against.
        """
        d = self.disturbance
        return bool((self.lower.packed < self.upper.packed).any() or (d.lo < d.hi).any())

    @property
    def all_joint_names(self) -> tuple[str, ...]:
        """Names of the j joints, in the order of the arrays of joint data."""
        names = dict(zip(self.moves.tolist(), self.joint_names + self.mimic.names, strict=True))
        return tuple(names[i] for i in range(self.j))

    @cached_property
    def moves(self) -> Ints:
        """Index of the joint that entry i of a vector (n,) moves; then of mimic joints."""
        free = np.setdiff1d(np.arange(self.j, dtype=np.int32), self.mimic.joints)
        return np.concatenate([free, self.mimic.joints])

    @property
    def free(self) -> Ints:
        """Indices (n,) of the joints that move freely, ascending."""
        return self.moves[: self.n]

    @property
    def free_types(self) -> tuple[str, ...]:
        """Types of the n free joints."""
        return tuple(self.joint_types[i] for i in self.free)

    @cached_property
    def turns(self) -> Flags:
        """Whether each joint (j,) turns, with limits or without; it slides otherwise."""
        return np.array([kind != "prismatic" for kind in self.joint_types], dtype=bool)

    @property
    def free_turns(self) -> Flags:
        """Whether each free joint (n,) turns."""
        return np.asarray(self.turns[self.free])

    @cached_property
    def wraps(self) -> Flags:
        """Whether the error (4) of each free joint (n,) is taken less whole turns.

        So it is of a continuous joint, unless a mimic joint of it is prismatic or turns by another
        amount than whole turns when this one makes one: then a turn leads to another pose.
        """
        wraps = np.array([kind == "continuous" for kind in self.free_types], dtype=bool)
        f = self.mimic
        for k, leader in enumerate(f.leaders):
            whole = float(f.multiplier[k]).is_integer()
            wraps[leader] &= bool(self.turns[f.joints[k]]) and whole
        return wraps

    @own_environment()
    def tracking_error(self, q: Array, q_des: Array) -> Array:
        """The error of (4), ``(n,)`` or ``(k, n)`` [rad] or [m]: what the controller acts on.

        q_des - q; of a joint that wraps less the whole turns that leave at most half a one, where
        both angles are ones that the controller takes.

        Args:
            q: Positions, ``(n,)`` or ``(k, n)`` [rad] or [m]; they may be infinite.
            q_des: Desired positions, of the same shape, ``(n,)`` or ``(k, n)`` [rad] or [m].

        Returns:
            q_des - q less whole turns, ``(n,)`` or ``(k, n)`` [rad] or [m].

        Raises:
            ShapeError: The arrays differ in shape, or do not have ``n`` columns.

        Source: (4) of [GA17]; whole turns are ours.
        """
        for name, x in (("q", q), ("q_des", q_des)):
            if np.shape(x) != np.shape(q) or np.shape(x)[-1:] != (self.n,):
                raise shape_error(name, (*np.shape(q)[:-1], self.n), np.shape(x), owner_of(self))
        error = np.asarray(q_des - q, dtype=np.float64)
        if not self.wraps.any():
            return error
        rows = np.ascontiguousarray(np.atleast_2d(q)), np.ascontiguousarray(np.atleast_2d(q_des))
        near = np.ones(len(rows[0]), dtype=bool)
        for x in rows:
            near &= np.isfinite(x).all(axis=1)
            near &= (np.abs(x[:, self.wraps]) <= _kernel.ANGLE_MAX).all(axis=1)
        reduced = np.atleast_2d(error)
        reduced[near] = _kernel.tracking_error(self.model, *(x[near] for x in rows))
        return reduced.reshape(error.shape)

    @own_environment()
    def all_positions(self, q: Array) -> Array:
        """Positions of the j joints for those of the n free ones, (15).

        Args:
            q: Positions of the free joints, ``(..., n)`` [rad] or [m].

        Returns:
            Positions of all joints, ``(..., j)`` [rad] or [m].

        Raises:
            ShapeError: ``q`` does not have ``n`` columns.

        Source: (15).
        """
        if np.shape(q)[-1:] != (self.n,):
            raise shape_error("q", f"(..., {self.n})", np.shape(q), owner_of(self))
        f = self.mimic
        everything = np.empty((*np.shape(q)[:-1], self.j))
        everything[..., self.free] = q
        everything[..., f.joints] = f.multiplier * q[..., f.leaders] + f.offset
        return everything

    @cached_property
    @own_environment()
    def model(self) -> _kernel.Model:
        """The kernel's view of the geometry, made once.

        The kernel works in the base frame, so gravity is rotated there: base' g, summed in order,
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
            self.framed.astype(np.int32),
            self.gear_ratio,
            self.coulomb_speed,
            self.moves,
            self.mimic.leaders,
            self.mimic.multiplier,
            self.mimic.offset,
            self.wraps.astype(np.int32),
        )

    @cached_property
    @own_environment()
    def unphysical(self) -> Mapping[str, float]:
        """Moving bodies whose nominal figures no rigid body has, and by how much.

        That is how far the largest principal moment is above the sum of the other two, relative to
        that sum [1]; infinite for a moment about one axis alone, and for a tensor without mass.
        """
        p = self.nominal
        beyond = excess(p.mass, inertia_about_com(p.mass, p.com, p.inertia, self.framed))
        moving = np.flatnonzero((beyond > 0.0) & (self.body_joints >= 0))
        return MappingProxyType({self.body_names[k]: float(beyond[k]) for k in moving})

    @cached_property
    @own_environment()
    def dh(self) -> DHTable | None:
        """Standard D-H table in the base frame, for display; None when joints branch."""
        if self.j != self.n or not np.array_equal(self.parents, np.arange(-1, self.n - 1)):
            return None
        return dh_table(self.parents, self.before, self.after)

    @own_environment()
    def sample_parameters(self, rng: np.random.Generator | int) -> Parameters:
        r"""A physical point of the box, uniform in each entry; tensors by rejection per body.

        .. math:: \Delta = \underline\Delta + u\,(\overline\Delta - \underline\Delta),
                  \quad u \text{ uniform in } [0, 1]

        Every tensor is, about the COM, positive definite and keeps the triangle inequality (as far
        as the nominal one does). Where 1,365 draws in a row are not physical, the last one is
        pulled straight towards nominal until it is. With a tensor about the body's frame, mass and
        COM are drawn anew and pulled along with it. Exact entries stay exact. Where a nominal body
        is not physical itself, points are drawn until M(q) > 0 at 16 seeded poses, an estimate for
        all poses; the last of 64 is pulled towards nominal until it is so.

        Args:
            rng: A numpy Generator, or an int that seeds one.

        Raises:
            ValueRangeError: ``rng`` is neither, or negative.

        Source: rejection sampling of our own; the box is that of [GA17].
        """
        generator = _generator(rng)
        point = sample_point(self.nominal, self.lower, self.upper, self.framed, generator)
        if not self.unphysical:
            return point
        poses = seeded_poses(self.position_limits)
        for _ in range(_REDRAWS):
            if is_definite(self.model, point, poses):
                return point
            point = sample_point(self.nominal, self.lower, self.upper, self.framed, generator)
        return pulled_to_definite(self.model, self.nominal, point, poses)

    @own_environment()
    def corner_parameters(self, rng: np.random.Generator | int) -> Parameters:
        r"""A vertex: each entry lower or upper with equal probability; may be unphysical.

        .. math:: \Delta_k \in \{\underline\Delta_k, \overline\Delta_k\}

        Args:
            rng: A numpy Generator, or an int that seeds one.

        Raises:
            ValueRangeError: ``rng`` is neither, or negative.

        Source: our own; the box is that of [GA17].
        """
        return corner_point(self.lower, self.upper, _generator(rng))

    @own_environment()
    def physical_corner(
        self, which: str, rng: np.random.Generator | int = 0
    ) -> tuple[Parameters, tuple[str, ...]]:
        r"""A vertex of the box that a real robot could have, as nearly as the box allows.

        .. math:: \Delta_0 + s\,(\Delta - \Delta_0), \quad s \in [0, 1]
                  \text{ the largest that is physical, body by body}

        Tensors that no body can have are pulled straight towards nominal until one can; mass and
        COM with them where the tensor is about the body's frame. Where a nominal body is not
        physical itself, the whole point is then pulled, if need be, until M(q) > 0 at 16 seeded
        poses.

        Args:
            which: "lower", "upper", or "corner" for the one that `corner_parameters` draws.
            rng: A numpy Generator, or an int that seeds one; used by "corner".

        Returns:
            The point, and the names of the bodies whose tensor was pulled, for reporting.

        Raises:
            ValueRangeError: `which` is something else.

        Source: our own; physical is what (16) says of one body.
        """
        if which not in ("lower", "upper", "corner"):
            raise ValueRangeError(f'which: "{which}" is none of lower, upper, corner')
        ends = {"lower": self.lower, "upper": self.upper}
        vertex = ends[which] if which in ends else self.corner_parameters(rng)
        point, pulled = physical_pull(self.nominal, vertex, self.framed)
        if self.unphysical:
            poses = seeded_poses(self.position_limits)
            inside = pulled_to_definite(self.model, self.nominal, point, poses)
            if inside is not point:
                return inside, self.body_names
        return point, tuple(self.body_names[k] for k in pulled)

    @own_environment()
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
                "inertia_about": self.inertia_about[k],
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
            "unphysical": [
                {"body": name, "excess": _finite(beyond)}
                for name, beyond in self.unphysical.items()
            ],
        }

    def _joint_dict(self, i: int) -> dict[str, Any]:
        entry = int(np.flatnonzero(self.moves == i)[0])  # of the free ones, then the mimic joints
        free = entry < self.n
        position = self.position_limits[entry] if free else np.full(2, np.inf)
        mimic_joint = {} if free else {"mimic": self._mimic_dict(entry - self.n)}
        return {
            "name": self.all_joint_names[i],
            "type": self.joint_types[i],
            "parent": int(self.parents[i]),
            "before": self.before[i].tolist(),
            "after": self.after[i].tolist(),
            "limits": {
                "position": position.tolist() if np.isfinite(position).all() else None,
                "velocity": _finite(self.velocity_limits[entry]) if free else None,
                "effort": _finite(self.effort_limits[entry]) if free else None,
                "acceleration": _finite(self.acceleration_limits[entry]) if free else None,
            },
            **mimic_joint,
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
            "joint": int(self.free[self.mimic.leaders[k]]),
            "multiplier": float(self.mimic.multiplier[k]),
            "offset": float(self.mimic.offset[k]),
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


def check_parameters(robot: Robot, parameters: Parameters) -> None:
    """Refuse parameters that were made for another robot.

    Raises:
        ShapeError: They have other numbers of bodies or joints.
    """
    bodies, joints = len(parameters.mass), len(parameters.viscous)
    if (bodies, joints) != (robot.b, robot.j):
        raise ShapeError(
            f"parameters: of {bodies} bodies and {joints} joints; robot "
            f'"{robot.name}" has {robot.b} and {robot.j}'
        )


def owner_of(robot: Robot) -> str:
    """Where the shape ``(n,)`` comes from, for messages: ``robot "arm6" has 6 joints``."""
    return f'robot "{robot.name}" has {robot.n} joints'


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
