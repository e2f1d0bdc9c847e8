"""A campaign: the same records whoever does the runs; what is kept of one that ends early."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.campaign import Campaign, Record, campaign
from modrobust.campaign import workers as of_workers
from modrobust.campaign.campaign import chosen_settings
from modrobust.campaign.figures import figures
from modrobust.campaign.motions import LATE
from modrobust.model import LoopSettings, Robot

GAINS: dict[str, Any] = {"law": "sampled", "G": 60.0}
SHORT: dict[str, Any] = {**GAINS, "motions": ["short"], "disturbances": ["worst", "sine"]}


@pytest.fixture(scope="module")
def robot() -> Robot:
    return mr.load_robot("scara")


@pytest.fixture(scope="module")
def loop(robot: Robot) -> LoopSettings:
    return LoopSettings(
        rate=500.0,
        delay=1.0,
        saturation=True,
        noise_position=(1e-4,) * robot.n,
        noise_velocity=(1e-2,) * robot.n,
    )


@pytest.fixture(scope="module")
def alone(robot: Robot, loop: LoopSettings) -> Campaign:
    return campaign(robot, runs=5, jobs=1, loop=loop, **SHORT)


def test_two_processes_leave_the_same_records_as_one(
    robot: Robot, loop: LoopSettings, alone: Campaign
) -> None:
    seen: list[tuple[int, int]] = []
    both = campaign(
        *(robot,), runs=5, jobs=2, loop=loop, progress=lambda k, n: seen.append((k, n)), **SHORT
    )
    assert both.records == alone.records  # bit for bit: floats are compared, none is rounded
    assert [r.run.index for r in both.records] == list(range(5))
    assert seen == [(k, 5) for k in range(6)]


def test_fewer_runs_are_the_first_ones_and_only_is_any_one_of_them(
    robot: Robot, loop: LoopSettings, alone: Campaign
) -> None:
    first = campaign(robot, runs=2, jobs=1, loop=loop, **SHORT)
    single = campaign(robot, only=4, jobs=1, loop=loop, **SHORT)
    assert first.records == alone.records[:2]
    assert single.records == (alone.records[4],)


def test_the_order_of_the_runs_changes_nothing(alone: Campaign) -> None:
    found: list[Record] = []
    of_workers.run_all(alone.job, [3, 0, 4], 1, found.append)
    assert found == [alone.records[k] for k in (3, 0, 4)]


def test_a_run_done_again_has_the_figures_of_its_record(alone: Campaign) -> None:
    result = alone.rerun(2)
    record = alone.records[2]
    assert figures(record.run, result, LATE, record.feasible) == record
    late = result.t >= LATE - 1e-9
    assert record.late_error == float(result.error[late].max())
    limits = result.robot.effort_limits
    assert result.statistics is not None
    assert record.torque_over_limit == float((result.statistics.tau_max / limits).max())
    v = np.abs(result.tau - result.nominal)[6:]
    assert record.v_over_limit == float((v / limits).max())
    tau = result.tau[late]  # 500 Hz: every tick is logged
    steps = np.abs(np.diff(tau, axis=0))
    assert record.step_over_limit == pytest.approx(float((steps.mean(axis=0) / limits).max()))
    whole = 50 * (len(steps) // 50)  # ticks, of tenths of a second
    slow = np.abs(np.diff(tau[: whole + 1 : 50], axis=0)).sum(axis=0)
    ratio = steps[:whole].sum(axis=0) / (slow + 1e-3 * np.abs(tau).max(axis=0))
    assert record.variation_ratio == pytest.approx(float(ratio.max()))


def test_late_ticks_at_a_limit_are_counted(robot: Robot, loop: LoopSettings) -> None:
    weak = replace(robot, effort_limits=0.02 * robot.effort_limits)
    law: dict[str, Any] = {"law": "norm", "hold_aware": True, "motions": ["own"]}
    found = campaign(weak, only=1, jobs=1, loop=loop, **law)
    (record,) = found.records
    result = found.rerun(1)
    late = result.t >= 1.0 - 1e-9
    at_limit = np.any(np.abs(result.tau) >= weak.effort_limits, axis=1)
    assert record.late_at_limit == at_limit[late].mean() > 0.05
    assert not record.good


def test_the_start_is_off_by_what_was_asked_for(robot: Robot, loop: LoopSettings) -> None:
    norm = campaign(robot, only=0, jobs=1, loop=loop, initial_error=0.02, **SHORT).rerun(0)
    assert np.linalg.norm(norm.q_des[0] - norm.q[0]) == pytest.approx(0.02)
    sizes = [0.1, 0.2, 0.01, 0.3][: robot.n]
    each = campaign(robot, only=1, jobs=1, loop=loop, initial_error=sizes, **SHORT).rerun(1)
    assert np.abs(each.q_des[0] - each.q[0]) == pytest.approx(sizes)


def test_what_ctrl_c_leaves_is_the_runs_that_were_done(
    robot: Robot, loop: LoopSettings, alone: Campaign
) -> None:
    def stop(done: int, _: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    for jobs in (1, 2):
        part = campaign(robot, runs=5, jobs=jobs, loop=loop, progress=stop, **SHORT)
        assert part.interrupted
        assert not part.ok
        assert len(part.records) >= 2
        assert all(record == alone.records[record.run.index] for record in part.records)
        assert part.verdict.startswith(f"tried, not proved: {len(part.records)} of 5 runs done; ")


def test_a_run_whose_process_is_killed_is_done_by_another(
    robot: Robot, loop: LoopSettings, alone: Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = of_workers._asked
    killed: list[int] = []

    def kill_once(process: subprocess.Popen[bytes], index: int) -> tuple[str, Any]:
        if index == 1 and not killed:
            killed.append(index)
            os.kill(process.pid, signal.SIGKILL)
        return asked(process, index)

    monkeypatch.setattr(of_workers, "_asked", kill_once)
    found = campaign(robot, runs=3, jobs=2, loop=loop, **SHORT)
    assert killed == [1]
    assert found.records == alone.records[:3]


def test_a_run_that_ends_its_process_twice_is_named(
    robot: Robot, loop: LoopSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of_workers, "_PROGRAM", "raise SystemExit(7)")
    with pytest.raises(
        mr.ModrobustError, match=r"run \d: its process ended twice, with exit code 7"
    ):
        campaign(robot, runs=2, jobs=2, loop=loop, **SHORT)


def test_what_refuses_a_run_in_a_process_is_raised_here(
    robot: Robot, loop: LoopSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = (
        "from modrobust.campaign import job, workers\n"
        "from modrobust.errors import DescriptionError\n"
        "def refuse(*_):\n    raise DescriptionError('arm.yaml', 3, 'loop', 'is wrong')\n"
        "job.Job.record = refuse\nworkers.serve()"
    )
    monkeypatch.setattr(of_workers, "_PROGRAM", program)
    with pytest.raises((mr.DescriptionError, RuntimeError), match="is wrong"):
        campaign(robot, runs=2, jobs=2, loop=loop, **SHORT)


def test_a_script_without_a_guard_has_workers(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import modrobust as mr\nfrom modrobust.campaign import campaign\n"
        "print('begun')\n"
        "c = campaign(mr.load_robot('scara'), runs=2, jobs=2, law='sampled', G=60.0,\n"
        "             motions=['short'])\n"
        "print(len(c.records))\n",
        encoding="utf-8",
    )
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.stdout, done.stderr) == ("begun\n2\n", "")


def test_figures_are_judged_as_the_words_say(alone: Campaign) -> None:
    good = alone.records[0]
    assert good.good
    assert not replace(good, diverged=True).good
    assert not replace(good, late_error=0.3).good
    assert replace(good, late_error=0.29).good
    assert not replace(good, late_at_limit=0.051).good
    assert replace(good, late_error=0.9 * good.epsilon).meets
    assert not replace(good, late_error=good.epsilon).meets
    assert not replace(good, late_error=0.001, violations=1).ok


def test_the_summary_has_the_worst_case_of_each_figure_and_its_run(alone: Campaign) -> None:
    summary = alone.summary()
    errors = [r.late_error for r in alone.records]
    worst = summary["worst"]["late_error"]
    assert worst["worst"] == max(errors)
    assert worst["run"] == errors.index(max(errors))
    assert worst["command"] == f"campaign.rerun({worst['run']})"
    assert summary["worst"]["diverged"] == {"worst": 0, "run": None, "command": None}
    assert summary["runs"] == summary["wanted"] == 5
    assert len(summary["records"]) == 5
    assert summary["verdict"].startswith("tried, not proved: ")


def test_runs_that_diverge_count_under_that_alone(alone: Campaign) -> None:
    gone = replace(alone.records[1], diverged=True, late_error=math.inf, torque_over_limit=99.0)
    records = (alone.records[0], gone)
    broken = Campaign(alone.job, (0, 1), records, False)
    summary = broken.summary()
    assert summary["worst"]["diverged"]["worst"] == 1
    assert summary["worst"]["diverged"]["run"] == 1
    assert summary["worst"]["torque_over_limit"]["worst"] < 99.0
    assert summary["records"][1]["late_error"] is None
    assert broken.verdict == "tried, not proved: of 2 runs, 1 diverged"
    assert not broken.ok


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"runs": 0}, "runs: 0; must be at least 1"),
        ({"jobs": 0}, "jobs: 0; must be at least 1"),
        ({"seed": -1}, "seed: -1; must be at least 0"),
        ({"only": -1}, "only: -1; must be at least 0"),
        ({"motions": []}, "motions: none given; give one or more of own, short, long"),
        ({"motions": ["shrot"]}, 'motions: no kind "shrot"; did you mean "short"?'),
        ({"parameters": ["upper", "edge"]}, 'parameters: no kind "edge"'),
        ({"disturbances": "gusts"}, 'disturbances: no kind "gusts"'),
        ({"initial_error": -0.1}, "initial_error: -0.1; must be finite and not negative"),
        ({"initial_error": [0.1]}, "initial_error: expected a norm or shape"),
        ({"plant": "gazebo"}, 'plant: no plant "gazebo"'),
        ({"rate": 0.0}, "rate: 0 Hz"),
    ],
)
def test_what_is_wrong_is_refused_before_a_run(
    robot: Robot, arguments: dict[str, Any], message: str
) -> None:
    with pytest.raises(mr.InputError) as refusal:
        campaign(robot, **{**GAINS, **arguments})
    assert message in str(refusal.value)


def test_parts_of_the_law_that_are_left_out_stay_out_beside_auto(
    robot: Robot, loop: LoopSettings
) -> None:
    for own in (True, False):
        settings, _ = chosen_settings(robot, loop, own, {"law": "auto", "integral": False})
        assert settings.law == "sampled"
        assert not settings.integral
        assert settings.predictor
