"""Boxes of parameters of every breadth, and the robot of written geometry with such a box."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from modrobust.model import Bounded, ControllerSettings, MimicJoints, Parameters, Robot
from support.containment.written_robots import Written, amount, exact_pose, nearest, nearest_matrix

KINDS = ("exact", "ulp", "tiny", "per cent", "wide", "mixed")
SHARES = (0.15, 0.05, 0.15, 0.35, 0.15, 0.15)


def sides(rng: np.random.Generator, nominal: Any, size: float, kind: str) -> tuple[Any, Any]:
    """Bounds around nominal values; `size` is what 100 % means for an entry that may be 0."""
    scale = np.maximum(np.abs(nominal), size)
    width = {
        "exact": 0.0,
        "ulp": 0.0,
        "tiny": 1e-12,
        "per cent": 10.0 ** rng.uniform(-2, -0.3),
        "wide": 10.0 ** rng.uniform(-0.3, 1.5),
        "mixed": 10.0 ** rng.uniform(-6, 0),
    }[kind]
    down, up = (rng.uniform(0.1, 1.0, nominal.shape) * width * scale for _ in range(2))
    if rng.random() < 0.3:
        down = up
    if kind == "mixed":  # some entries exact, some bounded on one side only
        down, up = (np.where(rng.random(nominal.shape) < 0.5, 0.0, x) for x in (down, up))
    lo, hi = nominal - down, nominal + up
    if kind == "ulp" and size > 0.0:
        lo, hi = np.nextafter(nominal, -np.inf), np.nextafter(nominal, np.inf)
    return lo, hi


def magnitude(rng: np.random.Generator, usual: float, widest: float) -> float:
    """Mostly near the usual size, sometimes far away."""
    decades = 0.5 if rng.random() < 0.85 else widest
    return float(usual * 10.0 ** rng.uniform(-decades, decades))


def tensor(rng: np.random.Generator, size: float) -> Any:
    """A symmetric inertia (3, 3), mostly one that a body can have."""
    if rng.random() < 0.2:
        half = rng.normal(size=(3, 3)) * size
        return half + half.T
    points = rng.normal(size=(5, 3)) * np.sqrt(size) * rng.uniform(0.1, 1.0, 3)
    second = points.T @ points
    return np.trace(second) * np.eye(3) - second


def symmetric(matrices: Any) -> Any:
    upper = np.triu(matrices)
    return upper + np.triu(matrices, 1).swapaxes(-1, -2)


def box(
    rng: np.random.Generator, b: int, j: int, sparse: bool
) -> tuple[Parameters, Parameters, Parameters]:
    """Nominal, lower and upper point for b bodies and j joints; sparse: most entries are 0."""
    shared = str(rng.choice(KINDS, p=SHARES)) if rng.random() < 0.6 else None
    points: list[dict[str, list[Any]]] = [{"mass": [], "com": [], "inertia": []} for _ in range(3)]
    for _ in range(b):
        kind = shared or str(rng.choice(KINDS, p=SHARES))
        mass = np.array(magnitude(rng, 2.0, 9.0))
        reach = magnitude(rng, 0.1, 4.0)
        com = rng.uniform(-reach, reach, 3) * (rng.random(3) < 0.8)
        I_size = magnitude(rng, 0.01, 6.0)
        inertia = symmetric(tensor(rng, I_size))
        if sparse:
            reach, I_size = reach * (rng.random() < 0.4), I_size * (rng.random() < 0.4)
            com, inertia = com * (reach > 0.0), inertia * (I_size > 0.0)
        mass_lo, mass_hi = sides(rng, mass, float(mass), kind)
        if kind == "wide" and rng.random() < 0.3:  # a payload that may be absent
            mass_lo = np.array(0.0)
        c_lo, c_hi = sides(rng, com, reach, kind)
        I_lo, I_hi = (symmetric(side) for side in sides(rng, inertia, I_size, kind))
        for name, triple in (
            ("mass", (mass, np.maximum(mass_lo, 0.0), mass_hi)),
            ("com", (com, c_lo, c_hi)),
            ("inertia", (inertia, I_lo, I_hi)),
        ):
            for point, value in zip(points, triple, strict=True):
                point[name].append(value)
    arrays = [{k: np.array(v) for k, v in lists.items()} for lists in points]
    for name, usual in (("rotor_inertia", 1e-5), ("viscous", 10.0), ("coulomb", 5.0)):
        kind = str(rng.choice(KINDS, p=SHARES))
        nominal = np.array([magnitude(rng, usual, 6.0) for _ in range(j)])
        nominal = nominal * (rng.random(j) < (0.2 if sparse else 0.8))
        lo, hi = sides(rng, nominal, 0.0 if sparse else usual, kind)
        for packed, value in zip(arrays, (nominal, np.maximum(lo, 0.0), hi), strict=True):
            packed[name] = value
    nominal_point, lower, upper = (Parameters(**packed) for packed in arrays)
    return nominal_point, lower, upper


def disturbance(rng: np.random.Generator, n: int) -> Bounded:
    if rng.random() < 0.3:
        return Bounded(np.zeros(n), np.zeros(n), np.zeros(n))
    size = magnitude(rng, 1.0, 9.0)
    ends = np.sort(rng.uniform(-size, size, (3, n)), axis=0)
    return Bounded(ends[1], ends[0], ends[2])


def make_robot(rng: np.random.Generator, written: Written, sparse: bool = False) -> Robot:
    """The robot of the nearest doubles, with a random box."""
    n, j = written.n, len(written.parents)
    b = len(written.body_joints)
    nominal, lower, upper = box(rng, b, j, sparse)
    return Robot(
        name="written",
        gravity=np.array([float(x) for x in written.gravity]),
        base=nearest_matrix(exact_pose(written.base)),
        joint_names=tuple(f"joint{i}" for i in range(n)),
        joint_types=tuple("prismatic" if p else "revolute" for p in written.prismatic),
        parents=np.array(written.parents, dtype=np.int32),
        before=np.array([nearest_matrix(exact_pose(m)) for m in written.before]),
        after=np.array([nearest_matrix(exact_pose(m)) for m in written.after]),
        position_limits=np.tile([-np.inf, np.inf], (n, 1)),
        velocity_limits=np.full(n, np.inf),
        effort_limits=np.full(n, np.inf),
        gear_ratio=np.array([float(x) for x in written.gear_ratio]),
        coulomb_speed=np.array([float(x) for x in written.coulomb_speed]),
        body_names=tuple(f"body{k}" for k in range(b)),
        body_joints=np.array(written.body_joints, dtype=np.int32),
        placement=np.array([nearest_matrix(exact_pose(m)) for m in written.placement]),
        nominal=nominal,
        lower=lower,
        upper=upper,
        disturbance=disturbance(rng, n),
        controller=ControllerSettings(K_r=tuple(float(k) for k in 10.0 ** rng.uniform(-1, 2, n))),
        mimic=MimicJoints(
            names=tuple(f"mimic{k}" for k in range(j - n)),
            leaders=np.array(written.leaders, dtype=np.int32),
            multiplier=np.array([float(x) for x in written.multiplier]),
            offset=np.array([nearest(amount(move)) for move in written.offset]),
            joints=np.array(written.moves[n:], dtype=np.int32),
        ),
        inertia_about=tuple("frame" if x < 0.3 else "com" for x in rng.random(b)),
    )


def endless(rng: np.random.Generator, robot: Robot) -> Robot:
    """The robot, one in three with most of its turning joints continuous."""
    if rng.random() > 0.35:
        return robot
    types = (
        "continuous" if kind == "revolute" and rng.random() < 0.7 else kind
        for kind in robot.joint_types
    )
    return replace(robot, joint_types=tuple(types))


def skewed(rng: np.random.Generator, robot: Robot) -> Robot:
    """The robot with rotations off orthonormal by up to what `Robot` accepts, 1e-9."""
    changed = {}
    for name in ("before", "after", "placement", "base"):
        T = getattr(robot, name).copy()
        T[..., :3, :3] += rng.uniform(-1, 1, T[..., :3, :3].shape) * 2e-10
        changed[name] = T
    return replace(robot, **changed)
