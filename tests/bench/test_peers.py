"""Comparisons with other libraries: one robot for both sides; what is said when one is missing.

Pinocchio's headers take minutes to compile; that test runs where MODROBUST_TEST_PEERS is set.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.bench.peers import PEERS, PeerReport, compare_with_peers, native, python_calls
from modrobust.bench.peers import compile as compilation
from modrobust.bench.peers.cases import random_states, uncertain_everywhere
from modrobust.bench.peers.compile import CompilerError, pinocchio_headers, program, toolchain
from modrobust.bench.peers.native import Subject, depth_first, measure, pinocchio_cpp
from modrobust.bench.peers.python_calls import numpy_transcription, pinocchio_python
from modrobust.bench.peers.timing import Comparison, Timing, interleaved
from modrobust.errors import MissingExtraError, ValueRangeError
from modrobust.model import Robot, synthetic_chain
from support.random_robots import random_robot, tied

SHAPES: list[dict[str, Any]] = [
    {"simple": True, "n": 6},
    {"simple": False, "types": "rprp"},
    {"simple": False, "n": 8, "tree": True},
]


@pytest.fixture
def arm() -> Robot:
    return synthetic_chain(3)


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """An empty cache, so that what is tested is compiled now, once for this file."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder


def test_the_job_holds_the_very_doubles_in_the_order_of_the_program() -> None:
    rng = np.random.default_rng(5)
    robot = tied(random_robot(rng, 4, tree=True), 3, rng)
    s = random_states(robot, 2)
    job = list(native._job([robot], s, [Subject("", "command", 0, "ianea")], (7, 2)))
    f, c, d = robot.mimic, robot.controller, robot.disturbance

    def flat(T: Any) -> list[float]:
        return np.ravel([[*t[:3, :3].ravel(), *t[:3, 3]] for t in T]).tolist()

    expected: list[Any] = [
        [robot.n, robot.j, robot.b],
        [kind == "prismatic" for kind in robot.joint_types],
        robot.parents,
        flat(robot.before),
        flat(robot.after),
        robot.gear_ratio,
        robot.coulomb_speed,
        robot.moves,
        f.leaders,
        f.multiplier,
        f.offset,
        robot.body_joints,
        flat(robot.placement),
        robot.framed,
        robot.base[:3, :3].T @ robot.gravity,
        depth_first(robot),
        [1],
        *(x.packed for x in (robot.nominal, robot.lower, robot.upper)),
        d.lo,
        d.hi,
        [*c.K_r, c.kappa_P, c.kappa_I, c.phi_P, c.phi_I, c.epsilon],
        [2],
        *(np.ravel(x) for x in (s.q, s.dq, s.q_des, s.dq_des, s.ddq_des)),
        [1],
        [4, 0, 1],
        [7, 2],
    ]
    read = [[float.fromhex(x) if "x" in x else int(x) for x in line.split()] for line in job]
    assert read == [np.asarray(x).tolist() for x in expected]


def test_states_and_job_are_the_same_for_the_same_seed(arm: Robot) -> None:
    jobs = ["\n".join(native._job([arm], random_states(arm, 5, k), [], (1, 1))) for k in (1, 1, 2)]
    assert jobs[0] == jobs[1] != jobs[2]


def test_states_keep_to_their_ranges() -> None:
    robot = random_robot(np.random.default_rng(0), types="rp", simple=True)
    s = random_states(robot, 500, speed=3.0)
    assert 3.0 < np.abs(s.q[:, 0]).max() <= np.pi
    assert 0.45 < np.abs(s.q[:, 1]).max() <= 0.5
    assert 2.9 < np.abs(s.dq).max() <= 3.0
    assert np.abs(s.q - s.q_des).max() <= 0.02 * (1.0 + 1e-12)


def test_every_body_gets_its_part_of_the_uncertainty(arm: Robot) -> None:
    robot = uncertain_everywhere(arm)
    p, lower, upper = arm.nominal, robot.lower, robot.upper
    np.testing.assert_allclose(upper.mass, 1.05 * p.mass)
    np.testing.assert_allclose(lower.com, p.com - 0.005)
    largest = np.linalg.eigvalsh(p.inertia)[:, -1]
    np.testing.assert_allclose((upper.inertia - p.inertia)[:, 0, 1], 0.1 * largest)
    np.testing.assert_allclose((p.inertia - lower.inertia)[:, 2, 2], 0.1 * largest)


def test_ratios_are_those_of_least_and_of_median_times() -> None:
    ours = Timing("ours", np.array([2.0, 6.0, 9.0]), np.array([[5.0, 1.0], [3.0, 4.0]]))
    theirs = Timing("theirs", np.array([4.0, 4.0, 5.0]))
    figures = Comparison("", (theirs, ours), "theirs").to_dict()
    first, second = figures["subjects"]
    assert (first["ratio_of_minima"], first["ratio_of_medians"], first["alone"]) == (1.0, 1.0, None)
    assert (second["ratio_of_minima"], second["ratio_of_medians"]) == (0.5, 1.5)
    assert second["alone"]["calls"]["max"] == 5.0
    assert second["alone"]["states"]["max"] == 3.0
    json.dumps(figures, allow_nan=False)


def test_rounds_run_every_subject_in_turn_and_the_first_only_warms_up() -> None:
    order: list[str] = []
    found = interleaved({k: partial(order.append, k) for k in "ab"}, calls=1, rounds=2)
    assert order == list("ababab")
    assert [len(item.rounds) for item in found] == [2, 2]


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_joints_are_ordered_depth_first(shape: dict[str, Any]) -> None:
    robot = random_robot(np.random.default_rng(3), **shape)
    order = depth_first(robot)
    assert sorted(order) == list(range(robot.n))
    for k, i in enumerate(order):  # a parent lies on the path that has just been walked
        parent = int(robot.parents[i])
        path = [-1]
        if k:
            path = [order[k - 1]]
            while path[-1] >= 0:
                path.append(int(robot.parents[path[-1]]))
        assert parent in path


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_pinocchio_from_python_has_the_same_robot(shape: dict[str, Any]) -> None:
    pytest.importorskip("pinocchio")
    found = pinocchio_python(random_robot(np.random.default_rng(1), **shape, drives=False), 3)
    assert found.disagreement is not None
    assert found.disagreement < 1e-12
    assert found.ratio_of_minima("command, hull") > 0.0


def test_the_transcription_has_the_same_robot(arm: Robot) -> None:
    found = numpy_transcription(arm, states=2)
    assert found.disagreement is not None
    assert found.disagreement < 1e-12
    assert found.ratio_of_minima("inverse_dynamics") < 1.0


def test_times_of_robots_that_differ_are_not_compared(
    arm: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        python_calls, "inverse_dynamics", lambda *a: mr.inverse_dynamics(*a) * (1.0 + 1e-8)
    )
    with pytest.raises(ValueRangeError, match="differ by 1e-08 of the largest; 1e-09 is allowed"):
        numpy_transcription(arm, states=2)


def test_mimic_joints_are_refused() -> None:
    rng = np.random.default_rng(0)
    with pytest.raises(ValueRangeError, match="2 mimic joints"):
        compare_with_peers(tied(random_robot(rng, 5), 3, rng))


def test_the_program_times_every_kind_of_call_on_any_robot(cache: Path) -> None:
    rng = np.random.default_rng(2)
    robot = tied(random_robot(rng, 4, tree=True), 3, rng)
    kinds = ("sincos", "nominal", "bounds", "command", "batch")
    subjects = [Subject(kind, kind) for kind in kinds]
    inputs = random_states(robot, 20)
    answer = measure([robot], inputs, subjects, flags="shipped", rounds=3, singles=2)
    assert answer.disagreement is None
    assert [item.name for item in answer.timings] == list(kinds)
    for item in answer.timings:
        assert item.rounds.shape == (3,)
        assert 0.0 < item.minimum < 1e-2
        shape = None if item.alone is None else item.alone.shape
        assert shape == (None if item.name == "batch" else (2, 20))
    made = {path: path.stat().st_mtime_ns for path in cache.rglob("*.o")}
    assert made
    program(toolchain(), "shipped", peer=False)
    assert {path: path.stat().st_mtime_ns for path in cache.rglob("*.o")} == made


def test_a_state_that_the_kernel_refuses_ends_the_measurement(arm: Robot, cache: Path) -> None:
    states = random_states(arm, 2)
    states.q[1, 2] = 2e5  # beyond the range of angles
    with pytest.raises(CompilerError, match="the kernel refuses a state"):
        measure([arm], states, [Subject("", "nominal")], flags="shipped", rounds=1)


def test_what_the_compiler_says_is_passed_on(
    arm: Robot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(compilation, "KERNEL", tmp_path)
    monkeypatch.setattr(compilation, "kernel_flags", list)
    (tmp_path / "mr_kernel.h").write_text("#error no kernel here\n")
    with pytest.raises(CompilerError, match=r"failed on program\.o: error: .*no kernel here"):
        measure([arm], random_states(arm, 2), [Subject("", "nominal")], flags="shipped")
    assert not list(tmp_path.rglob("*.o"))


def test_a_missing_compiler_is_named(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXX", "no-such-compiler")
    with pytest.raises(MissingExtraError, match="no compiler no-such-compiler on this machine"):
        toolchain()


def test_missing_headers_are_named_with_the_extra(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    real = Path.is_file
    monkeypatch.setattr(Path, "is_file", lambda p: p.name != "Core" and real(p))
    monkeypatch.setattr("sys.path", [str(tmp_path)])
    wheel = tmp_path / "cmeel.prefix" / "include"
    for header in ("pinocchio/multibody.hpp", "boost/variant.hpp"):
        (wheel / header).parent.mkdir(parents=True)
        (wheel / header).touch()
    message = r'no header Eigen/Core; pip install "modrobust\[peers\]" brings it'
    with pytest.raises(MissingExtraError, match=message):
        pinocchio_headers()


def test_a_report_keeps_what_is_there_and_names_what_is_not(
    arm: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def absent(*arguments: Any, **options: Any) -> Comparison:
        raise MissingExtraError("not here")

    there = Comparison("", (Timing("a", np.ones(2)),), "a")
    monkeypatch.setattr("modrobust.bench.peers.pinocchio_cpp", absent)
    monkeypatch.setattr("modrobust.bench.peers.pinocchio_python", lambda robot: there)
    monkeypatch.setattr("modrobust.bench.peers.numpy_transcription", lambda robot: there)
    report = compare_with_peers(arm).to_dict()
    assert [item["peer"] for item in report["peers"]] == list(PEERS[1:])
    assert report["absent"] == {PEERS[0]: "not here"}


def test_ctrl_c_keeps_what_was_compared(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(robot: Robot) -> Comparison:
        raise KeyboardInterrupt

    there = Comparison("", (Timing("a", np.ones(2)),), "a")
    monkeypatch.setattr("modrobust.bench.peers.pinocchio_cpp", lambda robot, announce: there)
    monkeypatch.setattr("modrobust.bench.peers.pinocchio_python", interrupt)
    report = compare_with_peers(arm)
    assert report.interrupted
    assert list(report.comparisons) == [PEERS[0]]


@pytest.mark.skipif(
    "MODROBUST_TEST_PEERS" not in os.environ,
    reason="compiles Pinocchio's headers for minutes; set MODROBUST_TEST_PEERS",
)
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_pinocchio_in_cpp_has_the_same_robot(shape: dict[str, Any]) -> None:
    robot = random_robot(np.random.default_rng(1), **shape, drives=False)
    found = pinocchio_cpp(robot, states=50)
    assert found.disagreement is not None
    assert found.disagreement < 1e-12


def test_tables_show_times_and_ratios(capsys: pytest.CaptureFixture[str]) -> None:
    from modrobust.cli.bench_peers import print_peers

    ours = Timing("ours", np.array([2e-6, 6e-6]), np.array([[5e-6, 1e-6]]))
    theirs = Timing("theirs", np.array([4e-6, 4e-6]))
    compared = Comparison("in one run", (theirs, ours), "theirs", remarks=("a remark",))
    print_peers(PeerReport("arm", 3, {"them": compared}).to_dict())
    shown = capsys.readouterr().out
    assert "them: in one run" in shown
    assert "Each call by itself (a remark)" in shown
    rows = [line.split() for line in shown.splitlines() if "ours" in line]
    assert rows[0] == ["ours", "2", "us", "4", "us", "0.5", "1"]
    assert rows[1] == ["ours", "3", "us", "2", "us", "5", "us", "5", "us"]
