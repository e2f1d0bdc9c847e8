"""Random robots, built straight from arrays, for tests of the dynamics.

Revolute and prismatic joints mixed, serial or branched, several bodies a link with any placement,
bodies fixed to the base, physical inertias, and bounds that are exact, narrow, wide, or a mix.
Every third tensor is about the frame of its body, not the COM.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
from scipy.spatial.transform import Rotation

from modrobust.model import Bounded, ControllerSettings, MimicJoints, Parameters, Robot

Width = Literal["exact", "narrow", "wide", "mixed"]


def pose(rng: np.random.Generator, reach: float = 0.3) -> Any:
    """A random rigid transform, (4, 4)."""
    T = np.eye(4)
    T[:3, :3] = Rotation.random(rng=rng).as_matrix()
    T[:3, 3] = rng.uniform(-reach, reach, 3)
    return T


def dh(rng: np.random.Generator, prismatic: bool) -> Any:
    """The constant part of a random standard D-H row: Rz(theta) Tz(d) Tx(a) Rx(alpha)."""
    a, d, alpha = rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.3), rng.uniform(-np.pi, np.pi)
    theta = rng.uniform(-np.pi, np.pi)
    T, turn, twist = np.eye(4), np.eye(4), np.eye(4)
    turn[:3, :3] = Rotation.from_rotvec([0, 0, theta]).as_matrix()
    twist[:3, :3] = Rotation.from_rotvec([alpha, 0, 0]).as_matrix()
    T[:3, 3] = [a, 0, d]
    return turn @ T @ twist


def physical_inertia(rng: np.random.Generator, mass: float) -> Any:
    """The inertia about its COM of a cloud of point masses, so positive and triangular."""
    points = rng.normal(size=(8, 3)) * rng.uniform(0.02, 0.1, 3)
    points -= points.mean(axis=0)
    points = points @ Rotation.random(rng=rng).as_matrix().T
    second = mass / 8 * points.T @ points
    return np.trace(second) * np.eye(3) - second


def steiner(mass: Any, com: Any) -> Any:
    """``m (c'c 1 - c c')``, (..., 3, 3)."""
    square = (com * com).sum(axis=-1)[..., None, None]
    return mass[..., None, None] * (square * np.eye(3) - com[..., :, None] * com[..., None, :])


def spread(rng: np.random.Generator, nominal: Any, size: Any, width: Width) -> tuple[Any, ...]:
    """Bounds around `nominal`, not centred on it; `size` is the largest distance for "wide"."""
    scale = {"exact": 0.0, "narrow": 1e-4, "wide": 1.0, "mixed": 1.0}[width]
    down, up = (rng.uniform(0.1, 1.0, nominal.shape) * scale * size for _ in range(2))
    if width == "mixed":  # some parameters exact, some bounded on one side only
        down, up = (np.where(rng.random(nominal.shape) < 0.4, 0.0, x) for x in (down, up))
    return nominal - down, nominal + up


def symmetric(matrices: Any) -> Any:
    """The upper triangle of each matrix, copied to the lower."""
    upper = np.triu(matrices)
    return upper + np.triu(matrices, 1).swapaxes(-1, -2)


def random_robot(
    rng: np.random.Generator,
    n: int = 6,
    *,
    types: str | None = None,
    tree: bool = False,
    simple: bool = False,
    width: Width = "wide",
    drives: bool = True,
) -> Robot:
    """A random robot with n joints.

    types: one letter a joint, "r" or "p"; None draws them. simple: a standard D-H chain with one
    body a link in the link frame, the paper's case; otherwise B_i, placements and one to three
    bodies a link are random, one body is fixed to the base, and every third tensor is about the
    body's frame.
    """
    letters = types or "".join(rng.choice(["r", "p"], size=n, p=[0.7, 0.3]))
    n = len(letters)
    parents = np.arange(n) - 1
    if tree:
        parents = np.array([rng.integers(-1, i) if i else -1 for i in range(n)])
    if simple:
        before = np.tile(np.eye(4), (n, 1, 1))
        after = np.array([dh(rng, letter == "p") for letter in letters])
        body_joints = np.arange(n)
        placement = np.tile(np.eye(4), (n, 1, 1))
        base = np.eye(4)
    else:
        before = np.array([pose(rng) for _ in range(n)])
        after = np.array([pose(rng) for _ in range(n)])
        counts = rng.integers(1, 4, n)
        body_joints = np.concatenate([[-1], np.repeat(np.arange(n), counts)])
        placement = np.array([pose(rng, 0.1) for _ in body_joints])
        base = pose(rng)
    b = len(body_joints)
    mass = rng.uniform(0.3, 4.0, b)
    inertia = np.array([physical_inertia(rng, m) for m in mass])
    com = rng.uniform(-0.1, 0.1, (b, 3))
    framed = np.zeros(b, dtype=bool) if simple else np.arange(b) % 3 == 1
    nominal = Parameters(
        mass=mass,
        com=com,
        inertia=symmetric(np.where(framed[:, None, None], inertia + steiner(mass, com), inertia)),
        rotor_inertia=rng.uniform(1e-5, 6e-5, n) * drives,
        viscous=rng.uniform(1.0, 20.0, n) * drives,
        coulomb=rng.uniform(1.0, 8.0, n) * drives,
    )
    largest = np.linalg.eigvalsh(inertia)[:, -1][:, None, None] * np.ones((b, 3, 3))
    sizes = Parameters(
        mass=0.2 * mass,
        com=np.full((b, 3), 0.02),
        inertia=0.1 * largest,
        rotor_inertia=0.5 * nominal.rotor_inertia,
        viscous=0.3 * nominal.viscous,
        coulomb=0.3 * nominal.coulomb,
    )
    sides = {
        k: spread(rng, getattr(nominal, k), getattr(sizes, k), width)
        for k in ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb")
    }
    sides["inertia"] = tuple(symmetric(side) for side in sides["inertia"])
    d = rng.uniform(0.0, 1.0, (2, n))
    return Robot(
        name=f"random-{letters}",
        gravity=np.array([0.0, 0.0, -9.81]) if simple else rng.uniform(-7.0, 7.0, 3),
        base=base,
        joint_names=tuple(f"joint{i}" for i in range(n)),
        joint_types=tuple("revolute" if k == "r" else "prismatic" for k in letters),
        parents=parents.astype(np.int32),
        before=before,
        after=after,
        position_limits=np.tile([-np.inf, np.inf], (n, 1)),
        velocity_limits=np.full(n, np.inf),
        effort_limits=np.full(n, np.inf),
        gear_ratio=rng.uniform(50.0, 160.0, n) * drives,
        coulomb_speed=np.full(n, 1e-3),
        body_names=tuple(f"body{i}" for i in range(b)),
        body_joints=body_joints.astype(np.int32),
        placement=placement,
        nominal=nominal,
        lower=Parameters(**{k: side[0] for k, side in sides.items()}),
        upper=Parameters(**{k: side[1] for k, side in sides.items()}),
        disturbance=Bounded(nominal=np.zeros(n), lo=-d[0], hi=d[1]),
        controller=ControllerSettings(K_r=(10.0,) * n),
        inertia_about=tuple("frame" if yes else "com" for yes in framed),
    )


def tied(robot: Robot, n: int, rng: np.random.Generator, anywhere: bool = False) -> Robot:
    """The same robot with only n free joints; the others mimic random ones of them.

    The last ones mimic; `anywhere`: random ones, so that they may carry free joints.
    """
    d = robot.disturbance
    count = robot.n - n
    mimic = np.arange(n, robot.n)
    leaders = rng.integers(0, n, count).astype(np.int32)
    multiplier, offset = rng.uniform(-2.0, 2.0, count), rng.uniform(-0.5, 0.5, count)
    if anywhere:
        mimic = np.sort(rng.permutation(robot.n)[:count])
    free = np.setdiff1d(np.arange(robot.n), mimic)
    return replace(
        robot,
        name=f"{robot.name}-tied",
        joint_names=tuple(robot.joint_names[i] for i in free),
        position_limits=robot.position_limits[free],
        velocity_limits=robot.velocity_limits[free],
        effort_limits=robot.effort_limits[free],
        acceleration_limits=robot.acceleration_limits[free],
        disturbance=Bounded(d.nominal[free], d.lo[free], d.hi[free]),
        controller=ControllerSettings(K_r=(10.0,) * n),
        mimic=MimicJoints(
            names=tuple(robot.joint_names[i] for i in mimic),
            leaders=leaders,
            multiplier=multiplier,
            offset=offset,
            joints=mimic.astype(np.int32),
        ),
    )


def random_state(rng: np.random.Generator, n: int, rate: float = 2.0) -> tuple[Any, Any, Any, Any]:
    """Random q, dq, dq_a, ddq_a, each (n,)."""
    q = rng.uniform(-np.pi, np.pi, n)
    dq, dq_a, ddq_a = rng.normal(size=(3, n)) * rate
    return q, dq, dq_a, ddq_a


def point_robot(types: str, *, after: Any, mass: Any, com: Any, inertia: Any) -> Robot:
    """A serial robot with one body a link in the link frame, exact parameters and no drives.

    types: one letter a joint, "r" or "p"; after (n, 4, 4), mass (n,), com (n, 3), inertia
    (n, 3, 3) about the COM. Gravity is -9.81 m/s^2 along z of the base.
    """
    n = len(types)
    point = Parameters(
        mass=np.array(mass, dtype=float),
        com=np.array(com, dtype=float),
        inertia=np.array(inertia, dtype=float),
        rotor_inertia=np.zeros(n),
        viscous=np.zeros(n),
        coulomb=np.zeros(n),
    )
    return replace(
        random_robot(np.random.default_rng(0), types=types, simple=True, drives=False),
        name=f"point-{types}",
        after=np.array(after, dtype=float),
        nominal=point,
        lower=point,
        upper=point,
        disturbance=Bounded(nominal=np.zeros(n), lo=np.zeros(n), hi=np.zeros(n)),
    )


def about_com(robot: Robot) -> Robot:
    """The robot with its nominal parameters exact and every tensor moved to the COM."""
    p = robot.nominal
    moved = np.where(robot.framed[:, None, None], p.inertia - steiner(p.mass, p.com), p.inertia)
    point = replace(p, inertia=moved)
    return replace(robot, nominal=point, lower=point, upper=point, inertia_about=())


def about_frame(robot: Robot) -> Robot:
    """The robot with its nominal parameters exact and every tensor about the body's frame."""
    p = about_com(robot).nominal
    point = replace(p, inertia=p.inertia + steiner(p.mass, p.com))
    abouts = ("frame",) * robot.b
    return replace(robot, nominal=point, lower=point, upper=point, inertia_about=abouts)


def merge_bodies(robot: Robot) -> Robot:
    """The robot with the nominal bodies of each link made one in the link frame, exactly.

    Every link must carry a body. The factorisation C of Algorithm 1 depends on this: see
    test_bodies_apart_change_the_factorisation_by_a_known_gyroscopic_moment.
    """
    p, n = about_com(robot).nominal, robot.n
    mass, com, inertia = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    for i in range(n):
        own = np.flatnonzero(robot.body_joints == i)
        R, t = robot.placement[own, :3, :3], robot.placement[own, :3, 3]
        centres = np.einsum("bij,bj->bi", R, p.com[own]) + t
        mass[i] = p.mass[own].sum()
        com[i] = p.mass[own] @ centres / mass[i]
        for m, c, turn, J in zip(p.mass[own], centres - com[i], R, p.inertia[own], strict=True):
            inertia[i] += turn @ J @ turn.T + m * (c @ c * np.eye(3) - np.outer(c, c))
    point = replace(p, mass=mass, com=com, inertia=symmetric(inertia))
    return replace(
        robot,
        body_names=tuple(f"link{i}" for i in range(n)),
        body_joints=np.arange(n, dtype=np.int32),
        placement=np.tile(np.eye(4), (n, 1, 1)),
        nominal=point,
        lower=point,
        upper=point,
        inertia_about=(),
    )
