"""Makes docs/measured/robots.md: every real robot of the test dependencies, in the closed loop.

    python benchmarks/robots_table.py [SECONDS]

Takes about five minutes. The robots, and those that are refused, are listed in
tests/support/real_robots.py; their uncertainty and the gains in tests/support/uncertain_robots.py.
"""

from __future__ import annotations

import datetime
import importlib.metadata
import os
import platform
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from common import markdown, processor  # noqa: E402

import modrobust as mr  # noqa: E402
from modrobust.bench.benchmark import random_tightness, replay  # noqa: E402
from support.real_robots import LOADED, REFUSED, located  # noqa: E402
from support.uncertain_robots import REFLECTED, SETTINGS, START, run, with_uncertainty  # noqa: E402

PAGE = ROOT / "docs" / "measured" / "robots.md"
SECONDS = 3.0  # [s] of motion
SHORTER = {"tiago_dual": 1.0}  # [s], 101 joints
STATES = 200
HEAD = (
    "robot",
    "package",
    "joints",
    "bodies",
    "load [ms]",
    "command, hull [us]",
    "command, ianea [us]",
    "ianea/hull",
    "run [s]",
    "violations",
    "below epsilon from [s]",
    "error at the end",
)


def row(package: str, name: str, seconds: float, folder: Path) -> list[str]:
    """The figures of one robot."""
    urdf = located(package, name)
    load = []
    for _ in range(3):
        begin = time.perf_counter()
        mr.load_robot(urdf)
        load.append(time.perf_counter() - begin)
    robot = with_uncertainty(urdf, folder)
    seconds = SHORTER.get(name, seconds)
    result = run(robot, seconds)
    assert result.statistics is not None
    hull, ianea = (np.median(replay(result, bound, 3).in_c) for bound in ("hull", "ianea"))
    widths = random_tightness(robot, STATES)
    ratio = widths.width_ianea / widths.width_hull
    entered = result.epsilon_entered_at
    return [
        name,
        package,
        f"{robot.n}" + (f" + {robot.j - robot.n}" if robot.j > robot.n else ""),
        str(robot.b),
        f"{min(load) * 1e3:.0f}",
        f"{hull * 1e6:.3g}",
        f"{ianea * 1e6:.3g}",
        f"{np.nanmedian(ratio):.3g}",
        f"{seconds:g}",
        f"{result.statistics.violations}" + (", diverged" if result.diverged else ""),
        "never" if entered is None else f"{entered:.3f}",
        f"{result.statistics.error_last:.1e}",
    ]


def refusals() -> list[list[str]]:
    """What is refused, with the product's own words."""
    rows = []
    for package, name in REFUSED:
        urdf = located(package, name)
        try:
            mr.load_robot(urdf)
        except mr.ModrobustError as problem:
            first, *more = (
                problem.faults if isinstance(problem, mr.SeveralFaultsError) else [problem]
            )
            said = str(first).removeprefix(str(urdf)).removeprefix(" (expanded)")
            said = said.lstrip(":0123456789 ") + (f", and {len(more)} more" if more else "")
            rows.append([name, package, said.replace("|", "/").replace("<", "&lt;")])
        else:
            raise SystemExit(f"{name} is listed as refused, and loads")
    return rows


def main() -> None:
    """Measure everything, then write the page."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for package, names in LOADED.items():
            for name in names:
                rows.append(row(package, name, seconds, Path(folder)))
                print("  ".join(rows[-1]), flush=True)
    packages = ", ".join(f"{p} {importlib.metadata.version(p)}" for p in LOADED)
    gains = ", ".join(f"{key} {value}" for key, value in SETTINGS.items())
    PAGE.write_text(
        f"""# Real robots

Made by `benchmarks/robots_table.py`, not by hand: {datetime.date.today():%d %B %Y}, {processor()},
{os.cpu_count()} processors shared with other work, Python {platform.python_version()}; {packages}.

The files are chosen by a rule: manipulators and upper bodies, on a fixed or a floating base (which
is held still), as URDF, or as xacro that expands without a ROS installation. Variants of a robot
that differ only in visuals or hands are left out, except a few of UR, Panda, iiwa and TALOS.
Whatever of these has a mass matrix that is positive definite loads as it is, some legged robots and
hands too; the rest is under "Refused". Dynamics agree with Pinocchio's to 1e-9
(`tests/assembly/urdf/test_real_robots.py`).
For the table each robot gets the same uncertainty and the same gains, none tuned to it:

- 5 % on masses, inertias (of the largest principal moment), damping, friction and rotor inertia,
  5 mm on every centre of mass. True parameters are drawn at random inside, seed 1.
- A reflected rotor inertia of {REFLECTED:g} kg m^2 (prismatic: kg) on every joint: URDFs give none,
  and without any a wrist of 4e-6 kg m^2 beside 1 N m of friction is stiffer than any control rate.
- {gains}; law `norm`, bound `hull`, 50 kHz. The motion is a seeded quintic through
  waypoints within the limits; the run starts {START:g} off it, in norm.

{markdown(HEAD, rows)}

Joints: free ones + mimic joints. Load: the file alone, the shortest of three;
xacro is expanded in a process of its own (px100 to wx250s).
Command: the whole law in C, the median over the run's states; the run itself uses `hull`.
ianea/hull: width of [Phi], the median over joints and {STATES} random states. Errors are norms over
all joints, radians and metres together. Torque limits are not looked at here; `modrobust simulate`
does.

Five of them are ready as `modrobust simulate NAME`, with bounds and gains of their own:
`ur5`, `panda`, `iiwa`, `baxter`, `tiago` ([catalogue.md](../reference/catalogue.md)). Their
files are in `assemblies/`; `pip install "modrobust[robots]"` brings the packages that hold the
URDFs.

## Refused

{markdown(("file", "package", "why"), refusals())}

Where a figure is wrong or missing, the robot loads once an assembly file gives it (`links:`,
`joints:`), or once the part that has it is left out with `--tip` or `--base`:
[urdf.md](../reference/urdf.md).
""",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
