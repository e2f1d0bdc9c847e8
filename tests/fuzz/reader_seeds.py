"""Seeds of the readers' fuzz target: the catalogue, and a small text for each other format."""

from __future__ import annotations

import json
from pathlib import Path

import modrobust as mr
from modrobust.assembly.modules.catalogue import builtin_robots, data_directory
from modrobust.export.urdf import urdf_text

LIGHT = ("gantry", "lwa4p-paper", "lwa4p-payload", "scara")  # load in a few milliseconds
QUANTITIES = ("5 kg", "18 mm ± 1 mm", "3.9 kg ± 2%", "-pi/2", "90 deg", "1e-3 kg m^2 +- 5%")
MOTION = "# a motion\nt,a,b\n0,0,0\n0.5,0.1,-2e-1\n1,0.2,0.3\n"
EYE = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]]
INERTIA = [[0.02, 0, 0], [0, 0.02, 0], [0, 0, 0.01]]


def connector(name: str, gender: str) -> dict[str, object]:
    return {"ID": name, "pose": EYE, "gender": gender, "type": "t", "size": [1]}


def body(name: str, **ends: str) -> dict[str, object]:
    connectors = [connector(key, gender) for key, gender in ends.items()]
    return {
        "ID": name, "mass": 1.5, "r_com": [0, 0.01, 0.02], "inertia": INERTIA,
        "connectors": connectors,
    }  # fmt: skip


TIMOR = {
    "modules": [
        {
            "header": {"ID": "7", "name": "elbow", "author": ["A"]},
            "bodies": [{**body("p", **{"in": "f"})}, body("c", out="m")],
            "joints": [
                {
                    "ID": "axis", "parent": "p", "child": "c", "type": "revolute",
                    "passive": False, "poseParent": EYE, "poseChild": EYE,
                    "limits": {"positionLower": -2.9, "positionUpper": 2.9, "peakTorque": 75.5,
                               "velocity": 1.2, "acceleration": 2.6},
                    "gearRatio": 160.0, "motorInertia": 5.23e-5, "frictionCoulomb": 7.1,
                    "frictionViscous": 15.6,
                }
            ],
        }
    ]
}  # fmt: skip
ROBOT = {
    "modrobust": 1,
    "robot": "robot",
    "modules": "../modules",
    "chain": ["schunk-pb-large-1", {"module": "schunk-pb-large-2", "mount": "90 deg"}],
    "payload": {"at": "schunk-pb-large-2", "mass": ["0 kg", "2 kg"], "com": [0, 0, "20 mm"]},
    "controller": {"law": "norm", "bound": "hull", "K_r": 10, "epsilon": "0.01 rad"},
}


def renamed(file: Path, kind: str) -> bytes:
    """A file's text with the name that the target gives it, see readers_fuzz.READERS."""
    return file.read_bytes().replace(f"{kind}: {file.stem}".encode(), f"{kind}: {kind}".encode(), 1)


def write_seeds(folder: Path) -> int:
    """Writes one file an input, its kind in the first byte; returns how many."""
    folder.mkdir(parents=True, exist_ok=True)
    robots = builtin_robots()
    modules = sorted(data_directory("modules").glob("*.yaml"))
    inputs = {f"m-{file.stem}": renamed(file, "module") for file in modules}
    inputs |= {f"a-{name}": renamed(robots[name], "robot") for name in LIGHT}
    inputs["u-scara"] = urdf_text(mr.load_robot("scara")).text.encode()
    inputs["j-small"] = json.dumps(ROBOT, indent=1).encode()
    inputs["t-elbow"] = json.dumps(TIMOR, indent=1).encode()
    inputs["c-motion"] = MOTION.encode()
    inputs |= {f"q-{k}": text.encode() for k, text in enumerate(QUANTITIES)}
    for name, content in inputs.items():
        (folder / name).write_bytes(name[:1].encode() + content)
    return len(inputs)
