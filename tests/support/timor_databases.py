"""Module databases as Timor writes them, for tests of their import."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from support.float_transforms import from_xyz_rpy, rotation_x

EYE = np.eye(4).tolist()
IN = rotation_x(math.pi).tolist()  # the in connector looks away from the body, against the chain


def inertia(*moments: float) -> list[list[float]]:
    return np.diag(moments).tolist()


def body(
    name: str, mass: float = 0.0, com: Any = (0.0, 0.0, 0.0), tensor: Any = None, ends: Any = ()
) -> dict[str, Any]:
    zeros = np.zeros((3, 3)).tolist()
    return {
        "ID": name, "mass": mass, "r_com": list(com), "inertia": tensor or zeros,
        "connectors": list(ends),
    }  # fmt: skip


def end(name: str, pose: Any, gender: str, kind: str = "schunk") -> dict[str, Any]:
    return {"ID": name, "pose": pose, "gender": gender, "type": kind, "size": [1]}


# A joint module with the figures of a Schunk PowerBall (Timor's IMPROV set, MIT, ID 21).
ELBOW = (3.9, (0.0, 0.018, -0.082), inertia(0.042799, 0.037801, 0.010997))
TURN = from_xyz_rpy((0.0, 0.1013, 0.1013), (-math.pi / 2, 0.0, 0.0))
NOISE = 3e-15


def powerball() -> dict[str, Any]:
    noisy = TURN + NOISE * np.array([[0, 1, 0, 1], [0, 1, 0, -1], [1, 0, 1, 0], [0, 0, 0, 0]])
    axis = {
        "ID": "axis 1", "parent": "p", "child": "elbow", "type": "revolute", "passive": False,
        "poseParent": EYE, "poseChild": noisy.tolist(),
        "limits": {"positionLower": -2.9671, "positionUpper": 2.9671, "peakTorque": 75.504,
                   "velocity": 1.2566, "acceleration": 2.618},
        "gearRatio": 160.0, "motorInertia": 5.23e-5,
        "frictionCoulomb": 7.14, "frictionViscous": 15.68,
    }  # fmt: skip
    second = axis | {"ID": "axis 2", "parent": "elbow", "child": "d", "poseChild": EYE}
    return {
        "header": {"ID": "21", "name": 'PB "21"', "author": ["A", "B"]},
        "bodies": [
            body("p", ends=[end("in", IN, "f")]), body("elbow", *ELBOW),
            body("d", ends=[end("out", EYE, "m")]),
        ],
        "joints": [axis, second],
    }  # fmt: skip


def bent_link() -> dict[str, Any]:
    out = from_xyz_rpy((0.1, -0.2, 0.3), (0.4, -0.5, 0.6))
    into = from_xyz_rpy((0.01, 0.02, 0.03), (0.1, 0.2, 0.3)) @ rotation_x(math.pi)
    part = body(
        "tube", 1.2, (0.05, -0.1, 0.15), inertia(0.09, 0.08, 0.05),
        [end("out", out.tolist(), "m"), end("in", into.tolist(), "f")],
    )  # fmt: skip
    return {"header": {"ID": "bent link", "name": "Bent"}, "bodies": [part], "joints": []}


def base() -> dict[str, Any]:
    part = body("b", ends=[end("ground", IN, "f", "base"), end("out", EYE, "m")])
    return {"header": {"ID": "ground", "name": "Ground"}, "bodies": [part], "joints": []}


def database(folder: Path, *modules: dict[str, Any]) -> Path:
    path = folder / "modules.json"
    path.write_text(json.dumps({"modules": list(modules)}), encoding="utf-8")
    return path
