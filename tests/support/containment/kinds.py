"""What a run has tried: kinds of robots, boxes and states, told from the numbers themselves.

Not from the generator's word for them: a generator that had lost a kind would still use its name.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.model import Robot
from support.containment.extreme_states import Signals, auxiliary
from support.containment.written_robots import Written
from support.states import doubles

# Least share of all states that the kernel answered; about half of what 100,000 cases have.
LEAST = {
    "body on the base": 0.8,
    "uncertain friction": 0.8,
    "body known to per cents": 0.4,
    "tensor about the frame": 0.4,
    "lower end of a wide hull touched, drives": 0.4,
    "nominal off the middle": 0.4,
    "read as given": 0.4,
    "several bodies a link": 0.4,
    "uncertain rotor": 0.4,
    "upper end of a wide hull touched, drives": 0.4,
    "com unknown, tensor about the frame": 0.3,
    "disturbance": 0.3,
    "lower end of a wide hull touched, bodies": 0.3,
    "mass unknown, tensor about the frame": 0.3,
    "no error of position": 0.3,
    "read as doubles": 0.3,
    "upper end of a wide hull touched, bodies": 0.3,
    "body known to 1e-12": 0.2,
    "bounded on one side": 0.2,
    "com known to no order": 0.2,
    "error of position": 0.2,
    "exact bodies beside others": 0.2,
    "heavy body": 0.2,
    "light body": 0.2,
    "mass that may be 0": 0.2,
    "read as exact rotations": 0.2,
    "some prismatic joints": 0.2,
    "usual": 0.2,
    "at rest": 0.1,
    "mass known to no order": 0.1,
    "no gears": 0.1,
    "no gravity": 0.1,
    "rates above 1e3": 0.1,
    "read as (4)": 0.1,
    "tree": 0.1,
    "whole turns taken off": 0.09,
    "mimic": 0.09,
    "link without a body": 0.09,
    "free joint behind a mimic joint": 0.04,
    "body known to a bit": 0.08,
    "rates apart by 1e100": 0.08,
    "kilometres": 0.07,
    "all rates below 1e-8": 0.06,
    "no error of velocity": 0.06,
    "all prismatic": 0.05,
    "one joint": 0.05,
    "rotations a little off": 0.05,
    "torques that cancel": 0.05,
    "all bodies exact": 0.04,
    "one joint moves": 0.04,
    "right angles": 0.04,
    "subnormal numbers": 0.04,
    "more than 8 joints": 0.03,
    "no lengths": 0.03,
    "rates above 1e20": 0.03,
    "angles beyond 1e4": 0.02,
    "no friction": 0.02,
    "right-angled rotations": 0.008,
    "slides beyond 1e6": 0.007,
    "more than 20 joints": 0.003,
}


def kinds_of_robot(robot: Robot, written: Written) -> set[str]:
    """Geometry and box."""
    links = robot.body_joints[robot.body_joints >= 0]
    bodies = np.bincount(links, minlength=robot.j)
    prismatic = np.array(written.prismatic)
    rotations = np.concatenate([robot.before, robot.after])[:, :3, :3]
    defect = np.abs(rotations.swapaxes(1, 2) @ rotations - np.eye(3)).max()
    lengths = np.abs(np.concatenate([robot.before, robot.after])[:, :3, 3])
    found = {
        "one joint": robot.n == 1,
        "more than 8 joints": robot.n > 8,
        "more than 20 joints": robot.n > 20,
        "some prismatic joints": prismatic.any() and not prismatic.all(),
        "all prismatic": prismatic.all(),
        "tree": written.parents != list(range(-1, robot.j - 1)),
        "mimic": robot.j > robot.n,
        "free joint behind a mimic joint": _carries_free(robot),
        "several bodies a link": bodies.max() > 1,
        "link without a body": bodies.min() == 0,
        "body on the base": len(links) < robot.b,
        "rotations a little off": defect > 1e-12,
        "right-angled rotations": bool(np.isin(rotations, (-1.0, 0.0, 1.0)).all()),
        "no gravity": not np.any(robot.gravity),
        "no lengths": not lengths.any(),
        "kilometres": lengths.max() > 100.0,
        "no gears": not np.any(robot.gear_ratio),
        "disturbance": bool(np.any(robot.disturbance.lo < robot.disturbance.hi)),
    }
    return {name for name, is_so in found.items() if is_so} | _kinds_of_box(robot)


def _carries_free(robot: Robot) -> bool:
    """Whether a mimic joint carries one that moves freely."""
    mimic_joints = set(robot.mimic.joints.tolist())
    for i in robot.free.tolist():
        while i >= 0:
            i = int(robot.parents[i])
            if i in mimic_joints:
                return True
    return False


def _kinds_of_box(robot: Robot) -> set[str]:
    """Breadths of the bodies' and drives' boxes relative to their nominal values."""
    lower, nominal, upper = (
        np.concatenate([p.mass[:, None], p.com, p.inertia.reshape(-1, 9)], axis=1)
        for p in (robot.lower, robot.nominal, robot.upper)
    )
    width = upper - lower
    with np.errstate(all="ignore"):
        wide = width[:, 0] / nominal[:, 0]  # of the mass
    com = np.linalg.norm(nominal[:, 1:4], axis=1)
    exact = (width == 0.0).all(axis=1)
    ulps = np.nextafter(nominal, np.inf) - np.nextafter(nominal, -np.inf)
    mixed = ((lower == nominal) ^ (upper == nominal)).any(axis=1)
    far = np.abs(upper + lower - 2.0 * nominal) > 0.1 * width
    drives = [
        np.stack([p.rotor_inertia, p.viscous, p.coulomb])
        for p in (robot.lower, robot.nominal, robot.upper)
    ]
    wide_com = (width[:, 1:4] > 0.0).any(axis=1)
    found = {
        "tensor about the frame": robot.framed.any(),
        "com unknown, tensor about the frame": (robot.framed & wide_com).any(),
        "mass unknown, tensor about the frame": (robot.framed & (width[:, 0] > 0.0)).any(),
        "all bodies exact": exact.all(),
        "exact bodies beside others": exact.any() and not exact.all(),
        "body known to a bit": ((width == ulps).all(axis=1)).any(),
        "body known to 1e-12": ((wide > 1e-14) & (wide < 1e-11)).any(),
        "body known to per cents": ((wide > 0.01) & (wide < 1.0)).any(),
        "mass known to no order": (wide > 3.0).any(),
        "mass that may be 0": ((lower[:, 0] == 0.0) & (wide > 0.0)).any(),
        "bounded on one side": mixed.any(),
        "nominal off the middle": far.any(),
        "com known to no order": ((com > 0.0) & (width[:, 1:4].max(axis=1) > 3.0 * com)).any(),
        "light body": (nominal[:, 0] < 1e-3).any(),
        "heavy body": (nominal[:, 0] > 1e3).any(),
        "no friction": not drives[2][1:].any(),
        "uncertain rotor": bool((drives[0] < drives[2])[0].any()),
        "uncertain friction": bool((drives[0] < drives[2])[1:].any()),
    }
    return {name for name, is_so in found.items() if is_so}


def kinds_of_state(robot: Robot, signals: Signals) -> set[str]:
    """Sizes of the signals, and how they hang together."""
    q, dq, _, dq_des, ddq_des = (np.abs(x) for x in signals)
    free: Any = robot.free_turns
    rates = np.concatenate([dq, dq_des, ddq_des])
    moving = rates[rates > 0.0]
    turns = q[free] / (np.pi / 2)
    state = (signals.q, signals.dq, *auxiliary(robot, signals))
    u0, error = _kernel.inverse_dynamics_rounding(
        robot.model, robot.nominal.packed, *doubles(state), True
    )
    found = {
        "at rest": not dq.any() and not dq_des.any(),
        "one joint moves": robot.n > 2 and np.count_nonzero(dq + dq_des + ddq_des) == 1,
        "right angles": np.round(turns).any() and (np.abs(turns - np.round(turns)) < 1e-7).all(),
        "angles beyond 1e4": (q[free] > 1e4).any(),
        "slides beyond 1e6": (q[~free] > 1e6).any(),
        "subnormal numbers": ((rates > 0.0) & (rates < 2.0**-1022)).any(),
        "all rates below 1e-8": moving.size and moving.max() < 1e-8,
        "rates above 1e3": ((rates > 1e3) & (rates < 1e7)).any(),
        "rates above 1e20": (rates > 1e20).any(),
        "rates apart by 1e100": moving.size and moving.max() / 1e100 > moving.min(),
        "torques that cancel": u0.any() and (np.abs(u0) < 1e3 * error).all(),
        "usual": moving.size and 0.1 < moving.max() < 30.0,
        "no error of position": np.array_equal(signals.q, signals.q_des),
        "whole turns taken off": (np.abs(signals.q_des - signals.q)[robot.wraps] > np.pi).any(),
        "error of position": not np.array_equal(signals.q, signals.q_des),
        "no error of velocity": dq.any() and np.array_equal(signals.dq, signals.dq_des),
    }
    return {name for name, is_so in found.items() if is_so}
