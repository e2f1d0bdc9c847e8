"""The figures of `modrobust assemble` on arms whose reach and torques are known by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from modrobust.assembly.summary import MassFigures, exact_groups, report
from modrobust.model import Bounded, ControllerSettings, Parameters, Robot
from support.float_transforms import from_xyz_rpy, translation

G = 9.81  # [m/s^2]


def arm(joint_types=("revolute", "revolute"), base_body=False) -> Robot:
    """Two links of 0.5 m in a vertical plane; 2 kg and [1, 3] kg at the links' ends."""
    n = 2
    bodies = 3 if base_body else 2

    def point(tip_mass):
        masses = [2.0, tip_mass, 7.0][:bodies]
        inertia = np.array([1e-3 * np.eye(3)] * bodies)
        zeros = np.zeros(n)
        return Parameters(np.array(masses), np.zeros((bodies, 3)), inertia, zeros, zeros, zeros)

    return Robot(
        name="arm",
        gravity=np.array([0.0, 0.0, -G]),
        base=from_xyz_rpy((0.0, 0.0, 1.0), (math.pi / 2, 0.0, 0.0)),  # axes horizontal
        joint_names=("a.axis", "b.axis"),
        joint_types=joint_types,
        parents=np.array([-1, 0], dtype=np.int32),
        before=np.array([np.eye(4)] * n),
        after=np.array([translation((0.5, 0.0, 0.0))] * n),
        position_limits=np.array([[-math.pi, math.pi], [-math.inf, math.inf]]),
        velocity_limits=np.array([1.0, math.inf]),
        effort_limits=np.array([50.0, math.inf]),
        gear_ratio=np.zeros(n),
        coulomb_speed=np.full(n, 1e-3),
        body_names=("a.body", "b.body", "mount.body")[:bodies],
        body_joints=np.array([0, 1, -1][:bodies], dtype=np.int32),
        placement=np.array([np.eye(4)] * bodies),
        nominal=point(2.0),
        lower=point(1.0),
        upper=point(3.0),
        disturbance=Bounded(np.zeros(n), np.zeros(n), np.zeros(n)),
        controller=ControllerSettings(K_r=(10.0, 10.0)),
        exact=("a.body.mass", "a.body.com", "a.body.inertia", "b.body.com", "b.body.inertia"),
        not_modelled=("a.axis.drive",),
        notes=("a remark",),
    )


def test_reach_is_that_of_the_stretched_arm_from_the_base_frame():
    found = report(arm()).reach
    assert 0.999 < found <= 1.0 + 1e-12


def test_static_torque_is_that_of_the_stretched_arm_with_the_heaviest_tip():
    figures = report(arm()).joints
    # 2 kg at 0.5 m and 3 kg at 1 m; 3 kg at 0.5 m.
    for joint, worst in zip(figures, (G * (2 * 0.5 + 3 * 1.0), G * 3 * 0.5), strict=True):
        assert 0.99 * worst < joint.static_torque <= worst * (1 + 1e-12)
    assert figures[0].share == figures[0].static_torque / 50.0
    assert figures[1].effort is None
    assert figures[1].share is None


def test_static_torque_counts_the_lower_end_of_the_bound_where_it_is_larger():
    robot = replace(arm(), position_limits=np.array([[0.0, 0.0], [0.0, 0.0]]))
    down = replace(robot, gravity=np.array([0.0, 0.0, G]))
    upright, hanging = (report(r, poses=10).joints[0].static_torque for r in (robot, down))
    assert upright == pytest.approx(hanging, abs=1e-12)
    worst = G * (2 * 0.5 + 3 * 1.0)
    assert worst <= upright <= worst * (1 + 1e-13)  # the bound encloses its rounding


def test_the_same_seed_finds_the_same_figures():
    one, two = (report(arm(), poses=100, seed=3) for _ in range(2))
    assert one.reach == two.reach
    assert one.joints == two.joints
    assert report(arm(), poses=100, seed=4).reach != one.reach


def test_limits_that_are_not_given_are_none():
    first, second = report(arm(), poses=10).joints
    assert first.position == (-math.pi, math.pi)
    assert first.velocity == 1.0
    assert second.position is None
    assert second.velocity is None


def test_masses_add_up_per_link_and_in_all_with_their_bounds():
    found = report(arm(base_body=True), poses=10)
    assert found.total_mass == MassFigures(11.0, 10.0, 12.0)
    assert [(link.joint, link.bodies, link.mass) for link in found.links] == [
        ("base", ("mount.body",), MassFigures(7.0, 7.0, 7.0)),
        ("a.axis", ("a.body",), MassFigures(2.0, 2.0, 2.0)),
        ("b.axis", ("b.body",), MassFigures(2.0, 1.0, 3.0)),
    ]


def test_a_body_of_which_all_is_exact_takes_one_line():
    assert exact_groups(arm()) == ("a.body", "b.body.com", "b.body.inertia")


def test_a_prismatic_joint_without_limits_is_searched_in_a_stated_stroke():
    found = report(arm(("revolute", "prismatic")), poses=2000)
    assert found.notes == (
        "a remark",
        "b.axis: no position limits; reach and torque searched within +-1 m",
    )
    assert 0.99 * math.hypot(1.0, 1.0) < found.reach <= math.hypot(1.0, 1.0) + 1e-12


def test_the_report_carries_the_table_and_what_is_not_modelled():
    found = report(arm(), poses=10)
    assert found.dh is not None
    assert [row.a for row in found.dh.rows] == [0.5, 0.5]
    assert found.not_modelled == ("a.axis.drive",)
    assert found.poses == 10
