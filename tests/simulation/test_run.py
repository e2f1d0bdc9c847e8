"""The closed loop: the paper's two scenarios, the true robot, bad endings, what is kept."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.checks.types import Array
from modrobust.errors import FileError, InputError, ShapeError, ValueRangeError
from modrobust.model import Bounded, Robot, synthetic_chain
from modrobust.motion import Quintic, Splined
from modrobust.simulation import SimulationResult, simulate, true_robot
from modrobust.simulation.metrics import chattering
from modrobust.simulation.result import LOGGED, check_writable
from modrobust.simulation.run import MAX_TICKS, _tick_count

CASES = [(scenario, bound) for scenario in ("1", "2") for bound in ("ianea", "hull")]
REST = Quintic(np.array([0.0]), np.zeros((1, 2)))


@pytest.fixture(scope="module")
def paper() -> Robot:
    return mr.load_robot("lwa4p-paper")


@pytest.fixture(scope="module")
def runs(paper: Robot) -> dict[tuple[str, str], SimulationResult]:
    """Ten seconds of both scenarios of Table II with both bounds; the loop releases the GIL."""

    def run(case: tuple[str, str]) -> SimulationResult:
        return simulate(paper, scenario=case[0], bound=case[1])

    with ThreadPoolExecutor(2) as pool:
        return dict(zip(CASES, pool.map(run, CASES), strict=True))


@pytest.fixture(scope="module")
def arm() -> Robot:
    """Two joints, disturbed and limited; quick to simulate."""
    d = np.array([0.02, 0.01])
    return replace(
        synthetic_chain(2, uncertainty=0.1),
        position_limits=np.array([[-2.0, 2.0], [-1.0, 1.0]]),
        velocity_limits=np.array([2.0, 2.0]),
        effort_limits=np.array([10.0, np.inf]),
        disturbance=Bounded(np.zeros(2), -d, d),
    )


def short(robot: Robot, **options: Any) -> SimulationResult:
    return simulate(robot, **{"duration": 0.2, "rate": 10e3, **options})


@pytest.mark.parametrize("case", CASES)
def test_the_papers_scenarios_keep_the_bound_and_reach_epsilon_permanently(
    runs: dict[tuple[str, str], SimulationResult], case: tuple[str, str]
) -> None:
    run = runs[case]
    summary = run.summary()
    assert summary["violations"] == 0
    assert summary["ticks"] == 500_001
    assert not summary["diverged"]
    assert 0.0 < summary["epsilon_entered_at"] < 9.0
    assert summary["error_final"] < 0.01
    assert summary["error_max_after_entry"] < 0.01
    assert run.ok
    assert run.reasons == []
    after = run.t >= summary["epsilon_entered_at"]
    assert (run.error[after] < 0.01).all()
    assert run.error[0] == pytest.approx(0.02 * np.sqrt(6.0))
    # The logged bounds hold at every logged tick, to the last bit.
    assert (run.w >= run.phi_lo).all()
    assert (run.w <= run.phi_hi).all()
    assert np.abs(run.w).max() > 1.0  # [N m]: the perturbation is there to be bounded


@pytest.mark.parametrize("case", CASES)
def test_the_papers_scenarios_do_not_chatter(
    runs: dict[tuple[str, str], SimulationResult], case: tuple[str, str]
) -> None:
    ratios = runs[case].summary()["chattering"]
    assert len(ratios) == 6
    assert min(ratios) >= 1.0
    assert max(ratios) < 1.1


@pytest.mark.parametrize("scenario", ["1", "2"])
def test_the_hull_lies_inside_ianea_and_asks_for_less(
    runs: dict[tuple[str, str], SimulationResult], scenario: str
) -> None:
    hull, ianea = runs[scenario, "hull"], runs[scenario, "ianea"]
    for run in (hull, ianea):
        assert (run.width_hull <= run.width_ianea * (1.0 + 1e-9)).all()
    np.testing.assert_allclose(hull.phi_hi - hull.phi_lo, hull.width_hull, rtol=1e-12)
    np.testing.assert_allclose(ianea.phi_hi - ianea.phi_lo, ianea.width_ianea, rtol=1e-12)
    assert hull.summary()["rho_mean"] < 0.85 * ianea.summary()["rho_mean"]
    assert hull.summary()["ianea_over_hull"][0] > 3.0


def test_every_key_of_the_interface_is_in_the_summary_and_it_is_json(
    runs: dict[tuple[str, str], SimulationResult],
) -> None:
    summary = runs["1", "hull"].summary()
    assert json.loads(json.dumps(summary, allow_nan=False)) == summary
    for key in (
        *("violations", "diverged", "epsilon_entered_at", "error_final", "error_max_after_entry"),
        *("tau_max", "tau_limit", "rho_mean", "rho_max", "width_hull", "width_ianea"),
        *("command_time", "settings"),
    ):
        assert key in summary
    assert set(summary["command_time"]) >= {"mean", "max", "std", "p50", "p99"}
    assert 0.0 < summary["command_time"]["p50"] <= summary["command_time"]["p99"] < 0.1
    assert summary["tau_limit"] == [None] * 6
    assert summary["settings"]["scenario"] == "1"
    assert summary["settings"]["K_r"] == [10.0] * 6
    assert summary["settings"]["loop"]["rate"] == 50e3


def test_the_log_is_a_millisecond_grid_of_the_papers_motion(
    runs: dict[tuple[str, str], SimulationResult],
) -> None:
    run = runs["1", "hull"]
    np.testing.assert_allclose(run.t, np.arange(10_001) * 1e-3, atol=1e-12)
    amplitude = np.pi / np.array([2.0, -4.0, 6.0, -6.0, 4.0, -2.0])
    product = np.sin(np.pi * run.t / 5.0) * np.sin(np.pi * run.t / 2.0)
    np.testing.assert_allclose(run.q_des, np.outer(product, amplitude), atol=1e-12)
    for name in LOGGED[1:]:
        assert getattr(run, name).shape == (10_001, 6)


def test_the_logged_perturbation_is_equation_6(
    paper: Robot, runs: dict[tuple[str, str], SimulationResult]
) -> None:
    run = runs["2", "hull"]
    K_r = np.array(run.controller.K_r)
    for k in (0, 1234, 9999):
        q, dq = run.q[k], run.dq[k]
        dq_a = run.dq_des[k] + K_r * (run.q_des[k] - q)
        ddq_a = run.ddq_des[k] + K_r * (run.dq_des[k] - dq)
        true = mr.inverse_dynamics(paper, q, dq, dq_a, ddq_a, paper.scenarios["2"])
        nominal = mr.inverse_dynamics(paper, q, dq, dq_a, ddq_a)
        np.testing.assert_allclose(run.w[k], true - nominal, atol=1e-11)


def test_the_plant_obeys_its_equation_of_motion(arm: Robot) -> None:
    # Ten times finer integration of the same held commands gives the same motion.
    coarse = short(arm, parameters="corner", seed=4)
    fine = short(arm, parameters="corner", seed=4, substeps=10)
    np.testing.assert_allclose(coarse.q, fine.q, atol=1e-9)
    # A central difference of the logged velocity is the forward dynamics at the logged torque.
    run = short(arm, parameters="corner", seed=4, rate=1e3, duration=0.02, K_r=1.0)
    d = np.array(run.settings["disturbance"])
    for k in range(5, 8):
        ddq = mr.forward_dynamics(
            arm, run.q[k], run.dq[k], run.tau[k] + d, parameters=run.parameters
        )
        assert np.abs(ddq).max() > 0.1
        np.testing.assert_allclose((run.dq[k + 1] - run.dq[k]) / 1e-3, ddq, rtol=0.1, atol=0.05)


def test_true_parameters_outside_the_bounds_are_found_out(paper: Robot) -> None:
    heavy = replace(paper.upper, mass=paper.upper.mass + np.array([0, 0, 0, 0, 0, 2.0]))
    run = simulate(paper, parameters=heavy, duration=0.2)
    assert not run.settings["parameters_inside_bounds"]
    assert run.summary()["violations"] > 1000
    assert run.summary()["violation_max"] > 1.0  # [N m]
    assert not run.ok
    assert "the bound was violated at" in run.reasons[0]


def test_a_disturbance_outside_its_bounds_is_found_out(arm: Robot) -> None:
    inside = short(arm, parameters="nominal", disturbance=[0.02, -0.01])
    assert inside.settings["parameters_inside_bounds"]
    assert inside.summary()["violations"] == 0
    outside = short(arm, parameters="nominal", disturbance=[5.0, 0.0])
    assert not outside.settings["parameters_inside_bounds"]
    assert outside.summary()["violations"] > 0


@pytest.mark.parametrize("plant", ["builtin", "mujoco"])
def test_a_violation_is_found_out_beyond_the_rounding_of_the_torque(arm: Robot, plant: str) -> None:
    end = arm.disturbance.hi[0]
    for beyond, found in ((0.0, False), (1e-11, True)):  # [N m]
        run = short(arm, parameters="nominal", disturbance=[end + beyond, 0.0], plant=plant)
        assert np.abs(run.tau).max() > 0.5  # [N m]
        assert (run.summary()["violations"] > 0) is found


def test_a_low_control_rate_diverges_and_says_so(paper: Robot) -> None:
    run = simulate(paper, scenario="2", rate=1e3)
    assert run.diverged
    assert not run.ok
    summary = run.summary()
    assert summary["diverged"]
    assert summary["epsilon_entered_at"] is None
    assert summary["error_max_after_entry"] is None
    assert "the loop diverged at" in summary["reasons"][0]
    assert 0 < len(run.t) < 100  # within 15 ms, and what came before is kept
    json.dumps(summary, allow_nan=False)


def test_not_reaching_epsilon_is_a_reason(arm: Robot) -> None:
    run = short(arm, duration=0.01, q0=[0.5, 0.5], trajectory=REST)
    assert run.epsilon_entered_at is None
    assert run.reasons == [
        f"the tracking error did not stay below epsilon = 0.01: {run.error[-1]:.3g} at the end"
    ]


def test_the_length_of_a_run_does_not_change_its_motion(arm: Robot) -> None:
    """Half a second of the default motion is its first part, not all of it in a hurry."""
    part, longer = (short(arm, duration=d, rate=2e3) for d in (0.25, 0.5))
    assert part.settings["motion_time"] == longer.settings["motion_time"] == 10.0
    k = len(part.t)
    np.testing.assert_array_equal(part.q_des, longer.q_des[:k])
    np.testing.assert_array_equal(part.tau, longer.tau[:k])
    assert np.abs(part.dq_des).max() < 0.5  # [rad/s]


def test_a_run_that_is_cut_short_is_not_judged_on_epsilon(arm: Robot) -> None:
    motion = Quintic(np.array([0.0, 0.3]), np.zeros((2, 2)))
    options: dict[str, Any] = {"q0": [0.5, 0.5], "trajectory": motion, "rate": 2e3}
    cut = short(arm, duration=0.01, **options)
    assert (cut.cut_short, cut.summary()["cut_short"]) == (True, True)
    assert cut.epsilon_entered_at is None
    assert cut.reasons == []
    assert cut.ok
    weak = replace(arm, effort_limits=np.full(2, 1e-6))
    assert all("needed" in reason for reason in short(weak, duration=0.01, **options).reasons)
    whole = short(arm, duration=0.3, **options)
    assert not whole.cut_short
    assert (whole.epsilon_entered_at is None) == (len(whole.reasons) > 0)


@pytest.mark.parametrize("kind", [Quintic, Splined])
def test_beyond_the_end_of_a_motion_the_last_pose_is_held(arm: Robot, kind: Any) -> None:
    motion = kind(np.array([0.0, 0.05, 0.1]), np.array([[0.0, 0.0], [0.02, 0.0], [0.02, 0.01]]))
    run = short(arm, trajectory=motion)
    assert not run.cut_short
    after = run.t > 0.1 + 1e-9
    assert after.any()
    assert (run.q_des[after] == [0.02, 0.01]).all()
    assert not run.dq_des[after].any()
    assert not run.ddq_des[after].any()
    told = [remark for remark in run.remarks if "under way at its last row" in remark]
    assert len(told) == (kind is Splined)
    assert short(arm, trajectory=motion, duration=0.1).remarks == []


def test_progress_is_told_before_the_first_command(arm: Robot) -> None:
    calls: list[tuple[float, float]] = []
    short(arm, progress=lambda done, total: calls.append((done, total)))
    assert calls[0] == (0.0, 0.2)
    assert calls[-1] == (0.2, 0.2)


def test_a_torque_beyond_its_limit_is_a_reason(arm: Robot) -> None:
    weak = replace(arm, effort_limits=np.array([np.inf, 1e-3]))
    run = short(weak)
    assert run.summary()["tau_limit"] == [None, 1e-3]
    assert any('joint "link2.axis" needed' in reason for reason in run.reasons)
    assert any("beyond its limit of 0.001 N m" in reason for reason in run.reasons)


def test_epsilon_is_entered_at_the_tick_after_the_last_one_outside(arm: Robot) -> None:
    run = short(arm, q0=[0.02, 0.0], trajectory=REST, duration=1.0, rate=1e3)
    outside = np.flatnonzero(run.error >= 0.01)
    assert len(outside)
    assert run.epsilon_entered_at == pytest.approx(run.t[outside[-1] + 1])
    assert run.summary()["error_max_after_entry"] == run.error[outside[-1] + 1 :].max()
    assert short(arm, trajectory=REST).epsilon_entered_at == 0.0


def test_ctrl_c_keeps_what_was_computed(arm: Robot) -> None:
    whole = short(arm, seed=3)

    def interrupt(t: float, end: float) -> None:
        assert end == 0.2
        if t > 0.05:
            raise KeyboardInterrupt

    run = short(arm, seed=3, progress=interrupt)
    assert run.interrupted
    assert not run.ok
    kept = len(run.t)
    assert 50 < kept < len(whole.t)
    np.testing.assert_array_equal(run.tau, whole.tau[:kept])
    assert run.reasons[0].startswith("interrupted at 0.")
    assert run.summary()["interrupted"]
    assert run.statistics is not None
    assert run.statistics.tau_max[0] >= np.abs(run.tau[:, 0]).max()


def test_ctrl_c_before_the_first_chunk_still_gives_a_result(
    arm: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted(Quintic):
        def sample(self, t: Any) -> Any:
            if len(np.atleast_1d(t)) == 10:  # the first chunk, after the checks
                raise KeyboardInterrupt
            return super().sample(t)

    run = short(arm, trajectory=Interrupted(REST.times, REST.points))
    assert run.interrupted
    assert len(run.t) == 0
    assert json.dumps(run.summary(), allow_nan=False)
    assert run.reasons == ["interrupted at 0 s of 0.2 s"]
    run.save(tmp_path / "empty.npz")


def test_chunks_do_not_change_the_result(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = short(arm, seed=2)
    monkeypatch.setattr("modrobust.simulation.run._CHUNK_SECONDS", 1e-9)
    pieces = short(arm, seed=2)
    for name in LOGGED:
        np.testing.assert_array_equal(getattr(whole, name), getattr(pieces, name))
    assert whole.statistics is not None
    assert pieces.statistics is not None
    assert whole.statistics.rho_sum == pieces.statistics.rho_sum


def test_a_seed_repeats_a_run_and_another_changes_it(arm: Robot) -> None:
    one, same, other = (short(arm, seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.tau, same.tau)
    assert np.abs(one.w - other.w).max() > 1e-6
    assert one.settings["parameters"] == "random"
    assert one.settings["disturbance"] != other.settings["disturbance"]


@pytest.mark.parametrize("choice", ["nominal", "lower", "upper", "corner", "random"])
def test_every_choice_of_true_parameters_lies_inside_the_bounds(arm: Robot, choice: str) -> None:
    truth = true_robot(arm, choice, seed=5)
    assert truth.inside
    run = short(arm, parameters=choice, seed=5)
    assert run.summary()["violations"] == 0
    assert run.settings["parameters_inside_bounds"]
    if choice == "nominal":
        assert np.abs(run.w).max() < 1e-10
    else:
        assert np.abs(run.w).max() > 1e-3


def test_lower_and_upper_are_the_ends_of_the_box(arm: Robot) -> None:
    np.testing.assert_array_equal(true_robot(arm, "lower").parameters.mass, arm.lower.mass)
    np.testing.assert_array_equal(true_robot(arm, "upper").parameters.com, arm.upper.com)
    np.testing.assert_array_equal(true_robot(arm, "lower").disturbance, arm.disturbance.lo)
    np.testing.assert_array_equal(true_robot(arm, "upper").disturbance, arm.disturbance.hi)
    corner = true_robot(arm, "corner", seed=1).disturbance
    assert all(x in ends for x, ends in zip(corner, [(-0.02, 0.02), (-0.01, 0.01)], strict=True))


def test_a_tensor_pulled_to_physical_is_reported(arm: Robot) -> None:
    # The upper end of xx alone breaks the triangle inequality.
    wide = arm.upper.inertia.copy()
    wide[1, 0, 0] = 0.1
    robot = replace(arm, upper=replace(arm.upper, inertia=wide))
    run = short(robot, parameters="upper")
    assert run.settings["scaled_to_physical"] == ["link2.body"]
    assert run.settings["parameters_inside_bounds"]
    assert run.summary()["violations"] == 0


def test_the_files_start_belongs_to_the_files_motion(paper: Robot) -> None:
    own = simulate(paper, scenario="1", duration=1e-3)
    np.testing.assert_array_equal(own.q[0], np.full(6, 0.02))
    np.testing.assert_array_equal(own.dq[0], np.zeros(6))
    hold = Quintic(np.array([0.0]), np.full((1, 6), 0.3))
    other = simulate(paper, scenario="1", duration=1e-3, trajectory=hold)
    np.testing.assert_array_equal(other.q[0], np.full(6, 0.3))
    given = simulate(paper, scenario="1", duration=1e-3, q0=np.zeros(6), dq0=np.full(6, 0.1))
    np.testing.assert_array_equal(given.q[0], np.zeros(6))
    np.testing.assert_array_equal(given.dq[0], np.full(6, 0.1))


def test_a_saved_run_holds_arrays_settings_and_summary(arm: Robot, tmp_path: Path) -> None:
    run = short(arm)
    file = tmp_path / "run.npz"
    file.write_bytes(b"old")
    run.save(file)
    with np.load(file) as saved:
        for name in ("t", "q", "dq", "q_des", "dq_des", "tau", "w", "phi_lo", "phi_hi", "rho"):
            np.testing.assert_array_equal(saved[name], getattr(run, name))
        np.testing.assert_array_equal(saved["true_parameters"], run.parameters.packed)
        assert json.loads(str(saved["settings"])) == run.settings
        assert json.loads(str(saved["summary"]))["violations"] == 0
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]


def test_a_log_that_cannot_be_written_is_refused_and_nothing_is_left(
    arm: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    missing = tmp_path / "no" / "run.npz"
    with pytest.raises(FileError) as caught:
        check_writable(missing)
    assert str(caught.value) == f"{missing}: no directory {missing.parent}; make it first"
    (tmp_path / "dir.npz").mkdir()
    with pytest.raises(FileError, match=r"is a directory; give the name of a file in it"):
        check_writable(tmp_path / "dir.npz")
    with pytest.raises(FileError, match=r'suffix ".txt"; a log ends in .npz; name it so'):
        check_writable(tmp_path / "run.txt")
    check_writable(tmp_path / "run.npz")

    def full(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", full)
    with pytest.raises(FileError, match="cannot be written: No space left on device"):
        short(arm, duration=0.01).save(tmp_path / "run.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["dir.npz"]


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"scenario": "1"}, ValueRangeError, 'scenario: no scenario "1"; known: none'),
        ({"parameters": "uper"}, ValueRangeError, 'did you mean "upper"?'),
        (
            {"duration": -1.0},
            ValueRangeError,
            "duration: -1 s; must be positive and finite; such as 10 s",
        ),
        ({"duration": 1e-9}, ValueRangeError, "is less than one tick of 10000 Hz"),
        (
            {"duration": 1e9},
            ValueRangeError,
            "duration: 1e+09 s at 10000 Hz are more than 1e+10 commands; make it shorter",
        ),
        ({"rate": 0.0}, ValueRangeError, "rate: 0 Hz; must lie in"),
        ({"rate": np.nan}, ValueRangeError, "rate: nan Hz; must lie in"),
        ({"substeps": 0}, ValueRangeError, "substeps: 0; must be at least 1"),
        ({"rate": "50k"}, ValueRangeError, "rate: '50k'; must be a number [Hz]"),
        ({"duration": "1 s"}, ValueRangeError, "duration: '1 s'; must be a number [s]"),
        ({"substeps": 1.5}, ValueRangeError, "substeps: 1.5; must be a whole number"),
        ({"substeps": 2**40}, ValueRangeError, "substeps: 1099511627776; must be at most 1000000"),
        ({"seed": -1}, ValueRangeError, "seed: -1; must be at least 0"),
        ({"seed": None}, ValueRangeError, "seed: None; must be a whole number"),
        (
            {"law": ["norm"]},
            ValueRangeError,
            'law: no law "[\'norm\']"; did you mean "norm"? known: norm',
        ),
        ({"plant": ["builtin"]}, ValueRangeError, "plant: no plant \"['builtin']\""),
        ({"parameters": 3}, ValueRangeError, 'parameters: no parameters "3"; known: nominal'),
        ({"trajectory": 5}, ValueRangeError, "trajectory: 5; must be a trajectory, a name or a"),
        ({"q0": [0.0]}, ShapeError, r'q0: expected shape (2,), got (1,); robot "chain-2"'),
        ({"dq0": [0.0, np.nan]}, ValueRangeError, "dq0[1] is nan; every entry must be finite"),
        ({"disturbance": [0.0] * 3}, ShapeError, "disturbance: expected shape (2,), got (3,)"),
        ({"trajectory": "paper"}, ShapeError, 'trajectory "paper": has 6 joints'),
        (
            {"trajectory": Quintic(np.array([0.0, 0.1]), np.array([[0.0, 0.0], [0.0, 1.5]]))},
            ValueRangeError,
            'trajectory: joint "link2.axis" is at',
        ),
        ({"epsilon": -1.0}, ValueRangeError, "epsilon: -1; must be positive"),
    ],
)
def test_a_wrong_argument_is_refused_before_anything_runs(
    arm: Robot, options: dict[str, Any], kind: type[InputError], message: str
) -> None:
    with pytest.raises(kind) as caught:
        short(arm, **options)
    assert message in str(caught.value)


def test_a_scenario_and_parameters_exclude_each_other(paper: Robot) -> None:
    with pytest.raises(ValueRangeError) as caught:
        simulate(paper, scenario="1", parameters="upper")
    assert str(caught.value) == (
        'parameters: given beside scenario "1", which sets them; give one of both'
    )
    with pytest.raises(ValueRangeError) as caught:
        simulate(paper, scenario="3")
    assert str(caught.value) == 'scenario: no scenario "3"; known: 1, 2'


def test_a_scenario_can_be_given_by_its_number(paper: Robot) -> None:
    run = simulate(paper, scenario=1, duration=1e-3)
    assert run.settings["scenario"] == "1"
    assert run.parameters is paper.scenarios["1"]
    with pytest.raises(ValueRangeError, match='scenario: no scenario "3"; known: 1, 2'):
        true_robot(paper, scenario=3)


def test_a_start_outside_the_limits_is_refused(arm: Robot) -> None:
    with pytest.raises(ValueRangeError) as caught:
        short(arm, q0=[0.0, -1.5])
    assert str(caught.value) == (
        'q0: joint "link2.axis" is at -1.5 rad; its position must stay in [-1, 1] rad; start '
        "within its limits"
    )
    assert short(arm, q0=[2.0, -1.0], trajectory=REST).t[-1] == 0.2  # the limits themselves
    with pytest.raises(ValueRangeError) as caught:
        short(arm, dq0=[2.5, 0.0])
    assert str(caught.value) == (
        'dq0: joint "link1.axis" moves at 2.5 rad/s; its velocity must stay in [-2, 2] rad/s; '
        "start within its limits"
    )
    own = replace(arm, initial_q=np.array([2.5, 0.0]))
    with pytest.raises(ValueRangeError) as caught:
        short(own)
    assert str(caught.value) == (
        'initial.q: joint "link1.axis" is at 2.5 rad; its position must stay in [-2, 2] rad; '
        "start within its limits"
    )
    assert short(own, q0=[0.0, 0.0]).t[-1] == 0.2


@pytest.mark.parametrize(
    ("duration", "rate", "ticks"),
    [
        (0.0105, 1e3, 11),  # half a tick beyond the last
        (0.0109, 1e3, 11),
        (0.3, 1e4, 3001),  # products that round below a whole number, or above it
        (0.0029, 1e4, 30),  # the product is a little less than 29
        (0.29, 1e4, 2901),
        (0.07, 1e4, 701),
        (1.1, 3e3, 3301),
    ],
)
def test_the_last_tick_lies_within_the_duration(
    arm: Robot, duration: float, rate: float, ticks: int
) -> None:
    run = short(arm, trajectory=REST, duration=duration, rate=rate)
    assert run.statistics is not None
    assert run.statistics.ticks == ticks
    assert (ticks - 1) / rate <= duration * (1.0 + 1e-15) < ticks / rate
    rows = np.array([0.0, duration])
    short(arm, trajectory=Splined(rows, np.zeros((2, 2))), duration=duration, rate=rate)


def test_parameters_of_another_robot_are_refused(arm: Robot) -> None:
    with pytest.raises(ShapeError) as caught:
        short(arm, parameters=synthetic_chain(3).nominal)
    assert str(caught.value) == (
        'parameters: of 3 bodies and 3 joints; robot "chain-2" has 2 and 2'
    )


def test_chattering_is_one_for_a_slow_signal_and_large_for_a_shaking_one() -> None:
    t: Array = np.arange(6001.0) * 1e-3
    slow = np.sin(t)
    shaking = slow + 0.01 * np.sin(2.0 * np.pi * 200.0 * t)
    tau = np.stack([slow, shaking, np.ones_like(t)], axis=1)
    variation = np.vstack([np.zeros(3), np.cumsum(np.abs(np.diff(tau, axis=0)), axis=0)])
    ratios = chattering(t, tau, variation)
    assert ratios is not None
    assert ratios[0] == pytest.approx(1.0, abs=5e-3)
    assert ratios[1] > 5.0
    assert ratios[2] == 1.0
    assert chattering(t[:4000], tau[:4000], variation[:4000]) is None


def test_the_largest_number_of_commands_is_allowed_and_no_more() -> None:
    assert _tick_count(MAX_TICKS / 50e3, 50e3) == MAX_TICKS + 1
    with pytest.raises(ValueRangeError, match="make it shorter"):
        _tick_count(1.1 * MAX_TICKS / 50e3, 50e3)
