"""Writes docs/measured/tournament.md from the results of the tournament.

    python benchmarks/tournament_page.py

The results lie in build/tournament, made by benchmarks/tournament.py.
"""

from __future__ import annotations

import datetime
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from common import markdown, processor
from population import BUILTIN, NOISE, ROBOTS, TOLERANCE, URDF
from tournament import DRAWS, LAWS, LOOPS, ROOT, ROWS, Variant, file_of, record_from

from modrobust.campaign import Record

PAGE = ROOT / "docs" / "measured" / "tournament.md"


@dataclass(frozen=True)
class Line:
    """A line of the main table."""

    figure: str
    target: str
    reached: str
    tried: str


def results(row: str, variant: Variant, names: Iterable[str]) -> dict[str, list[Any]]:
    """What has been measured, by robot."""
    found = {}
    for name in names:
        file = file_of(row, variant, name)
        if file.exists():
            found[name] = json.loads(file.read_text(encoding="utf-8"))
    return found


def records(
    row: str, choose: Callable[[Variant], bool] = lambda _: True, names: Sequence[str] | None = None
) -> dict[str, list[Record]]:
    """The records of a row's variants that are chosen, by robot."""
    found: dict[str, list[Record]] = {}
    for variant in ROWS[row].variants:
        if choose(variant):
            for name, values in results(row, variant, names or ROWS[row].robots).items():
                found.setdefault(name, []).extend(record_from(each) for each in values)
    return found


def flat(by_robot: Mapping[str, list[Record]]) -> list[Record]:
    """All records."""
    return [record for found in by_robot.values() for record in found]


def share(count: int, whole: int) -> str:
    """A percentage."""
    return f"{100.0 * count / whole:.3g} %" if whole else "-"


def bad(found: Sequence[Record]) -> str:
    """How many diverged and how many were not good."""
    return (
        f"{sum(r.diverged for r in found)} diverged, {sum(not r.good for r in found)} not good in "
        "all"
    )


def where_bad(row: str) -> str:
    """Robots and loops of a row in which a run was not good."""
    listed = []
    for variant in ROWS[row].variants:
        for name, values in results(row, variant, ROWS[row].robots).items():
            count = sum(not record_from(each).good for each in values)
            if count:
                loop = f"{variant.rate:g} Hz, delay {variant.delay:g}"
                noise = "noise" if variant.noise else "no noise"
                listed.append(f"{name} at {loop}, {noise}: {count} of {len(values)}")
    return f" ({'; '.join(listed)})" if listed else ""


def meets(found: Sequence[Record]) -> str:
    """How many met epsilon."""
    return share(sum(r.meets for r in found), len(found))


def tried(by_robot: Mapping[str, list[Record]]) -> str:
    """How many runs of how many robots."""
    return f"{len(flat(by_robot))} runs, {len(by_robot)} robots"


def below(by_robot: Mapping[str, list[Record]], least: float = 0.8) -> str:
    """Robots of which less than `least` met epsilon."""
    parts = {name: sum(r.meets for r in found) / len(found) for name, found in by_robot.items()}
    listed = [f"{name} {100 * part:.0f} %" for name, part in parts.items() if part < least]
    return f"; below {100 * least:.0f} %: {', '.join(listed)}" if listed else ""


def main_lines() -> list[Line]:
    """The lines of the main table."""
    own, plain, wide = (records(row) for row in ("own", "plain", "wide"))
    every = records("stability")
    for part in (own, plain):
        for name, found in part.items():
            every.setdefault(name, []).extend(found)
    factor = records("factor")
    small = records("starts", lambda v: v.each is None)
    large = records("starts", lambda v: v.each is not None)
    still = [r.variation_ratio for r in flat(plain) if r.variation_ratio is not None and r.feasible]
    steps = [
        [r.step_over_limit for r in flat(part) if r.step_over_limit and not r.diverged]
        for part in (wide, own)
    ]
    lines = [
        Line(
            "every rate, delay 0 and 1, noise and none",
            "0 diverge, 0 limit cycles",
            bad(flat(every)) + where_bad("stability"),
            tried(every),
        ),
        Line(
            "1 kHz, delay 1, noise, own epsilon",
            "at least 92 % meet; all robots but iiwa at least 80 %",
            meets(flat(own)) + below(own),
            tried(own),
        ),
        Line("1 kHz, neither", "100 % meet", meets(flat(plain)) + below(plain, 1.0), tried(plain)),
        Line(
            "epsilon 0.03, delay 1, noise",
            "100 %",
            meets(flat(wide)) + below(wide, 1.0),
            tried(wide),
        ),
        Line(
            "gains times 1.75, built-in",
            "0 bad",
            bad(flat(factor)) + where_bad("factor"),
            tried(factor),
        ),
        Line(
            "start 0.02 off (norm)",
            "100 % good",
            share(sum(r.good for r in flat(small)), len(flat(small))),
            tried(small),
        ),
        Line(
            "start 0.3 off on every joint",
            "95 % good",
            share(sum(r.good for r in flat(large)), len(flat(large))) + where_bad("starts"),
            tried(large),
        ),
        Line(
            "no noise, no delay: torque variation against that at 10 Hz",
            "median at most 1.3",
            f"median {np.median(still):.3g}" if still else "-",
            tried(plain),
        ),
        Line(
            "noise, delay 1: mean torque step a tick over the limit, largest joint",
            "median at most 5 % at epsilon 0.03, 7 % at own; largest 19 %",
            "; ".join(
                f"{label} median {100 * np.median(found):.3g} %, largest {100 * max(found):.3g} %"
                for label, found in zip(("epsilon 0.03", "own epsilon"), steps, strict=True)
                if found
            )
            or "-",
            tried(wide),
        ),
        rest_line(),
        *paper_lines(),
        *[
            Line(title, target, f"{bad(flat(part))}; {meets(flat(part))} meet", tried(part))
            for title, target, part in (
                ("motions of 10 s, delay 1, noise", "-", records("long")),
                ("the files' own motions, delay 1, noise", "-", records("files")),
                ("MuJoCo, delay 1, noise", "as the built-in plant", records("mujoco")),
            )
        ],
    ]
    return [line for line in lines if not line.tried.startswith("0 ")]


def rest_line() -> Line:
    """30 s at rest after a motion."""
    variant = ROWS["rest"].variants[0]
    found = results("rest", variant, ROWS["rest"].robots)
    every = [each for values in found.values() for each in values]
    outside = {
        name
        for name, values in found.items()
        for each in values
        if not each["error"] < each["epsilon"]
    }
    growth = {
        name
        for name, values in found.items()
        for each in values
        if not each["spread_end"] <= 1.2 * each["spread_early"] + 1e-9
    }
    said = [f"{len(every) - sum(len(found[n]) for n in outside)} of {len(every)} inside epsilon"]
    said += [f"outside: {', '.join(sorted(outside))}"] if outside else []
    said += [f"torque grows: {', '.join(sorted(growth))}"] if growth else ["no torque grows"]
    return Line(
        "30 s at rest after the motion, friction and noise on",
        "inside epsilon, torque does not grow",
        "; ".join(said),
        f"{len(every)} runs, {len(found)} robots",
    )


def paper_lines() -> list[Line]:
    """The paper's robot in both scenarios."""
    lines = []
    found = {
        variant: results("paper", variant, ("lwa4p-paper",)).get("lwa4p-paper", [])
        for variant in ROWS["paper"].variants
    }
    other = [each["mean_v"] for v, values in found.items() if v.law == "norm" for each in values]
    for variant, values in found.items():
        if variant.law != "auto" or not values:
            continue
        inside = all(each["late_error"] < each["epsilon"] for each in values)
        norms = ", ".join(
            f"{each['mean_v']:.3g} against {old:.3g}"
            for each, old in zip(values, other, strict=False)
        )
        lines.append(
            Line(
                f"paper's robot, both scenarios, 1 kHz, delay {variant.delay:g}",
                "epsilon from 1 s on, less mean ‖v‖ than the paper's law at 50 kHz",
                f"{'inside' if inside else 'outside'}, largest late error "
                f"{max(each['late_error'] for each in values):.2e}; mean ‖v‖ {norms} N m",
                f"{len(values)} runs",
            )
        )
    return lines


def law_rows() -> list[list[str]]:
    """Other laws beside the automatic one, with the files' old gains."""
    rows = []
    for delay, noise in (LOOPS[0], LOOPS[3]):
        loop = f"delay {delay:g}, {'noise' if noise else 'no noise'}"
        beside = set(records("laws", partial(_is, delay=delay, law=LAWS[0])))
        auto = records("own" if noise else "plain")
        parts = {"sampled (auto)": {name: auto[name] for name in auto if name in beside}}
        for law in LAWS:
            parts[law] = records("laws", partial(_is, delay=delay, law=law))
        for law, whole in parts.items():
            by_robot = {name: found for name, found in whole.items() if name in beside}
            found = flat(by_robot)
            if not found:
                continue
            errors = [1e3 * r.late_error for r in found if not r.diverged]
            v = [r.v_over_limit for r in found if r.v_over_limit and not r.diverged]
            rows.append(
                [
                    *(loop, law, share(sum(r.good for r in found), len(found)), meets(found)),
                    f"{np.median(errors):.3g} / {np.quantile(errors, 0.95):.3g}" if errors else "-",
                    f"{np.median(v):.2g}" if v else "-",
                    tried(by_robot),
                ]
            )
    return rows


def _is(variant: Variant, delay: float, law: str) -> bool:
    return variant.delay == delay and variant.law == law


def robot_rows() -> list[list[str]]:
    """Each robot in the main row."""
    rows = []
    for name, found in records("own").items():
        errors = sorted(1e3 * r.late_error for r in found)
        steps = [r.step_over_limit for r in found if r.step_over_limit]
        rows.append(
            [
                name,
                str(len(found)),
                share(sum(r.good for r in found), len(found)),
                meets(found),
                f"{found[0].epsilon * 1e3:g}",
                f"{np.median(errors):.3g}",
                f"{errors[-1]:.3g}",
                f"{100 * float(np.median(steps)):.2g} %" if steps else "-",
                str(sum(not r.feasible for r in found)),
            ]
        )
    return rows


_LAWS_HEAD = (
    *("loop", "law", "good", "meets", "error, median / 95 % [mrad]", "v over limit, median"),
    "tried",
)


def write() -> None:
    """Write the page."""
    head = ("figure", "target", "reached", "tried")
    lines = [(line.figure, line.target, line.reached, line.tried) for line in main_lines()]
    urdfs = ", ".join(f"{name} {entry[1]:g} kg" for name, entry in URDF.items())
    by_robot = (
        *("robot", "runs", "good", "meets", "epsilon [mrad]", "error, median [mrad]"),
        *("largest [mrad]", "torque step, median", "without limits"),
    )
    PAGE.write_text(
        f"""# The tournament of laws

Made by `make tournament`, not by hand: {datetime.date.today():%d %B %Y}, {processor()}.

What is here was tried, not proved. Every run is a closed loop whose command is held for a period,
and whose true robot lies in the box that the controller knows.

Robots: the {len(BUILTIN)} built-in ones, and eight URDFs of example-robot-data with {TOLERANCE} and
a payload from 0 kg to its rating ({urdfs}). They have no drives in their files, so that a light
wrist is as light as its link. Draws: the lower and the upper end of the box, then corners and
random points in turn. Motions, unless said: rest to rest in 1 s, at half of the speed limits and at
most 1.5 rad/s, then 0.25 s of rest, drawn until 80 % of the torque limits suffice. Where no draw
did (column "without limits", the gripper joint of TALOS, whose friction is as large as its limit),
the run was done without torque limits. The drive cuts at the limits, the disturbance pushes away at
the worst end of its bounds, the start is 5 mrad off in norm. Noise is ±{NOISE[0]:g} rad (m) and
±{NOISE[1]:g} rad/s (m/s), uniform. The gains are those of the law `auto` for any motion within the
limits, of the paper's robot and of the files' own motions for that motion.

*Late* is from 0.45 s on (motions of 1 s) or 1 s on (others). *Good*: did not diverge, late error
below 0.3, at most 5 % of late ticks at a limit. *Meets*: good, and the late error, a norm over all
joints, below epsilon. Rows without a rate are at 1 kHz.

The last column says how far a row has come; a whole one is {len(ROBOTS)} robots (built-in:
{len(BUILTIN)}) with {DRAWS} draws each. In a row with few draws the two ends of the box weigh more.

Where a light wrist without a drive carries up to its rated payload, at 250 Hz and a period late, a
run that was not good had no limit cycle: the wrist sags when the run begins, by a radian or more,
and sigma of (33) takes it up slowly: in a motion of 10 s the errors of UR10 and Kinova fell below
0.1. Light and heavy robots differ there by 1:85 and 1:47 in inertia.

{markdown(head, lines)}

## Robot by robot

At 1 kHz, delay 1, noise, the file's own epsilon; of a run the largest late error counts.

{markdown(by_robot, robot_rows())}

## Other laws

With the gains that the files had before gains were chosen (`benchmarks/population.py` lists them; a
URDF had the paper's). Hold-aware laws take the same gains. Only robots that have been tried with
`norm` are counted. The robust input of ARMOUR is not in this table: computed in Python it takes too
long. Errors are of runs that did not diverge; v is the largest robust torque of a run over the
limit.

{markdown(_LAWS_HEAD, law_rows())}
""",
        encoding="utf-8",
    )


if __name__ == "__main__":
    write()
