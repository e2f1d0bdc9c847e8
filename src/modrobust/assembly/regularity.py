r"""Refusal of chains whose mass matrix is singular.

A joint that moves no mass cannot be simulated nor controlled: its acceleration is undefined. The
test factorises M(q) = L' L from the last joint to the first; pivot i is the inertia that joint i
feels with everything behind it free to move, so a vanishing pivot names its joint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.errors import DescriptionError
from modrobust.formats import Where
from modrobust.model import Robot
from modrobust.model.definite import singular_joint

_SEED = 0


def refuse_singular(robot: Robot, where: Sequence[Where], carrying: str = "") -> None:
    """Raises where M(q) at nominal parameters, drives included, is singular at a seeded pose.

    Args:
        robot: The robot.
        where: Where each of its joints is written, mimic joints too, (j,).
        carrying: Which of several payloads, for the message.

    Raises:
        DescriptionError: M is singular, or cannot be computed; the message names the joint.
    """
    q = np.random.default_rng(_SEED).uniform(-1.0, 1.0, robot.n)  # [rad] or [m]
    try:
        M = _kernel.mass_matrix(robot.model, robot.nominal.packed, q, True)
    except _kernel.KernelError as problem:
        if problem.args[0] == _kernel.STATUS_ANGLE_RANGE:  # no free joint: its q is within 1 rad
            raise _turns_too_far(robot, where, q) from None
        # Masses are bounded where they are read: it is a drive or a length.
        with np.errstate(over="ignore", invalid="ignore"):
            drives = robot.gear_ratio**2 * robot.nominal.rotor_inertia
        worst = int(np.argmax(np.nan_to_num(drives[robot.free], nan=np.inf, posinf=np.inf)))
        raise where[robot.free[worst]].error(
            f"joint {robot.joint_names[worst]}",
            "the inertia that it moves is not finite; a figure is far too large; check the "
            "exponents of its drive and of the lengths behind it",
        ) from None
    joint = singular_joint(M)
    if joint is not None:
        axis = "along" if robot.free_types[joint] == "prismatic" else "about"
        raise where[robot.free[joint]].error(
            f"joint {robot.joint_names[joint]}",
            f"nothing behind it has inertia {axis} its axis, so the mass matrix is singular "
            f"({' of '.join(filter(None, ('nominal parameters', carrying)))}, drives included); "
            "give it a drive or a body with inertia",
        )


def _turns_too_far(robot: Robot, where: Sequence[Where], q: Array) -> DescriptionError:
    """What to say where a mimic joint's angle (15) passes what the kernel computes with."""
    revolute = robot.turns
    joint = int(np.argmax(np.where(revolute, np.abs(robot.all_positions(q)), 0.0)))
    f = robot.mimic
    k = int(np.flatnonzero(f.joints == joint)[0])
    leader = f.leaders[k]
    unit = "rad" if revolute[robot.free[leader]] else "m"
    return where[joint].error(
        f"joint {robot.all_joint_names[joint]}, mimic",
        f"mimics joint {robot.joint_names[leader]} with multiplier {f.multiplier[k]:g} and offset "
        f"{f.offset[k]:g} rad, so that it passes {_kernel.ANGLE_MAX:g} rad while that one moves by "
        f"1 {unit}; no joint turns so far; correct the two",
    )
