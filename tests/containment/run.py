"""Containment by the million, resumable.

    python tests/containment/run.py --cases 10000000

Every finished block is appended to the state file; started again with the same file it goes on
where it was, after Ctrl-C too. --seed N repeats one robot of a violation. Exit code 1: violations.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import signal
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict
from itertools import count
from multiprocessing import get_context
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))  # shared helpers of the tests

import modrobust  # noqa: E402  (after the path)
from support.containment.ball_comparison import Outcome  # noqa: E402
from support.containment.containment_cases import run_seed  # noqa: E402

BLOCK = 10  # seeds
PLAIN = argparse.RawDescriptionHelpFormatter


def run_block(block: int) -> tuple[int, Outcome]:
    """The outcome of one block of seeds."""
    outcome = Outcome()
    for seed in range(block * BLOCK, (block + 1) * BLOCK):
        outcome.add(run_seed(seed))
    return block, outcome


def fingerprint() -> str:
    """Of the kernel and of these tests: a state file of others would mix two things."""
    kernel = Path(modrobust.__file__).parent / "kernel"
    files = sorted(
        [
            *kernel.glob("*.[ch]"),
            kernel / "flags.txt",
            *HERE.parent.glob("support/containment/*.py"),
        ]
    )
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]


def read_state(file: Path) -> tuple[set[int], Outcome]:
    """Blocks that are done, and their sum; a line that was cut off is left out."""
    done: set[int] = set()
    total = Outcome()
    if not file.exists():
        return done, total
    for line in file.read_text(encoding="utf-8").splitlines():
        try:
            entry = json.loads(line)
        except json.JSONDecodeError:
            continue
        if entry.pop("of") != fingerprint():
            sys.exit(f"{file}: made with other sources; give another --state, or delete it")
        block = entry.pop("block")
        if block not in done:
            done.add(block)
            total.add(Outcome(**entry))
    return done, total


def outcomes(jobs: int, blocks: Iterator[int]) -> Iterator[tuple[int, Outcome]]:
    """Block after block, on several processes; only the parent hears Ctrl-C."""
    if jobs == 1:
        yield from map(run_block, blocks)
        return
    context = get_context("spawn")
    ignore = (signal.SIGINT, signal.SIG_IGN)
    with context.Pool(jobs, initializer=signal.signal, initargs=ignore) as pool:
        waiting = [pool.apply_async(run_block, (next(blocks),)) for _ in range(2 * jobs)]
        while True:
            yield waiting.pop(0).get()
            waiting.append(pool.apply_async(run_block, (next(blocks),)))


def line(total: Outcome, goal: int, rate: float) -> str:
    return f"{total.cases:,} of {goal:,} cases: {total.summary()}; {rate:.2f} ms a case"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=PLAIN)
    parser.add_argument("--cases", type=int, default=10_000_000)
    parser.add_argument("--state", type=Path, default=Path("build/containment.jsonl"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, help="repeat this robot only")
    options = parser.parse_args()
    if options.seed is not None:
        outcome = run_seed(options.seed)
        print(*outcome.violations, line(outcome, outcome.cases, 0.0), sep="\n")
        return 1 if outcome.violations else 0

    options.state.parent.mkdir(parents=True, exist_ok=True)
    done, total = read_state(options.state)
    print(*total.violations, sep="\n", end="\n" if total.violations else "")
    head = {"of": fingerprint()}
    started, before, shown = time.monotonic(), total.cases, 0.0
    try:
        with options.state.open("a", encoding="utf-8") as file:
            file.write("\n" if file.tell() else "")  # closes a line that was cut off
            todo = (block for block in count() if block not in done)
            if total.cases < options.cases:
                for block, outcome in outcomes(options.jobs, todo):
                    entry: dict[str, Any] = {**head, "block": block, **asdict(outcome)}
                    file.write(json.dumps(entry) + "\n")
                    file.flush()
                    total.add(outcome)
                    for violation in outcome.violations:
                        print(violation, flush=True)
                    elapsed = time.monotonic() - started
                    if elapsed > shown + 10.0:
                        shown = elapsed
                        rate = 1e3 * elapsed / (total.cases - before)
                        print(line(total, options.cases, rate), flush=True)
                    if total.cases >= options.cases:
                        break
    except KeyboardInterrupt:
        print(f"stopped; the same command goes on from {options.state}")
    elapsed = time.monotonic() - started
    print(line(total, options.cases, 1e3 * elapsed / max(total.cases - before, 1)))
    return 1 if total.violations else 0


if __name__ == "__main__":
    sys.exit(main())
