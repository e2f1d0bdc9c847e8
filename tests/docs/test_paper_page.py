"""The table of docs/measured/paper.md is what the runs give that it and the README show."""

from __future__ import annotations

import re

from support.pages import DOCS, outputs, page_steps
from support.paths import ROOT

PAGE = DOCS / "measured" / "paper.md"


def test_the_table_of_the_paper_s_robot_is_what_the_runs_give() -> None:
    printed = {step.command: "\n".join(step.shown) for step in page_steps(ROOT / "README.md")}
    for step, (code, output) in zip(page_steps(PAGE), outputs(PAGE), strict=True):
        assert code == 0, output
        printed[step.command.removesuffix(" --bound hull")] = output
    rows = re.findall(r"^\| `(\w+)` \| (\d) \| (.+) \|$", PAGE.read_text(encoding="utf-8"), re.M)
    assert [row[:2] for row in rows] == [(b, s) for s in "12" for b in ("ianea", "hull")]
    for bound, scenario, figures in rows:
        command = f"modrobust simulate lwa4p-paper --scenario {scenario}"
        text = printed[command if bound == "hull" else f"{command} --bound ianea"]
        found = [
            re.search(pattern, text)
            for pattern in (
                r"violations +(\d+) of",
                r"epsilon entered at +permanently after (\S+ s)",
                r"rho mean +(\S+),",
                r"rho max +(\S+)\n",
            )
        ]
        assert [match and match[1] for match in found] == figures.split(" | ")
