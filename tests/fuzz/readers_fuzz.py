"""A coverage-guided fuzz target on everything that reads a file: any exception but ours is a bug.

    python tests/fuzz/readers_fuzz.py FOLDER [--seconds 600] [--seed 0]

starts from the catalogue, keeps in FOLDER/grown each input that ran through our sources on a way
of its own, and in FOLDER/found one input for each bug; a second run goes on. In plain Python, so
that it runs wherever the tests do. The first byte of an input says what the rest is, see `READERS`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import random
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import modrobust as mr
from fuzz.reader_mutations import mutated
from fuzz.reader_seeds import write_seeds
from modrobust.assembly.modules.catalogue import data_directory
from modrobust.dynamics import inverse_dynamics_bounds
from modrobust.formats import load_module, parse_quantity
from modrobust.motion import read_trajectory_csv
from modrobust.timor import import_timor

SOURCES = str(Path(mr.__file__).parent)
DIMENSIONS = ("mass", "length", "angle", "inertia", "torque")
HANG = 10.0  # [s] of one input
Way = tuple[CodeType, int, int]  # from a line to a line


class HangError(Exception):
    """One input took longer than `HANG`."""


def read_robot(file: Path) -> None:
    """Loads a robot, writes it as JSON and computes bounds with it."""
    robot = mr.load_robot(file)
    json.dumps(robot.to_dict(), allow_nan=False)
    zero = np.zeros(robot.n)
    inverse_dynamics_bounds(robot, zero, zero, zero, zero)


def read_trajectory(file: Path) -> None:
    read_trajectory_csv(file, ("a", "b"))


def read_quantity(file: Path) -> None:
    text = file.read_text(encoding="utf-8", errors="replace")
    for dimension in DIMENSIONS:
        try:
            parse_quantity(text, dimension)
        except mr.ModrobustError:
            continue


READERS: dict[bytes, tuple[str, Callable[[Path], object]]] = {
    b"m": ("assemblies/module.yaml", load_module),
    b"a": ("assemblies/robot.yaml", read_robot),
    b"j": ("assemblies/robot.json", read_robot),
    b"u": ("assemblies/robot.urdf", read_robot),
    b"t": ("assemblies/modules.json", import_timor),
    b"c": ("assemblies/motion.csv", read_trajectory),
    b"q": ("assemblies/quantity", read_quantity),
}


def read(data: bytes, folder: Path) -> None:
    """One input; raises what the reader should not have raised."""
    name, reader = READERS[data[:1]]
    file = folder / name
    file.write_bytes(data[1:])
    try:
        reader(file)
    except mr.ModrobustError as problem:
        if not str(problem).strip():
            raise AssertionError("an error without a message") from problem


def ways_of(data: bytes, folder: Path) -> tuple[set[Way], Exception | None]:
    """The ways that an input took through our sources, and what it wrongly raised."""
    ways: set[Way] = set()

    def enter(frame: FrameType, event: str, arg: object) -> Any:
        code, last = frame.f_code, 0
        if not code.co_filename.startswith(SOURCES):
            return None

        def step(frame: FrameType, event: str, arg: object) -> Any:
            nonlocal last
            if event == "line":
                ways.add((code, last, frame.f_lineno))
                last = frame.f_lineno
            return step

        return step

    problem: Exception | None = None
    signal.setitimer(signal.ITIMER_REAL, HANG)
    sys.settrace(enter)
    try:
        read(data, folder)
    except Exception as found:
        problem = found
    finally:
        sys.settrace(None)
        signal.setitimer(signal.ITIMER_REAL, 0)
    return ways, problem


def place_of(problem: Exception) -> str:
    """What tells one bug from another: its kind and where in our sources it came up."""
    ours = [f for f in traceback.extract_tb(problem.__traceback__) if SOURCES in f.filename]
    where = f"{Path(ours[-1].filename).name}:{ours[-1].lineno}" if ours else "nowhere of ours"
    return f"{type(problem).__name__} at {where}"


def fuzz(folder: Path, seconds: float, seed: int) -> tuple[int, dict[str, str]]:
    """How many inputs were read, and the bugs: what, and the file of an input that shows it."""
    rng = random.Random(seed)
    grown, found = folder / "grown", folder / "found"
    for place in (grown, found):
        place.mkdir(parents=True, exist_ok=True)
    write_seeds(folder / "seeds")
    waiting = [p.read_bytes() for where in ("seeds", "grown") for p in (folder / where).iterdir()]
    waiting.sort()
    corpus: list[bytes] = []
    bugs: dict[str, str] = {}
    known: set[Way] = set()
    count, end = 0, time.monotonic() + seconds
    with tempfile.TemporaryDirectory() as work:
        (Path(work) / "assemblies").mkdir()
        (Path(work) / "modules").symlink_to(data_directory("modules"))
        while waiting or time.monotonic() < end:
            # new ways lie near the last ones that were found
            near = corpus[-8:] if rng.random() < 0.3 else corpus
            data = waiting.pop() if waiting else mutated(rng.choice(near), rng)
            ways, problem = ways_of(data, Path(work))
            count += 1
            name = f"{data[:1].decode()}-{hashlib.sha256(data).hexdigest()[:16]}"
            if problem is not None and place_of(problem) not in bugs:
                (found / name).write_bytes(data)
                bugs[place_of(problem)] = f"{found / name}: {str(problem)[:200]}"
            if ways - known:
                known |= ways
                corpus.append(data)
                (grown / name).write_bytes(data)
    return count, bugs


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()

    def hang(*_: object) -> None:
        raise HangError(f"longer than {HANG:g} s")

    signal.signal(signal.SIGALRM, hang)
    warnings.simplefilter("error")  # what a user would read about our innards is a bug too
    count, bugs = fuzz(given.folder, given.seconds, given.seed)
    kept = len(list((given.folder / "grown").iterdir()))
    print(f"{count} inputs read, {kept} with a way of their own, {len(bugs)} bugs")
    for what, where in sorted(bugs.items()):
        print(f"{what}\n    {where}")
    return 1 if bugs else 0


if __name__ == "__main__":
    sys.exit(main())
