"""The tournament of laws: 14 built-in robots and 8 URDFs, every row of docs/measured/tournament.md.

    python benchmarks/tournament.py [--rows ROW ...] [--draws N] [--page]
    python benchmarks/tournament.py --show ROW VARIANT ROBOT RUN

Results lie in build/tournament, a file for each row, variant and robot; what is there is not done
again. Two processes work, each on its own robots; --page writes the page from what there is.
--show does one run once more and prints its figures.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import time
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from population import BUILTIN, ROBOTS, load, make_loop, old_gains

import modrobust as mr
from modrobust.campaign import Record, Run
from modrobust.campaign.campaign import chosen_settings
from modrobust.campaign.job import Job
from modrobust.campaign.motions import draw_motion
from modrobust.campaign.plan import checked_plan
from modrobust.campaign.workers import run_all
from modrobust.control.settings import checked_settings
from modrobust.model import ControllerSettings, LoopSettings, Robot
from modrobust.motion import Quintic
from modrobust.simulation import SimulationResult

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "build" / "tournament"
PROCESSES = 2
DRAWS = 20
RATES = (250, 500, 1000, 2000, 4000)
# 20 draws: the ends of the box, then vertices and points inside in turn.
KINDS = ("lower", "upper", *("corner", "random") * 9)


@dataclass(frozen=True)
class Variant:
    """One setting of loop and law, run on every robot of a row."""

    rate: float = 1000.0
    delay: float = 1.0
    noise: bool = True
    law: str = "auto"
    epsilon: float | None = None  # None = the file's own
    factor: float = 1.0  # on the gains
    start: float = 0.005  # [rad] or [m], norm
    each: float | None = None  # instead: on each joint
    motion: str = "short"
    plant: str = "builtin"
    draws: int = DRAWS
    kind: str = "campaign"  # or "rest", "paper"

    @property
    def name(self) -> str:
        """Short, for a file."""
        parts = [f"{self.rate:g}Hz", f"D{self.delay:g}", "noise" if self.noise else "still"]
        plain = Variant()
        for key in ("law", "epsilon", "factor", "start", "each", "motion", "plant"):
            value = getattr(self, key)
            if value != getattr(plain, key):
                parts.append(f"{key}-{value}")
        return "_".join(parts)


@dataclass(frozen=True)
class Row:
    """A row of the page."""

    title: str
    variants: tuple[Variant, ...]
    robots: tuple[str, ...] = field(default=ROBOTS)


LOOPS = ((1.0, True), (1.0, False), (0.0, True), (0.0, False))
LAWS = ("norm", "norm, hold-aware", "componentwise", "componentwise, hold-aware")
ROWS: Mapping[str, Row] = {
    "own": Row("1 kHz, delay 1, noise, own epsilon", (Variant(),)),
    "plain": Row("1 kHz, neither", (Variant(delay=0.0, noise=False),)),
    "stability": Row(
        "every rate, delay 0 and 1, noise and none",
        tuple(
            Variant(rate=rate, delay=delay, noise=noise, draws=3)
            for delay, noise in LOOPS
            for rate in RATES
            if (rate, delay, noise) not in ((1000, 1.0, True), (1000, 0.0, False))
        ),
    ),
    "wide": Row("epsilon 0.03, delay 1, noise", (Variant(epsilon=0.03),)),
    "factor": Row(
        "gains times 1.75",
        tuple(Variant(delay=d, noise=n, factor=1.75, draws=10) for d, n in LOOPS),
        BUILTIN,
    ),
    "starts": Row(
        "start 0.02 off (norm), 0.3 off on every joint",
        (Variant(start=0.02), Variant(each=0.3)),
    ),
    "late": Row("no noise, delay 1", (Variant(noise=False),)),
    "long": Row("motions of 10 s", (Variant(motion="long", draws=6),)),
    "files": Row("the files' own motions", (Variant(motion="own", draws=4),), BUILTIN),
    "rest": Row("30 s at rest", (Variant(kind="rest", draws=2),)),
    "paper": Row(
        "paper's robot, both scenarios",
        (
            *(Variant(delay=d, noise=False, kind="paper", draws=2) for d in (0.0, 1.0)),
            Variant(rate=50000.0, delay=0.0, noise=False, law="norm", kind="paper", draws=2),
        ),
        ("lwa4p-paper",),
    ),
    "laws": Row(
        "other laws with the files' gains",
        tuple(Variant(delay=d, noise=n, law=law) for law in LAWS for d, n in (LOOPS[0], LOOPS[3])),
    ),
    "mujoco": Row("MuJoCo", (Variant(plant="mujoco", draws=50),), BUILTIN),
}


@lru_cache(maxsize=64)
def settings_of(name: str, variant: Variant) -> ControllerSettings:
    """Law and gains of a robot in a variant."""
    robot, loop = load(name), loop_of(name, variant)
    epsilon = variant.epsilon or robot.controller.epsilon
    if variant.law != "auto":
        law, _, aware = variant.law.partition(", ")
        given: Any = {
            "law": law,
            "hold_aware": bool(aware),
            "epsilon": epsilon,
            **old_gains(name),
        }
        return checked_settings(robot, given)
    own = variant.motion == "own" or variant.kind == "paper"
    chosen, _ = chosen_settings(robot, loop, own, {"law": "auto", "epsilon": epsilon})
    f = variant.factor
    assert chosen.G is not None
    assert chosen.Lambda is not None
    assert chosen.L_i is not None
    scaled = {"G": f * chosen.G, "Lambda": f * chosen.Lambda, "L_i": f * f * chosen.L_i}
    return chosen if f == 1.0 else ControllerSettings(**{**vars(chosen), **scaled})


def loop_of(name: str, variant: Variant) -> LoopSettings:
    """The loop of a robot in a variant."""
    return make_loop(load(name), variant.rate, variant.delay, variant.noise)


def job_of(name: str, variant: Variant) -> Job:
    """The campaign of a robot in a variant."""
    robot, loop = load(name), loop_of(name, variant)
    start = variant.start if variant.each is None else (variant.each,) * robot.n
    plan = checked_plan(
        *(robot, loop, 0, KINDS, ("worst",), ("uniform",), (variant.motion,), start)
    )
    return Job(robot, settings_of(name, variant), loop, plan, variant.plant)


def file_of(row: str, variant: Variant, name: str) -> Path:
    """Where the results of a robot in a variant lie."""
    return RESULTS / row / f"{variant.name}_{name.replace(':', '-')}.json"


def measure(row: str, variant: Variant, name: str, draws: int | None) -> list[dict[str, Any]]:
    """The results, from the file or made now."""
    file = file_of(row, variant, name)
    count = variant.draws if draws is None else min(draws, variant.draws)
    found: list[dict[str, Any]] = []
    if file.exists():
        found = json.loads(file.read_text(encoding="utf-8"))
        if len(found) >= count:
            return found
    begin = time.perf_counter()
    if variant.kind == "campaign":
        records: list[Record] = []
        run_all(job_of(name, variant), range(len(found), count), 1, records.append)
        found += [asdict(record) for record in records]
    elif variant.kind == "rest":
        found = [at_rest(name, variant, k) for k in range(count)]
    else:
        found = [of_paper(name, variant, k) for k in range(count)]
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(".part")
    part.write_text(json.dumps(found), encoding="utf-8")
    part.replace(file)
    seconds = time.perf_counter() - begin
    print(f"{row} {variant.name} {name}: {said(variant, found)} [{seconds:.0f} s]", flush=True)
    return found


def said(variant: Variant, found: list[dict[str, Any]]) -> str:
    """The results in a line."""
    if variant.kind != "campaign":
        return "; ".join(", ".join(f"{k} {v:.4g}" for k, v in each.items()) for each in found)
    records = [record_from(each) for each in found]
    worst = max(records, key=lambda r: r.late_error)
    return (
        f"{len(records)} runs, diverged {sum(r.diverged for r in records)}, not good "
        f"{sum(not r.good for r in records)}, meets {sum(r.meets for r in records)}, violated "
        f"{sum(r.violations > 0 for r in records)}, infeasible "
        f"{sum(not r.feasible for r in records)}, worst {worst.late_error:.3g} in run "
        f"{worst.run.index}"
    )


def record_from(values: Mapping[str, Any]) -> Record:
    """A record as it was saved."""
    return Record(**{**values, "run": Run(**values["run"])})


REST, SECONDS = 30.0, 5.0  # [s]


def at_rest(name: str, variant: Variant, index: int) -> dict[str, float]:
    """A motion of 1 s, then 30 s of rest: position error and torque early and late in it."""
    robot, job = load(name), job_of(name, variant)
    run = job.plan.run(index)
    truth = mr.simulation.true_robot(robot, run.parameters, seed=run.seed)
    drawn = draw_motion(robot, truth.parameters, 1.0, run.seed).trajectory
    result = simulated(
        *(robot, job.settings, run.loop(job.loop), truth),
        trajectory=Quintic(drawn.times, drawn.points, 1.0 + REST),
        seed=run.seed,
        initial_error=variant.start,
    )
    t = result.t
    early, end = (t >= 2.0) & (t < 2.0 + SECONDS), t >= 1.0 + REST - SECONDS
    spread = [float(result.tau[part].std(axis=0).max()) for part in (early, end)]
    return {
        "error": float(result.error[t >= 2.0].max()) if not result.diverged else float("inf"),
        "epsilon": job.settings.epsilon,
        "spread_early": spread[0],
        "spread_end": spread[1],
        "speed_end": float(np.abs(result.dq[end]).max()),
    }


def of_paper(name: str, variant: Variant, index: int) -> dict[str, float]:
    """A scenario of the paper: when the error is within epsilon, and the mean of ‖v‖."""
    robot = load(name)
    settings = settings_of(name, variant)
    result = mr.simulate(
        robot, scenario=str(index + 1), loop=loop_of(name, variant), **vars(settings)
    )
    v = np.linalg.norm(result.tau - result.nominal, axis=1)
    late = result.error[result.t >= 1.0]
    entered = result.epsilon_entered_at
    return {
        "scenario": index + 1.0,
        "entered": float("inf") if entered is None else entered,
        "late_error": float(late.max()) if len(late) else float("inf"),
        "epsilon": settings.epsilon,
        "mean_v": float(v.mean()),
        "violations": float(result.statistics.violations if result.statistics else 0),
    }


def simulated(
    robot: Robot,
    settings: ControllerSettings,
    loop: LoopSettings,
    truth: mr.simulation.run.TrueRobot,
    **options: Any,
) -> SimulationResult:
    """A run of the closed loop with settings that are complete."""
    return mr.simulate(
        robot,
        parameters=truth.parameters,
        disturbance=truth.disturbance,
        loop=loop,
        **vars(settings),
        **options,
    )


def tasks(rows: list[str], names: list[str]) -> Iterator[tuple[str, Variant, str]]:
    """What is to be measured, in the order of the rows."""
    for row in rows:
        for name in names:
            if name in ROWS[row].robots:
                for variant in ROWS[row].variants:
                    yield row, variant, name


def work(rows: list[str], names: list[str], draws: int | None) -> None:
    """All tasks of some robots, in this process."""
    warnings.simplefilter("ignore")
    for row, variant, name in tasks(rows, names):
        try:
            measure(row, variant, name, draws)
        except KeyboardInterrupt:
            return
        except Exception as problem:
            print(f"{row} {variant.name} {name}: REFUSED {problem!r}", flush=True)


def show(row: str, label: str, name: str, index: int) -> None:
    """One run once more."""
    variant = next(v for v in ROWS[row].variants if v.name == label)
    job = job_of(name, variant)
    print(job.settings, job.loop, job.record(index), sep="\n")


def main() -> None:
    """Measure what is wanted, then write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS))
    parser.add_argument("--robots", nargs="+", choices=ROBOTS, default=list(ROBOTS))
    parser.add_argument("--draws", type=int, help="runs a robot and variant, at most")
    parser.add_argument("--page", action="store_true", help="write the page")
    parser.add_argument("--show", nargs=4, metavar=("ROW", "VARIANT", "ROBOT", "RUN"))
    given = parser.parse_args()
    if given.show:
        row, label, name, index = given.show
        show(row, label, name, int(index))
        return
    context = multiprocessing.get_context("spawn")
    shares = [given.robots[k::PROCESSES] for k in range(PROCESSES)]
    processes = [
        context.Process(target=work, args=(given.rows, names, given.draws)) for names in shares
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    if given.page:
        from tournament_page import write

        write()


if __name__ == "__main__":
    main()
