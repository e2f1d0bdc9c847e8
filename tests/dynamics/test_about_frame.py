"""Bodies whose tensor is about their frame, (16f) and (18f): from files to bounds and exports."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.model import Parameters, Robot
from modrobust.model.physical import least_second_moment
from support.exact_range import exact_range
from support.random_robots import about_com, about_frame, random_robot, random_state, steiner, tied
from support.rounding import assert_encloses, excess_allowed
from support.states import state_of
from support.tightness_population import boxed
from support.urdf_texts import written

BOUNDS = ("hull", "ianea")
BAR = """
modrobust: 1
module: bar
name: bar
source: made up
chain:
  - joint: j
    type: continuous
  - frame: f
    span: {xyz: [-0.2 m, 0, 0]}
  - body: b
    mass: 2 kg ± 10%
    com: [200 mm ± 20 mm, 0, 0]
    inertia: {about: frame, xx: 0.1 ± 1%, yy: 0.2 ± 1%, zz: 0.2 ± 1%}
"""


def bar_robot(folder: Path, bar: str = BAR, more: str = "") -> Robot:
    written(folder, bar, "bar.yaml")
    text = f"modrobust: 1\nrobot: arm\nmodules: .\nchain: [bar]\n{more}"
    return mr.load_robot(written(folder, text, "arm.yaml"))


def framed_robot(seed: int, n: int = 5, width: float = 0.2, **shape: Any) -> Robot:
    """Random, every tensor about its body's frame, a box of that relative width on it."""
    rng = np.random.default_rng(seed)
    return boxed(about_frame(random_robot(rng, n, width="exact", **shape)), width, rng)


def at_com(robot: Robot, point: Parameters) -> Robot:
    """The robot of one point with every tensor moved to the COM."""
    return about_com(replace(robot, nominal=point, lower=point, upper=point))


def test_the_bar_has_the_range_worked_out_by_hand(tmp_path: Path) -> None:
    # The axis passes through the nominal COM. At ddq_a = 1 the frame's origin, 0.2 m off it, makes
    # tau = J + m (0.2^2 - 2 0.2 c) = J + m (0.04 - 0.4 c), c the COM from the frame:
    # m in [1.8, 2.2], c in [0.18, 0.22], J in [0.198, 0.202].
    robot = bar_robot(tmp_path)
    zero, one = np.zeros(1), np.ones(1)
    lo, hi = mr.inverse_dynamics_bounds(robot, zero, zero, zero, one, drives=False)
    assert lo[0] <= 0.198 - 2.2 * 0.048 <= 0.0924 + 1e-15
    assert hi[0] >= 0.202 - 1.8 * 0.032
    assert lo[0] == pytest.approx(0.0924, abs=1e-12)
    assert hi[0] == pytest.approx(0.1444, abs=1e-12)
    # J - 0.2 m c, as moment, and -0.2 m (c - 0.2), as force on the lever, apart
    wide_lo, wide_hi = mr.inverse_dynamics_bounds(robot, zero, zero, zero, one, "ianea", False)
    assert wide_lo[0] == pytest.approx(0.198 - 0.2 * 2.2 * 0.22 - 0.2 * 2.2 * 0.02, abs=1e-12)
    assert wide_hi[0] == pytest.approx(0.202 - 0.2 * 1.8 * 0.18 + 0.2 * 2.2 * 0.02, abs=1e-12)
    assert wide_lo[0] <= 0.0924
    tau = mr.inverse_dynamics(robot, zero, zero, zero, one, drives=False)[0]
    assert tau == pytest.approx(0.2 + 2 * (0.04 - 0.4 * 0.2), abs=1e-15)
    assert mr.mass_matrix(robot, zero, drives=False)[0, 0] == pytest.approx(tau, abs=1e-15)


def test_the_resolved_robot_has_the_box_as_written(tmp_path: Path) -> None:
    body = bar_robot(tmp_path).to_dict()["bodies"][0]
    assert body["inertia_about"] == "frame"
    assert body["inertia"]["nominal"][1][1] == 0.2
    assert body["inertia"]["lo"][1][1] <= 0.198 <= body["inertia"]["hi"][1][1]
    about_the_com = bar_robot(tmp_path, BAR.replace("about: frame, ", ""))
    assert about_the_com.to_dict()["bodies"][0]["inertia_about"] == "com"


@pytest.mark.parametrize("shape", [{}, {"tree": True}, {"simple": True}, {"types": "rprpr"}])
def test_a_point_is_the_same_robot_whatever_its_tensors_are_about(shape: dict[str, Any]) -> None:
    rng = np.random.default_rng(1)
    for seed in range(3):
        robot = framed_robot(seed, **shape)
        point = robot.sample_parameters(seed)
        twin = at_com(robot, point)
        state = random_state(rng, robot.n)
        for drives in (True, False):
            tau = mr.inverse_dynamics(robot, *state, point, drives)
            size = np.abs(tau).max()
            other = mr.inverse_dynamics(twin, *state, drives=drives)
            np.testing.assert_allclose(other, tau, rtol=0, atol=1e-13 * size)
            M = mr.mass_matrix(robot, state[0], point, drives)
            other = mr.mass_matrix(twin, state[0], drives=drives)
            np.testing.assert_allclose(other, M, rtol=0, atol=1e-13 * np.abs(M).max())
            ddq = mr.forward_dynamics(robot, state[0], state[1], tau, point, drives)
            other = mr.forward_dynamics(twin, state[0], state[1], tau, drives=drives)
            np.testing.assert_allclose(other, ddq, rtol=0, atol=1e-9 * np.abs(ddq).max())


@pytest.mark.parametrize("shape", [{}, {"tree": True}, {"types": "rprpr"}])
def test_the_hull_is_the_range_and_holds_every_point_of_the_box(shape: dict[str, Any]) -> None:
    """The points as robots with tensors about the COM: no formula of this kind is used for them."""
    rng = np.random.default_rng(2)
    for seed in range(4):
        robot = framed_robot(10 + seed, **shape)
        state = random_state(rng, robot.n)
        real = exact_range(robot, state, False)
        bounds = mr.inverse_dynamics_bounds(robot, *state, drives=False)
        assert_encloses(bounds, real, excess_allowed(robot, *state, drives=False))
        size = np.abs(real).max()
        box = [mr.inverse_dynamics_bounds(robot, *state, m, False) for m in BOUNDS]
        points = [robot.corner_parameters(rng) for _ in range(20)]
        points += [robot.sample_parameters(rng) for _ in range(10)]
        for point in points:
            tau = mr.inverse_dynamics(at_com(robot, point), *state, drives=False)
            for least, most in box:
                assert np.all((least - 1e-12 * size <= tau) & (tau <= most + 1e-12 * size))


def test_an_extremum_inside_the_box_is_found_where_the_reference_rates_differ() -> None:
    """With dq_a not along dq every component of the COM has a parabola; no corner attains it."""
    inside = 0
    for seed in range(6):
        rng = np.random.default_rng([5, seed])
        robot = about_frame(random_robot(rng, types="rrr", simple=True, drives=False))
        for off in (0.0, 0.3):  # the middle of the box, and nominal off it
            lower = replace(robot.nominal, com=robot.nominal.com - 2.0)
            upper = replace(robot.nominal, com=robot.nominal.com + 2.0 + off)
            wide = replace(robot, lower=lower, upper=upper)
            state = random_state(rng, 3, 8.0)
            lo, hi = mr.inverse_dynamics_bounds(wide, *state, drives=False)
            real = exact_range(wide, state, False)
            assert_encloses((lo, hi), real, excess_allowed(wide, *state, drives=False))
            size = np.abs(real).max()
            ends = (lower.com, upper.com)
            last = [
                mr.inverse_dynamics(
                    wide, *state, replace(robot.nominal, com=np.stack([*lower.com[:2], corner]))
                )[2]
                for corner in itertools.product(*zip(*(end[2] for end in ends), strict=True))
            ]
            inside += max(last) < hi[2] - 1e-6 * size or min(last) > lo[2] + 1e-6 * size
    assert inside > 3


@pytest.mark.parametrize("bound", BOUNDS)
def test_a_box_moved_to_the_com_at_nominal_would_miss_true_torques(
    tmp_path: Path, bound: str
) -> None:
    """Why there are bodies of this kind: 0.0924 is a torque of a body inside the written bounds."""
    robot = bar_robot(tmp_path)
    p = robot.nominal
    shift = steiner(p.mass, p.com)
    points = {
        name: replace(getattr(robot, name), inertia=getattr(robot, name).inertia - shift)
        for name in ("lower", "nominal", "upper")
    }
    moved = replace(robot, inertia_about=(), **points)
    zero, one = np.zeros(1), np.ones(1)
    lo, _ = mr.inverse_dynamics_bounds(moved, zero, zero, zero, one, bound, False)
    assert lo[0] > 0.095


@pytest.mark.parametrize("bound", BOUNDS)
def test_a_batch_has_the_bits_of_the_single_call_with_both_kinds_mixed(bound: str) -> None:
    rng = np.random.default_rng(6)
    robot = tied(random_robot(rng, 7, tree=True), 5, rng)
    assert robot.framed.any()
    assert not robot.framed.all()
    states = [random_state(rng, 5) for _ in range(19)]
    columns = state_of(np.array(column) for column in zip(*states, strict=True))
    batch = mr.inverse_dynamics_bounds_batch(robot, *columns, bound=bound)
    single = [mr.inverse_dynamics_bounds(robot, *state, bound=bound) for state in states]
    np.testing.assert_array_equal(np.array(batch), np.array(single).swapaxes(0, 1))


def test_a_body_about_the_com_keeps_its_bits_beside_one_about_the_frame() -> None:
    rng = np.random.default_rng(7)
    robot = boxed(about_com(random_robot(rng, 4, width="exact")), 0.1, rng)
    other = replace(robot, inertia_about=("frame", *robot.inertia_about[1:]))
    assert robot.body_joints[0] == -1  # fixed to the base: what it is about changes no torque
    state = random_state(rng, 4)
    for bound in BOUNDS:
        one, two = (mr.inverse_dynamics_bounds(r, *state, bound=bound) for r in (robot, other))
        np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize("seed", range(3))
def test_samples_and_pulled_corners_are_bodies(seed: int) -> None:
    """Wide boxes: at most masses and COMs of them no tensor of the box would be one."""
    robot = framed_robot(30 + seed, 3, width=0.4)
    points = [robot.sample_parameters(k) for k in range(20)]
    raw = [robot.corner_parameters(k) for k in range(20)]
    pulled = [robot.physical_corner("corner", k) for k in range(20)]
    points += [point for point, _ in pulled]
    for point in points:
        for name in ("mass", "com", "inertia"):
            lo, value, hi = (getattr(x, name) for x in (robot.lower, point, robot.upper))
            assert np.all((lo <= value) & (value <= hi))
        tensors = point.inertia - steiner(point.mass, point.com)
        assert least_second_moment(tensors).min() >= -1e-15  # on the boundary where pulled
    assert sum(len(names) for _, names in pulled) > 10
    for point, (other, names) in zip(raw, pulled, strict=True):
        kept = np.array([name not in names for name in robot.body_names])
        np.testing.assert_array_equal(point.mass[kept], other.mass[kept])
        np.testing.assert_array_equal(point.inertia[kept], other.inertia[kept])


def test_a_pulled_body_comes_straight_with_mass_and_com(tmp_path: Path) -> None:
    robot = bar_robot(tmp_path, BAR.replace("± 20 mm", "± 150 mm"))
    point, pulled = robot.physical_corner("upper")  # 2.2 kg at 0.35 m: more than 0.202
    assert pulled == ("bar.b",)
    way = [
        (getattr(point, name) - getattr(robot.nominal, name)).flat[0]
        / (getattr(robot.upper, name) - getattr(robot.nominal, name)).flat[0]
        for name in ("mass", "com", "inertia")
    ]
    assert 0.1 < way[0] < 0.9
    np.testing.assert_allclose(way, way[0], rtol=1e-9)


def test_exports_write_the_tensor_about_the_com(tmp_path: Path) -> None:
    robot = bar_robot(tmp_path)
    tensor = {"ixx": "0.1", "iyy": "0.12", "izz": "0.12"}
    text = urdf_text(robot).text
    for entry, value in tensor.items():
        assert f'{entry}="{value}' in text or f'{entry}="0.11999' in text
    read = mr.load_robot(written(tmp_path, text, "bar.urdf"))
    assert read.inertia_about == ("com",)
    zero = np.zeros(1)
    expected = mr.mass_matrix(robot, zero, drives=False)
    np.testing.assert_allclose(mr.mass_matrix(read, zero, drives=False), expected, rtol=1e-13)
    assert "0.2" not in mjcf_text(robot, visual=False).text.split("diaginertia")[1].split(">")[0]


def test_a_payload_and_a_set_may_be_about_the_frame(tmp_path: Path) -> None:
    payload = (
        "payload: {mass: [1 kg, 2 kg], com: [0, 0, [0, 0.1 m]],\n"
        "  inertia: {about: frame, xx: 0.05, yy: 0.05, zz: 0.01}}\n"
    )
    robot = bar_robot(tmp_path, BAR, payload)
    assert robot.inertia_about == ("frame", "frame")
    assert robot.nominal.inertia[1].diagonal().tolist() == [0.05, 0.05, 0.01]
    own = "chain: [{module: bar, set: {b.inertia: {xx: 0.1, yy: 0.12, zz: 0.12}}}]\n"
    text = f"modrobust: 1\nrobot: arm\nmodules: .\n{own}"
    robot = mr.load_robot(written(tmp_path, text, "arm.yaml"))
    assert robot.inertia_about == ("com",)


def test_an_overlay_of_a_urdf_may_be_about_the_links_frame(tmp_path: Path) -> None:
    exported = urdf_text(bar_robot(tmp_path)).text
    link = bar_robot(tmp_path).body_names[0]
    written(tmp_path, exported, "plain.urdf")
    overlay = (
        "modrobust: 1\nrobot: over\nurdf: plain.urdf\nlinks:\n"
        f"  {link}: {{mass: 2 kg ± 10%, com: [0.1 m ± 10 mm, 0, 0],\n"
        "    inertia: {about: frame, xx: 0.1, yy: 0.2, zz: 0.2}}\n"
    )
    robot = mr.load_robot(written(tmp_path, overlay, "over.yaml"))
    assert robot.inertia_about == ("frame",)
    assert robot.nominal.inertia[0].diagonal().tolist() == [0.1, 0.2, 0.2]
    # about the axis through the link's origin: J itself, whatever m and c are
    zero, one = np.zeros(1), np.ones(1)
    lo, hi = mr.inverse_dynamics_bounds(robot, zero, zero, zero, one, drives=False)
    assert lo[0] == pytest.approx(0.2, abs=1e-12)
    assert hi[0] == pytest.approx(0.2, abs=1e-12)


def test_scenarios_are_judged_about_the_com(tmp_path: Path) -> None:
    bar = BAR.replace("± 20 mm", "± 150 mm")
    scenario = "scenarios: {1: {set: {bar.b.com: [0.34 m, 0, 0]}}}\n"
    notes = bar_robot(tmp_path, bar, scenario).notes
    assert any("scenario 1: bar.b has a tensor that no rigid body has" in note for note in notes)


def test_reference_points_are_checked() -> None:
    robot = random_robot(np.random.default_rng(8), 2)
    with pytest.raises(ShapeError, match=rf"inertia_about: expected {robot.b} entries, got 1"):
        replace(robot, inertia_about=("com",))
    with pytest.raises(ValueRangeError, match=r'inertia_about\[0\] is "origin"; known: com, frame'):
        replace(robot, inertia_about=("origin",) * robot.b)
