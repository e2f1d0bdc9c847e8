"""Magnitudes that nobody means: degrees as radians, millimetres as metres, grams as kilograms.

Each is allowed, and the bound is as true as the figures; a remark in `modrobust assemble` says what
was found, so that a slip in a unit is seen before a robot moves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from modrobust.checks.types import Array
from modrobust.model import Robot
from modrobust.model.physical import inertia_about_com

_TURNS = 3.0  # cables allow no more; 180 taken as radians is 28.6 turns
_REACH = 20.0  # [m]
_MASSES = 1e4  # heaviest over lightest
_SMALL = 0.2  # [m], a body that is spread no further than this is no slip


def magnitudes(robot: Robot, reach: float, torque: Array) -> list[str]:
    """One remark for each magnitude that is hardly meant; empty where there is none.

    Args:
        robot: Robot with n free joints.
        reach: Its reach [m].
        torque: Largest static torques ``(n,)`` [N m] or [N].
    """
    found = [*_weak(robot, torque), *_limits(robot), *_spread(robot), *_masses(robot)]
    if reach > _REACH:
        found.append(
            f"reach: {reach:.4g} m, beyond {_REACH:g} m: lengths in mm that were read as m?"
        )
    return found


def _weak(robot: Robot, torque: Array) -> Iterator[str]:
    for j, name in enumerate(robot.joint_names):
        limit = float(robot.effort_limits[j])
        if torque[j] > limit > 0.0:
            unit = "N" if robot.free_types[j] == "prismatic" else "N m"
            yield (
                f"joint {name}: static torque of {torque[j]:.4g} {unit}, {torque[j] / limit:.0%} "
                "of its limit: it cannot hold the arm everywhere; check the limit, the masses and "
                "the payload"
            )


def _limits(robot: Robot) -> Iterator[str]:
    for j, name in enumerate(robot.joint_names):
        lo, hi = map(float, robot.position_limits[j])
        turns = max(abs(lo), abs(hi)) / math.tau
        if robot.free_types[j] != "prismatic" and math.isfinite(turns) and turns > _TURNS:
            yield (
                f"joint {name}: position limits {lo:.4g} to {hi:.4g} rad, up to {turns:.3g} "
                "turns: degrees that were read as radians?"
            )


def _spread(robot: Robot) -> Iterator[str]:
    """Bodies whose mass would lie farther from their COM than anything of their link does."""
    p = robot.nominal
    masses = p.mass
    tensors = inertia_about_com(p.mass, p.com, p.inertia, robot.framed)
    for k, name in enumerate(robot.body_names):
        joint = int(robot.body_joints[k])
        trace = float(np.trace(tensors[k]))
        if joint < 0 or masses[k] <= 0.0 or trace <= 0.0 or _told(robot, name):
            continue
        radius = math.sqrt(trace / 2.0 / float(masses[k]))
        size = max(_link_size(robot, k, joint), _SMALL)
        if radius > size:
            yield (
                f"body {name}: {masses[k]:.4g} kg with a radius of gyration of {radius:.3g} m, "
                f"but its link reaches no farther than {size:.3g} m from its centre of mass: "
                "inertia in other units, or a placeholder? no bound around a made-up figure holds "
                "the true one"
            )


def _told(robot: Robot, body: str) -> bool:
    """Whether the reader of the URDF has said it already."""
    return any(n.startswith(f"link {body}: ") and "radius of gyration" in n for n in robot.notes)


def _link_size(robot: Robot, body: int, joint: int) -> float:
    """Largest distance [m] from a body's COM to the joints and bodies of its link."""
    placement = robot.placement
    com = placement[body, :3, :3] @ robot.nominal.com[body] + placement[body, :3, 3]
    own = robot.after[joint]
    points = [np.zeros(3), -own[:3, :3].T @ own[:3, 3]]  # its end, and its own joint
    points += [robot.before[i, :3, 3] for i in range(robot.j) if robot.parents[i] == joint]
    for other in np.flatnonzero(robot.body_joints == joint):
        T = placement[other]
        points += [T[:3, 3], T[:3, :3] @ robot.nominal.com[other] + T[:3, 3]]
    return max(float(np.linalg.norm(point - com)) for point in points)


def _masses(robot: Robot) -> Iterator[str]:
    moving = np.flatnonzero((robot.body_joints >= 0) & (robot.nominal.mass > 0.0))
    if not len(moving):
        return
    masses = robot.nominal.mass[moving]
    light, heavy = (int(moving[k]) for k in (np.argmin(masses), np.argmax(masses)))
    ratio = float(masses.max() / masses.min())
    if ratio > _MASSES:
        yield (
            f"masses from {masses.min():.3g} kg (body {robot.body_names[light]}) to "
            f"{masses.max():.3g} kg (body {robot.body_names[heavy]}), a ratio of {ratio:.2g}: "
            "grams that were read as kg, or a placeholder?"
        )


__all__ = ["magnitudes"]
