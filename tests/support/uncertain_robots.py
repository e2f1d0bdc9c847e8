"""Real robots with 5 % uncertainty and the same settings for all.

For tests and docs/measured/robots.md.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import modrobust as mr
from modrobust.motion import make_trajectory

# One setting for arms of 1 kg and of 5 t. URDFs give no rotor inertia, and without any a wrist can
# have 4e-6 kg m^2 beside 1 N m of friction, stiffer than any control rate.
REFLECTED = 0.1  # [kg m^2] or [kg] on every joint, motor side with ratio 1
TOLERANCE = {
    "mass": "5%", "com": "5 mm", "inertia": "5%",
    "rotor_inertia": "5%", "viscous": "5%", "coulomb": "5%",
}  # fmt: skip
SETTINGS: dict[str, Any] = {
    "law": "norm",
    "rate": 50e3,
    "K_r": 20, "kappa_P": 1, "kappa_I": 50, "phi_P": 100, "phi_I": 200, "epsilon": 0.02,
}  # fmt: skip
START = 0.03  # norm of the first error: outside epsilon
SEED = 1


def with_uncertainty(urdf: Path, folder: Path) -> mr.Robot:
    """The robot of a URDF with tolerances and rotor inertias laid over it, through a file."""
    plain = mr.load_robot(urdf)
    name = urdf.name.partition(".")[0]  # of NAME.urdf and of NAME.urdf.xacro
    file = folder / f"{name}.json"
    overlay = {
        "modrobust": 1,
        "robot": name,
        "urdf": str(urdf),
        "tolerance": TOLERANCE,
        "joints": {
            joint: {
                "drive": {
                    "gear_ratio": "1" if kind != "prismatic" else "1 rad/m",
                    "rotor_inertia": f"{REFLECTED} kg m^2",
                }
            }
            for joint, kind in zip(plain.joint_names, plain.free_types, strict=True)
        },
    }
    file.write_text(json.dumps(overlay), encoding="utf-8")
    return mr.load_robot(file)


def run(robot: mr.Robot, motion: float, duration: float | None = None) -> mr.SimulationResult:
    """The closed loop at 50 kHz on a seeded motion [s], or its first part, off it at the start."""
    trajectory = make_trajectory(robot, "quintic", motion)
    q0 = trajectory.sample([0.0])[0][0] + START / np.sqrt(robot.n)
    return mr.simulate(
        robot,
        parameters="random",
        seed=SEED,
        trajectory=trajectory,
        duration=motion if duration is None else duration,
        q0=q0,
        **SETTINGS,
    )
