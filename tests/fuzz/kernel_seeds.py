"""Seeds of the kernel's fuzz target: robots of the catalogue in the format of kernel_input.h."""

from __future__ import annotations

import struct
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

import modrobust as mr
from modrobust.assembly.modules.catalogue import builtin_robots

ANY, THREE = 0, 1  # tag of a double bit by bit; kind of a box given by three numbers


def number(x: float) -> bytes:
    return struct.pack("<Bd", ANY, x)


def numbers(values: Iterable[float]) -> bytes:
    return b"".join(map(number, values))


def transform(T: np.ndarray) -> bytes:
    return b"\x03" + numbers(T[:3, :3].ravel()) + numbers(T[:3, 3])


def boxes(nominal: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> bytes:
    rows = zip(nominal.ravel(), lower.ravel(), upper.ravel(), strict=True)
    return b"".join(bytes([THREE]) + numbers(row) for row in rows)


def encode(robot: mr.Robot, rng: np.random.Generator) -> bytes:
    """The robot at a random state with its own controller settings."""
    f, c, d = robot.mimic, robot.controller, robot.disturbance
    out = [bytes([robot.n - 1, robot.j - robot.n, robot.b])]
    for i in range(robot.j):
        kind = robot.joint_types[i] == "prismatic"
        out += [bytes([kind, robot.parents[i] + 1]), transform(robot.before[i])]
        out += [transform(robot.after[i]), numbers([robot.gear_ratio[i], robot.coulomb_speed[i]])]
    out.append(bytes(np.isin(np.arange(robot.j), f.joints).tolist()))
    for leader, multiplier, offset in zip(f.leaders, f.multiplier, f.offset, strict=True):
        out += [bytes([leader]), numbers([multiplier, offset])]
    bodies = zip(robot.body_joints, robot.framed, robot.placement, strict=True)
    for joint, framed, placement in bodies:
        out += [bytes([joint + 1, int(framed)]), transform(placement)]
    out.append(numbers(robot.base[:3, :3].T @ robot.gravity))
    points = robot.nominal, robot.lower, robot.upper
    upper = np.triu_indices(3)
    out.append(boxes(*(point.mass for point in points)))
    out.append(boxes(*(point.com for point in points)))
    out.append(boxes(*(point.inertia[:, *upper] for point in points)))
    for name in ("rotor_inertia", "viscous", "coulomb"):
        out.append(boxes(*(getattr(point, name) for point in points)))
    out.append(boxes(d.nominal, d.lo, d.hi))
    out.append(numbers(rng.normal(size=5 * robot.n)))
    out.append(b"\x01" + numbers([0.0, 1e-3, *np.broadcast_to(c.K_r, robot.n)]))
    out.append(numbers([c.kappa_P, c.kappa_I, c.phi_P, c.phi_I, c.epsilon]))
    out.append(bytes(robot.wraps.tolist()))
    out += held_and_driven(robot, rng)
    return b"".join(out)


def held_and_driven(robot: mr.Robot, rng: np.random.Generator) -> list[bytes]:
    """Gains of the laws for a held command, and a loop that a drive runs, each kind at random."""
    limits = np.where(np.isfinite(robot.effort_limits), robot.effort_limits, 1e3)
    sizes = np.array([[1e-4], [1e-2], [1e-5], [1e-3]]) * np.ones(robot.n)
    return [
        numbers([3.0, 2.0, 0.5]) + bytes(rng.integers(0, 2, 1).tolist()),
        numbers([1e-3, rng.random(), 40.0, 20.0, 80.0, 2e-3]) + bytes([int(rng.integers(8))]),
        numbers(limits),
        bytes([int(rng.integers(128)) | 96]) + numbers(sizes.ravel()),
        numbers([0.3 * (rng.random() < 0.5), 2.0]) + bytes([int(rng.integers(256))]),
    ]


def write_seeds(folder: Path) -> int:
    """Writes one file for each robot that fits the format; returns how many."""
    folder.mkdir(parents=True, exist_ok=True)
    rng, count = np.random.default_rng(0), 0
    for name, file in builtin_robots().items():
        try:
            robot = mr.load_robot(file)
        except mr.ModrobustError:  # needs a package that is not installed
            continue
        if robot.n <= 12 and robot.j - robot.n <= 3 and robot.b <= 15:
            (folder / name).write_bytes(encode(robot, rng))
            count += 1
    return count


if __name__ == "__main__":
    write_seeds(Path(sys.argv[1]))
