"""The robots of the tournament, and the gains that their files had before they were chosen.

    python benchmarks/population.py

prints the robots with their gains by the law ``auto``.
"""

from __future__ import annotations

import importlib.metadata
import time
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import modrobust as mr
from modrobust.design.gains import design
from modrobust.model import LoopSettings, Robot

BUILTIN = (
    *("lwa4p-paper", "lwa4p", "lwa4p-payload", "ur5", "panda", "iiwa", "pino-arm", "hebi-arm"),
    *("scara", "gantry", "snake12", "concert-wall", "baxter", "tiago"),
)
TOLERANCE = "mass=5%, com=5 mm, inertia=10%"
# Of example-robot-data: file, rated payload [kg], link that carries it, options.
URDF: Mapping[str, tuple[str, float, str, dict[str, Any]]] = {
    "u:ur3": ("ur_description/urdf/ur3_robot.urdf", 3.0, "tool0", {"tip": "tool0"}),
    "u:ur10": ("ur_description/urdf/ur10_robot.urdf", 10.0, "tool0", {"tip": "tool0"}),
    "u:panda": (
        "panda_description/urdf/panda.urdf",
        *(3.0, "panda_hand"),
        {"lock": {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02}},
    ),
    "u:kinova": ("kinova_description/robots/kinova.urdf", 2.2, "j2s6s200_end_effector", {}),
    "u:xarm7": ("xarm_description/urdf/xarm7.urdf", 3.5, "link7", {}),
    "u:z1": ("z1_description/urdf/z1.urdf", 2.0, "link06", {}),
    "u:so101": ("so_arm_description/urdf/so101.urdf", 0.25, "gripper_link", {}),
    "u:talos": ("talos_data/robots/talos_left_arm.urdf", 0.5, "wrist_left_ft_tool_link", {}),
}
ROBOTS = (*BUILTIN, *URDF)

# K_r, kappa_P, kappa_I, phi_P, phi_I as they stood in assemblies/*.yaml of release 0.1.0, by hand;
# a URDF had those of a file that gives none.
_PAPER = (10.0, 2.0, 100.0, 1.0, 200.0)
OLD_GAINS: Mapping[str, tuple[float, float, float, float, float]] = {
    **dict.fromkeys(ROBOTS, _PAPER),
    "lwa4p": (10.0, 0.5, 10.0, 200.0, 1000.0),
    "lwa4p-payload": (10.0, 0.5, 10.0, 200.0, 1000.0),
    "ur5": (20.0, 0.2, 5.0, 150.0, 500.0),
    "panda": (20.0, 1.0, 50.0, 50.0, 200.0),
    "iiwa": (30.0, 0.5, 20.0, 20.0, 100.0),
    "scara": (10.0, 0.2, 10.0, 300.0, 1000.0),
    "gantry": (10.0, 0.2, 10.0, 300.0, 1000.0),
    "baxter": (20.0, 0.5, 20.0, 50.0, 200.0),
    "tiago": (20.0, 0.2, 5.0, 100.0, 500.0),
}
NOISE = 1e-4, 1e-2  # [rad] or [m], [rad/s] or [m/s]


@cache
def load(name: str) -> Robot:
    """A robot of the population."""
    if name in BUILTIN:
        return mr.load_robot(name)
    file, kilograms, link, options = URDF[name]
    payload = f"mass=[0 kg, {kilograms:g} kg], com=[0, 0, [20 mm, 80 mm]], at={link}"
    return mr.load_robot(_located(file), tolerance=TOLERANCE, payload=payload, **options)


def _located(file: str) -> Path:
    files = importlib.metadata.files("example-robot-data") or []
    return Path(str(next(f for f in files if str(f).endswith(f"/{file}")).locate()))


def old_gains(name: str) -> dict[str, Any]:
    """The gains that the file of a robot had, as settings."""
    keys = ("K_r", "kappa_P", "kappa_I", "phi_P", "phi_I")
    return dict(zip(keys, OLD_GAINS[name], strict=True))


def make_loop(robot: Robot, rate: float, delay: float, noise: bool) -> LoopSettings:
    """The loop of a row: limits cut, and the noise of the tournament or none."""
    loop = LoopSettings(rate=rate, delay=delay, saturation=True)
    if not noise:
        return loop
    position, velocity = ((size,) * robot.n for size in NOISE)
    return replace(loop, noise_position=position, noise_velocity=velocity)


if __name__ == "__main__":
    for each in ROBOTS:
        arm = load(each)
        begin = time.perf_counter()
        found = design(arm, make_loop(arm, 1000.0, 1.0, True))
        print(
            f"{each:14s} G {found.G:6.4g} by {found.binding:9s} pi {found.spectra.light} reachable "
            f"{found.reachable} {found.epsilon_reached:.3g} error {found.error:.3g} "
            f"{time.perf_counter() - begin:.2f} s",
            flush=True,
        )
