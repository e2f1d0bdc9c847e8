"""Instructions of one robust command of the paper's LWA 4P, counted by callgrind.

    python tests/instructions/instruction_counts.py

stores the counts of this machine's gcc in tests/data/instruction_counts.json. The kernel is built
with its own flags for any x86-64, because valgrind does not know every instruction of this machine.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import modrobust as mr
import modrobust.kernel

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from support.kernel.native import gains_of  # noqa: E402

STORED = HERE.parent / "data" / "instruction_counts.json"
KERNEL = Path(modrobust.kernel.__file__).parent
FLAGS = [line for line in (KERNEL / "flags.txt").read_text().splitlines() if line[:1] == "-"]
STATES, ROUNDS = 10, (2, 12)
RATE, FAST = 1.5, 10.0  # [rad/s], and as much of position and acceleration


def exact(robot: mr.Robot) -> mr.Robot:
    """Every parameter known, those of the drives too."""
    return replace(robot, lower=robot.nominal, upper=robot.nominal)


def first_uncertain(robot: mr.Robot) -> mr.Robot:
    """Only the first body unknown, as in `uncertain`: what exact bodies cost beside it."""
    wide = uncertain(robot)
    lower, upper = (
        replace(
            robot.nominal,
            **{
                name: np.concatenate([getattr(side, name)[:1], getattr(robot.nominal, name)[1:]])
                for name in ("mass", "com", "inertia")
            },
        )
        for side in (wide.lower, wide.upper)
    )
    return replace(robot, lower=lower, upper=upper)


def widest(robot: mr.Robot) -> mr.Robot:
    """5 m on every COM, so that extrema lie inside the boxes: the faces of (19) are looked at."""
    wide = uncertain(robot)
    com = robot.nominal.com
    lower, upper = replace(wide.lower, com=com - 5.0), replace(wide.upper, com=com + 5.0)
    return replace(robot, lower=lower, upper=upper)


def uncertain(robot: mr.Robot) -> mr.Robot:
    """The robot with 5 % on every mass, 5 mm on every COM and 10 % on every inertia."""
    p = robot.nominal
    spread = np.abs(p.inertia).max(axis=(1, 2), keepdims=True) * 0.1
    lower = replace(p, mass=0.95 * p.mass, com=p.com - 5e-3, inertia=p.inertia - spread)
    upper = replace(p, mass=1.05 * p.mass, com=p.com + 5e-3, inertia=p.inertia + spread)
    return replace(robot, lower=lower, upper=upper)


def as_it_is(robot: mr.Robot) -> mr.Robot:
    """The paper's."""
    return robot


SAMPLED: dict[str, Any] = {"law": "sampled", "G": 40.0, "rate": 1e3}
Case = tuple[Callable[[mr.Robot], mr.Robot], float, dict[str, Any]]
CASES: dict[str, Case] = {  # robot, size of the signals, options of the controller
    "Table II, hull": (as_it_is, RATE, {"law": "norm", "bound": "hull"}),
    "Table II, ianea": (as_it_is, RATE, {"law": "norm", "bound": "ianea"}),
    "every body uncertain, hull": (uncertain, RATE, {"law": "norm", "bound": "hull"}),
    "every body uncertain, ianea": (uncertain, RATE, {"law": "norm", "bound": "ianea"}),
    "all exact, hull": (exact, RATE, {"law": "norm", "bound": "hull"}),
    "first body only, hull": (first_uncertain, RATE, {"law": "norm", "bound": "hull"}),
    "widest boxes, hull": (widest, FAST, {"law": "norm", "bound": "hull"}),
    "sampled, no delay": (as_it_is, RATE, {**SAMPLED, "delay": 0.0}),
    "sampled, a tick late": (as_it_is, RATE, {**SAMPLED, "delay": 1.0}),
}


def floats(values: Any) -> str:
    return ", ".join(float(x).hex() for x in np.ravel(values))


def table(kind: str, name: str, values: Iterable[Any]) -> str:
    """A C array; one entry of filling where it is empty."""
    entries = list(values) or [0]
    text = floats(entries) if kind == "double" else ", ".join(str(int(x)) for x in entries)
    return f"static const {kind} {name}[] = {{{text}}};\n"


def transforms(name: str, T: Any) -> str:
    rows = ", ".join(f"{{{{{floats(t[:3, :3])}}}, {{{floats(t[:3, 3])}}}}}" for t in T)
    return f"static const mr_transform {name}[] = {{{rows}}};\n"


def gains(robot: mr.Robot, options: dict[str, Any]) -> str:
    """`command_gains`, and the points that it names."""
    given = gains_of(mr.RobustController(robot, **options))
    b, j = robot.b, robot.j
    ends = np.cumsum([0, b, 3 * b, 6 * b, j, j])
    method = f"(mr_method){given.pop('bound')}"
    given["law"] = f"(mr_law){given['law']}"
    out, fields = "", {"method": method}
    for name, value in given.items():
        if not isinstance(value, np.ndarray):
            fields[name] = value.hex() if isinstance(value, float) else str(value)
            continue
        fields[name] = name
        if name in ("centre", "light"):
            fields[name] = "{" + ", ".join(f"{name} + {end}" for end in ends) + "}"
        out += table("double", name, value)
    said = ", ".join(f".{name} = {value}" for name, value in fields.items())
    return f"{out}static const mr_gains command_gains = {{{said}}};\n".replace("inf", "INFINITY")


def data(robot: mr.Robot, rate: float, options: dict[str, Any]) -> str:
    """command_data.h: the robot, its box and gains, and signals at fixed random states."""
    f, d = robot.mimic, robot.disturbance
    b, j = robot.b, robot.j
    x, y, z = (row * g for row, g in zip(robot.base[:3, :3], robot.gravity, strict=True))
    points = {"nominal": robot.nominal, "lower": robot.lower, "upper": robot.upper}
    wide = [k for k in range(b) if any(
        (getattr(robot.lower, name)[k] != getattr(robot.upper, name)[k]).any()
        for name in ("mass", "com", "inertia")
    )]  # fmt: skip
    out = ['#include <math.h>\n#include "mr_kernel.h"\n']
    out.append(table("int32_t", "types", [kind == "prismatic" for kind in robot.joint_types]))
    out.append(table("int32_t", "parents", robot.parents))
    out.append(transforms("before", robot.before) + transforms("after", robot.after))
    out.append(table("double", "ratios", robot.gear_ratio))
    out.append(table("double", "speeds", robot.coulomb_speed))
    out.append(table("int32_t", "moves", robot.moves))
    out.append(table("int32_t", "leaders", f.leaders))
    out.append(table("double", "multipliers", f.multiplier) + table("double", "offsets", f.offset))
    out.append(table("int32_t", "body_joints", robot.body_joints))
    out.append(transforms("placements", robot.placement))
    out.append(table("int32_t", "abouts", robot.framed))
    out.extend(table("double", name, point.packed) for name, point in points.items())
    out.append(table("double", "d_lo", d.lo) + table("double", "d_hi", d.hi))
    out.append(table("int32_t", "uncertain", wide))
    signals = np.random.default_rng(0).uniform(-rate, rate, (STATES, 5, robot.n))
    out.append(f"enum {{ JOINTS = {robot.n}, STATES = {STATES} }};\n")
    rows = "}, {".join("{" + "}, {".join(map(floats, state)) + "}" for state in signals)
    out.append(f"static const double signals[STATES][5][JOINTS] = {{{{{rows}}}}};\n")
    out.append(
        f"static const mr_model command_model = {{{robot.n}, {j}, {b}, types, parents, before, "
        "after, ratios, speeds, moves, leaders, multipliers, offsets, body_joints, placements, "
        f"abouts, {{{floats(x + y + z)}}}, NULL, NULL}};\n"
    )
    ends = np.cumsum([0, b, 3 * b, 6 * b, j, j])
    views = [", ".join(f"{name} + {end}" for end in ends) for name in points]
    out.append(
        f"static const mr_bounds command_bounds = {{{{{'}, {'.join(views)}}}, d_lo, d_hi, "
        f"uncertain, {len(wide)}, NULL}};\n"
    )
    out.append(gains(robot, options))
    return "".join(out)


def gcc_version() -> str:
    """The major version: the count depends on the compiler."""
    return subprocess.check_output(["gcc", "-dumpversion"], text=True).split(".")[0].strip()


def executed(program: Path, rounds: int) -> int:
    """Instructions of the whole program."""
    answer = subprocess.run(
        ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", program, str(rounds)],
        capture_output=True,
        text=True,
        check=True,
    )
    found = re.search(r"Collected : (\d+)", answer.stderr)
    if found is None:
        raise RuntimeError(answer.stderr)
    return int(found[1])


def count_all() -> dict[str, float]:
    """Instructions of one command, mean over the states, case by case."""
    paper = mr.load_robot("lwa4p-paper")
    counts = {}
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        objects = []
        for source in sorted(KERNEL.glob("*.c")):
            objects.append(folder / f"{source.stem}.o")
            subprocess.run(["gcc", *FLAGS, "-c", source, "-o", objects[-1]], check=True)
        for name, (of, rate, options) in CASES.items():
            (folder / "command_data.h").write_text(data(of(paper), rate, options))
            program = folder / "count"
            include: list[str | Path] = ["-I", folder, "-I", KERNEL, HERE / "command_count.c"]
            subprocess.run(["gcc", *FLAGS, *include, *objects, "-lm", "-o", program], check=True)
            few, many = (executed(program, rounds) for rounds in ROUNDS)
            counts[name] = (many - few) / (ROUNDS[1] - ROUNDS[0]) / STATES
    return counts


def main() -> None:
    if shutil.which("valgrind") is None:
        sys.exit("valgrind is not installed; apt-get install valgrind")
    stored = json.loads(STORED.read_text()) if STORED.is_file() else {}
    stored[f"gcc {gcc_version()}"] = {name: round(n, 1) for name, n in count_all().items()}
    STORED.write_text(json.dumps(stored, indent=2, sort_keys=True) + "\n")
    print(STORED.read_text(), end="")


if __name__ == "__main__":
    main()
