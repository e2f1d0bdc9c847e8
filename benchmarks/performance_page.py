"""Makes docs/measured/performance.md: every figure of it, measured now, on this machine.

    python benchmarks/performance_page.py

Takes about four minutes the first time. Run it on a machine that has nothing else to do. Needs the
extra "peers"; compares with gcc and with clang where both are installed.
"""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import shutil
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path

import batch
import growth
import worst_case
from common import announce, machine, markdown

import modrobust as mr
from modrobust.bench.benchmark import PAPER_TIMES, replay
from modrobust.bench.peers.compile import toolchain
from modrobust.bench.peers.native import pinocchio_cpp
from modrobust.bench.peers.python_calls import numpy_transcription, pinocchio_python
from modrobust.bench.peers.timing import Comparison
from modrobust.simulation.metrics import time_statistics

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "measured" / "performance.md"
COUNTS = ROOT / "tests" / "data" / "instruction_counts.json"
COMPILERS = (("gcc", "g++"), ("clang", "clang++"), ("gcc", "clang++"))  # ours, Pinocchio's
COMMANDS = (
    ["--help"],
    ["assemble", "lwa4p-paper"],
    ["simulate", "lwa4p-paper"],
)


def version(said: str) -> str:
    """The number in what a compiler says of itself."""
    return next(word for word in reversed(said.split()) if word[0].isdigit())


def us(seconds: float) -> str:
    """Microseconds, three digits."""
    return f"{seconds * 1e6:.3g}"


def compared(comparisons: dict[str, Comparison]) -> str:
    """Minimum time and ratios of each subject, for each way to compile."""
    head = ["[us]"]
    for name in comparisons:
        head += [name, "ratio of minima", "of medians"]
    first = next(iter(comparisons.values()))
    rows = []
    for item in first.timings:
        cells = [item.name]
        for c in comparisons.values():
            least, median = c.ratio_of_minima(item.name), c.ratio_of_medians(item.name)
            cells += [us(c.timing(item.name).minimum), f"{least:.3g}", f"{median:.3g}"]
        rows.append(cells)
    return markdown(head, rows)


def in_cpp(robot: mr.Robot) -> tuple[dict[str, Comparison], Comparison, str]:
    """Native flags by each pair of compilers, the flags that ship by the first; their versions."""
    found, versions, shipped = {}, {}, None
    for cc, cxx in COMPILERS:
        if shutil.which(cc) and shutil.which(cxx):
            os.environ.update(CC=cc, CXX=cxx)
            native = pinocchio_cpp(robot, announce=announce)
            found[f"{cc} and {cxx}"] = native
            versions[cc] = f"{cc} {version(toolchain().version)}"
            shipped = shipped or pinocchio_cpp(robot, "shipped", announce=announce)
    for name in ("CC", "CXX"):
        del os.environ[name]
    assert shipped is not None  # there is no installing without a compiler
    return found, shipped, ", ".join(versions.values())


def single_calls(robot: mr.Robot, native: Comparison) -> str:
    """Mean, deviation and largest, as the paper gives them: its motion, then random states."""
    run = mr.simulate(robot, scenario="1")
    rows = [["paper, `ianea`, 3.5 GHz i7", *(us(PAPER_TIMES[k]) for k in ("mean", "std", "max"))]]
    rows[0] += ["", ""]
    for bound in ("ianea", "hull"):
        s = time_statistics(replay(run, bound, 3).in_c)
        cells = [us(s[k] or 0.0) for k in ("mean", "std", "max", "p99")]
        rows.append([f"the paper's motion, `{bound}`, as installed", *cells, ""])
    for item in native.to_dict()["subjects"]:
        if item["alone"] is not None:
            calls, states = item["alone"]["calls"], item["alone"]["states"]
            cells = [us(calls[k]) for k in ("mean", "std", "max", "p99")]
            rows.append([f"random states, {item['name']}, native", *cells, us(states["max"])])
    return markdown(["[us]", "mean", "std", "largest", "99 %", "slowest state"], rows)


def instruction_counts() -> str:
    """Those that CI compares with."""
    if not COUNTS.is_file():
        return "Not stored yet."
    return f"```json\n{json.dumps(json.loads(COUNTS.read_text()), indent=2)}\n```"


def command_line() -> Iterator[list[str]]:
    """Wall time of whole processes, the minimum of three."""
    for arguments in COMMANDS:
        least = float("inf")
        for _ in range(3):
            begin = time.perf_counter()
            subprocess.run(
                [sys.executable, "-m", "modrobust", *arguments], check=True, capture_output=True
            )
            least = min(least, time.perf_counter() - begin)
        yield [f"`modrobust {' '.join(arguments)}`", f"{least:.2f}"]


def main() -> None:
    """Measure everything, then write the page."""
    begun = machine()
    robot = mr.load_robot("lwa4p-paper")
    cpp, shipped, compilers = in_cpp(robot)
    gcc = next(iter(cpp.values()))
    slow = {bound: worst_case.measured(robot, bound) for bound in ("hull", "ianea")}
    columns = growth.measured()
    versions = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("pin", "numpy", "modrobust")
    )
    where = f"{begun} (load when it began); {versions}, {compilers}, {platform.system()}"
    made = f"Made by `benchmarks/performance_page.py`, not by hand: {where}."
    PAGE.write_text(
        f"""# Performance

{textwrap.fill(made, 100)}

The robot is the paper's LWA 4P, `lwa4p-paper`, 6 joints. "Own bounds" are its Table II (one
uncertain body), "all bodies" 5 % of every mass, 5 mm of every centre of mass and 10 % of every
inertia. Every bound has its rounding enclosed. Machines change their speed while they run: compare
times within one table only, and look at the ratios. Medians suffer from other work on the machine,
least times less.

## Against Pinocchio in C++

The whole robust command (trajectory errors, nominal torque, bounds, law) against *one* nominal
inverse dynamics of Pinocchio: header-only, `-O3 -march=native` for both, one process, one thread,
1,000 random states, 101 interleaved rounds. Our nominal torque differs from Pinocchio's by
{gcc.disagreement:.0e} of the largest. `NE*` is our nominal pass, "sine, cosine" those of six
angles. A column names the compiler of the kernel and that of Pinocchio, to which it makes much of a
difference: no ratio holds for every compiler.

{compared(cpp)}

The kernel with the flags that it ships with (no `-march`), Pinocchio as above:

{compared({next(iter(cpp)): shipped})}

`python benchmarks/pinocchio_cpp.py`, or `modrobust bench --peers`. Target: ratios of minimum times
of at most 1.0 (own bounds, `hull`) and 1.5 (all bodies, `hull`).

## Each command by itself

As the paper reports it: mean, standard deviation and largest of single commands. This is no
real-time system; the largest is that of an interruption. "Slowest state" is free of them: each
state's minimum of 10 calls, the largest over 1,000 states. {gcc.remarks[0].capitalize()}.

{single_calls(robot, gcc)}

## The slowest state there is

Time of the slowest of {worst_case.STATES} states over the typical one, for boxes of the centres of
mass of growing half-width (at last far wider than any lever, so that hardly a quadratic is
monotonic) and growing velocities. Branches save work on easy states; found by sampling, so the true
worst case may be a little slower.

`hull`, typical {us(slow["hull"].typical)} us:

{markdown(worst_case.HEAD, slow["hull"].rows())}

`ianea`, typical {us(slow["ianea"].typical)} us:

{markdown(worst_case.HEAD, slow["ianea"].rows())}

`python benchmarks/worst_case.py`

## Many states at once

`inverse_dynamics_bounds_batch`, every body uncertain; microseconds a state and core. In C, native
flags, one thread, against a loop of single calls:

{compared({"in C": batch.in_c(robot)})}

From Python, as installed, {batch.STATES} states a call:

{compared({"from Python": batch.from_python(robot)})}

`python benchmarks/batch.py`; the target is 0.25 us.

## Growth with the joints

Synthetic chains, microseconds a command. "One body": `hull` with only the last body uncertain, less
the same chain with none. Exponents are fitted from 16 joints on.

{markdown(["joints", *columns], growth.rows(columns))}

`python benchmarks/growth.py`, and `modrobust bench --growth`.

## From Python

One call at a time through the public functions, argument checks included. Pinocchio's binding:

{compared({"from Python": pinocchio_python(robot)})}

Algorithm 1 written line by line in NumPy (`src/modrobust/reference.py`):

{compared({"from Python": numpy_transcription(robot)})}

`python benchmarks/pinocchio_python.py`, `python benchmarks/numpy_transcription.py`.

## Instruction counts

One command under callgrind; CI compares with these figures, with a margin of 5 %
(`tests/data/instruction_counts.json`).

{instruction_counts()}

## Command line

{markdown(["command", "minimum of three [s]"], command_line())}
""",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
