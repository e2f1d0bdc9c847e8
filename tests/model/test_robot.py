"""Robot and Parameters: immutable, exact through JSON, points of the box inside and physical."""

import copy
import json
import math
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import Bounded, MimicJoints, Parameters, Robot, synthetic_chain
from modrobust.model.physical import is_physical, least_second_moment
from modrobust.model.sampling import sample_point

FIELDS = ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb")
AT_COM = np.array([False])  # what the tensor of `one_body` is about
ROD = np.diag([0.1, 0.1, 0.0])  # a thin rod along z: on the boundary of what is physical


def one_body(nominal, lower, upper):
    """Nominal point and bounds of one body with the given tensors, no joints."""
    zero = np.zeros(0)
    return tuple(
        Parameters(np.ones(1), np.zeros((1, 3)), np.array([tensor]), zero, zero, zero)
        for tensor in (nominal, lower, upper)
    )


def robot_with_drives() -> Robot:
    base = synthetic_chain(3, uncertainty=0.1)

    def driven(point, scale):
        return replace(
            point,
            rotor_inertia=np.array([1e-5, 0.0, 2e-5]) * scale,
            viscous=np.array([1.0, 2.0, 3.0]) * scale,
            coulomb=np.array([0.1, 0.2, 0.3]) * scale,
        )

    return replace(
        base,
        nominal=driven(base.nominal, 1.0),
        lower=driven(base.lower, 0.9),
        upper=driven(base.upper, 1.1),
        gear_ratio=np.array([100.0, 0.0, 50.0]),
        disturbance=Bounded(np.zeros(3), np.array([-0.1, 0, -1]), np.array([0.1, 0, 2])),
        velocity_limits=np.array([1.0, np.inf, 3.0]),
        exact=("link1.body.mass",),
        not_modelled=("link2.axis.drive",),
    )


def inside(point, robot):
    return all(
        np.all(getattr(robot.lower, f) <= getattr(point, f))
        and np.all(getattr(point, f) <= getattr(robot.upper, f))
        for f in FIELDS
    )


def test_every_array_of_a_robot_is_a_read_only_copy():
    gravity = np.array([0.0, 0.0, -9.81])
    robot = replace(robot_with_drives(), gravity=gravity)
    gravity[2] = 0.0
    assert robot.gravity[2] == -9.81
    for array in (robot.gravity, robot.before, robot.parents, robot.nominal.mass):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    with pytest.raises(ValueError, match="read-only"):
        robot.nominal.packed[0] = 0.0


def test_to_dict_comes_back_from_json_bit_for_bit():
    robot = robot_with_drives()
    data = robot.to_dict()
    again = json.loads(json.dumps(data, allow_nan=False))
    assert again == data
    for i in range(3):
        np.testing.assert_array_equal(again["joints"][i]["after"], robot.after[i])
        np.testing.assert_array_equal(again["bodies"][i]["inertia"]["hi"], robot.upper.inertia[i])
        assert again["bodies"][i]["mass"]["lo"] == robot.lower.mass[i]


def test_to_dict_has_the_pinned_keys_and_null_for_limits_that_are_not_given():
    data = robot_with_drives().to_dict()
    assert list(data) == [
        *("robot", "version", "gravity", "base", "joints", "bodies", "disturbance"),
        *("dh", "exact", "not_modelled", "unphysical"),
    ]
    joint = data["joints"][0]
    assert list(joint) == [
        "name",
        "type",
        "parent",
        "before",
        "after",
        "limits",
        "drive",
        "friction",
    ]
    assert joint["limits"] == {
        "position": None,
        "velocity": 1.0,
        "effort": None,
        "acceleration": None,
    }
    assert data["joints"][1]["limits"]["velocity"] is None
    assert joint["drive"]["rotor_inertia"] == {"nominal": 1e-5, "lo": 9e-6, "hi": 1e-5 * 1.1}
    assert joint["friction"]["coulomb_speed"] == 1e-3
    assert [j["parent"] for j in data["joints"]] == [-1, 0, 1]
    assert list(data["bodies"][0]) == [
        *("name", "joint", "placement", "mass", "com", "inertia_about", "inertia"),
    ]
    assert data["disturbance"][2] == {"nominal": 0.0, "lo": -1.0, "hi": 2.0}
    assert list(data["dh"]["rows"][0]) == ["a", "alpha", "d", "theta", "near_parallel"]


def test_branches_have_no_dh_table_in_to_dict():
    robot = replace(synthetic_chain(3), parents=np.array([-1, 0, 0], dtype=np.int32))
    assert robot.to_dict()["dh"] is None


def test_samples_are_physical_inside_the_box_and_spread_over_it():
    robot = robot_with_drives()
    points = [robot.sample_parameters(seed) for seed in range(200)]
    for point in points:
        assert inside(point, robot)
        moments = np.linalg.eigvalsh(point.inertia)
        assert np.all(moments > 0.0)
        assert np.all(moments[:, 0] + moments[:, 1] >= moments[:, 2] * (1 - 1e-12))
    masses = np.array([point.mass for point in points])
    width = robot.upper.mass - robot.lower.mass
    assert np.all(np.ptp(masses, axis=0) > 0.9 * width)


def test_equal_seeds_give_equal_samples_and_a_generator_moves_on():
    robot = robot_with_drives()
    np.testing.assert_array_equal(
        robot.sample_parameters(7).packed, robot.sample_parameters(np.random.default_rng(7)).packed
    )
    rng = np.random.default_rng(7)
    first, second = robot.sample_parameters(rng), robot.sample_parameters(rng)
    assert np.any(first.packed != second.packed)


def test_exact_parameters_stay_exact_in_samples_and_corners():
    robot = synthetic_chain(4, uncertainty=0.0)
    for point in (robot.sample_parameters(1), robot.corner_parameters(1)):
        np.testing.assert_array_equal(point.packed, robot.nominal.packed)


def test_most_of_a_wide_box_being_unphysical_still_gives_physical_samples():
    nominal, lower, upper = one_body(np.diag([0.1, 0.1, 0.19]), np.eye(3) * 0.01, np.eye(3) * 0.5)
    rng = np.random.default_rng(0)
    for _ in range(100):
        tensor = sample_point(nominal, lower, upper, AT_COM, rng).inertia
        assert np.all(least_second_moment(tensor) >= -1e-15)


def test_a_box_that_touches_the_physical_set_in_one_point_gives_that_point():
    # The nominal rod with zz only downwards: every other tensor of the box is unphysical.
    nominal, lower, upper = one_body(ROD, np.diag([0.1, 0.1, -0.05]), ROD)
    rng = np.random.default_rng(0)
    tensor = sample_point(nominal, lower, upper, AT_COM, rng).inertia[0]
    np.testing.assert_allclose(tensor, ROD, rtol=0, atol=1e-15)


def test_a_thin_rod_counts_as_physical_and_a_longer_axis_does_not():
    assert is_physical(ROD, ROD)
    assert not is_physical(np.diag([0.1, 0.3, 0.1]), np.eye(3))
    assert not is_physical(np.diag([0.1, 0.1, -0.01]), np.eye(3))


def test_a_rod_that_rounding_put_outside_still_has_points_in_its_box():
    rod = np.diag([0.1, 0.1 * (1 + 1e-13), -1e-15])
    assert least_second_moment(rod) < -1e-15
    assert is_physical(rod, rod)
    assert not is_physical(np.diag([0.1, 0.1, -1e-13]), rod)


def test_corners_have_every_entry_at_an_end_and_reach_both_ends():
    robot = robot_with_drives()
    seen: dict[str, set[bool]] = {name: set() for name in FIELDS}
    for seed in range(40):
        point = robot.corner_parameters(seed)
        for name in FIELDS:
            value, lo, hi = (getattr(p, name) for p in (point, robot.lower, robot.upper))
            assert np.all((value == lo) | (value == hi))
            seen[name].add(bool(value.flat[0] == hi.flat[0]))
        np.testing.assert_array_equal(point.inertia, np.swapaxes(point.inertia, 1, 2))
    assert all(ends == {True, False} for ends in seen.values())


def test_unphysical_corners_are_pulled_towards_nominal_and_named():
    robot = synthetic_chain(2, uncertainty=0.1)
    lower = replace(robot.lower, inertia=np.array([np.diag([1e-3, 1e-3, 3e-3])] * 2))
    upper = replace(robot.upper, inertia=robot.nominal.inertia + 1e-2 * np.eye(3))
    robot = replace(robot, lower=lower, upper=upper)
    point, pulled = robot.physical_corner("lower")
    assert pulled == ("link1.body", "link2.body")
    np.testing.assert_array_equal(point.mass, robot.lower.mass)
    for k in range(2):
        way = point.inertia[k] - robot.nominal.inertia[k]
        full = lower.inertia[k] - robot.nominal.inertia[k]
        share = way[0, 0] / full[0, 0]
        assert 0.0 < share < 1.0
        np.testing.assert_allclose(way, share * full, rtol=1e-12, atol=1e-18)
        assert abs(least_second_moment(point.inertia[k])) < 1e-15  # on the boundary: the last one
    point, pulled = robot.physical_corner("upper")
    assert pulled == ()
    np.testing.assert_array_equal(point.packed, robot.upper.packed)


def test_corner_of_a_seed_is_the_same_with_and_without_pulling_when_it_is_physical():
    robot = synthetic_chain(3, uncertainty=0.01)
    point, pulled = robot.physical_corner("corner", 5)
    assert pulled == ()
    np.testing.assert_array_equal(point.packed, robot.corner_parameters(5).packed)


def test_an_unknown_corner_is_refused():
    with pytest.raises(ValueRangeError) as caught:
        synthetic_chain(1).physical_corner("middle")
    assert str(caught.value) == 'which: "middle" is none of lower, upper, corner'


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"com": np.zeros((1, 3))},
            "com: expected shape (2, 3), got (1, 3); 2 bodies from mass, 2 joints from "
            "rotor_inertia",
        ),
        (
            {"viscous": np.zeros(3)},
            "viscous: expected shape (2,), got (3,); 2 bodies from mass, 2 joints from "
            "rotor_inertia",
        ),
        (
            {"inertia": np.array([[[1.0, 0.1, 0], [0, 1, 0], [0, 0, 1]]] * 2)},
            "inertia: found a tensor that is not symmetric; give symmetric ones",
        ),
    ],
)
def test_parameters_of_unequal_shapes_are_refused(change, message):
    with pytest.raises(ShapeError) as caught:
        replace(synthetic_chain(2).nominal, **change)
    assert str(caught.value) == message


def test_parameters_that_are_not_finite_are_refused():
    with pytest.raises(ValueRangeError) as caught:
        replace(synthetic_chain(2).nominal, mass=np.array([1.0, math.nan]))
    assert str(caught.value) == "mass[1] is nan; every entry must be finite"


def test_packed_is_the_kernels_order():
    point = replace(
        synthetic_chain(1).nominal,
        mass=np.array([1.0]),
        com=np.array([[2.0, 3.0, 4.0]]),
        inertia=np.array([[[5.0, 6, 7], [6, 8, 9], [7, 9, 10]]]),
        rotor_inertia=np.array([11.0]),
        viscous=np.array([12.0]),
        coulomb=np.array([13.0]),
    )
    np.testing.assert_array_equal(point.packed, np.arange(1.0, 14.0))


def test_acceleration_limits_are_infinite_unless_given_and_stand_in_the_resolved_robot():
    robot = synthetic_chain(2)
    np.testing.assert_array_equal(robot.acceleration_limits, [np.inf, np.inf])
    limited = replace(robot, acceleration_limits=np.array([1.0, 2.0]))
    for arm, expected in ((robot, [None, None]), (limited, [1.0, 2.0])):
        found = [joint["limits"]["acceleration"] for joint in arm.to_dict()["joints"]]
        assert found == expected
    with pytest.raises(ShapeError, match=r"^acceleration_limits: expected shape \(2,\), got "):
        replace(robot, acceleration_limits=np.ones(3))


@pytest.mark.parametrize("draw", ["sample_parameters", "corner_parameters"])
@pytest.mark.parametrize(
    ("rng", "message"),
    [
        (-1, "rng: -1; must be at least 0"),
        (1.5, "rng: 1.5; must be a whole number"),
        (None, "rng: None; must be a whole number"),
    ],
)
def test_a_seed_that_is_none_is_refused(draw, rng, message):
    with pytest.raises(ValueRangeError) as caught:
        getattr(synthetic_chain(1), draw)(rng)
    assert str(caught.value) == message


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
@pytest.mark.parametrize("name", ["lwa4p-paper", "lwa4p-payload"])
def test_a_copied_robot_is_the_same_and_as_read_only(name: str, copied: Any) -> None:
    robot = mr.load_robot(name)
    q = np.linspace(0.1, 0.6, robot.n)
    tau = mr.inverse_dynamics(robot, q, q, q, q)  # what is cached before is not copied
    twin = copied(robot)
    assert twin.to_dict() == robot.to_dict()
    assert dict(twin.scenario_notes) == dict(robot.scenario_notes)
    for scenario, point in robot.scenarios.items():
        np.testing.assert_array_equal(twin.scenarios[scenario].packed, point.packed)
    np.testing.assert_array_equal(mr.inverse_dynamics(twin, q, q, q, q), tau)
    for array in (twin.before, twin.nominal.mass, twin.disturbance.lo, twin.mimic.offset):
        assert not array.flags.writeable
    with pytest.raises(TypeError):
        twin.scenarios["x"] = robot.nominal


def test_a_robot_shows_itself_in_one_line() -> None:
    assert repr(mr.load_robot("lwa4p-paper")) == '<Robot "lwa4p-paper": 6 joints, 6 bodies>'


def test_what_is_no_robot_is_refused_with_how_to_make_one() -> None:
    zero = np.zeros(3)
    for call in (
        lambda x: mr.inverse_dynamics(x, zero, zero, zero, zero),
        lambda x: mr.mass_matrix(x, zero),
        lambda x: mr.simulate(x),
        lambda x: mr.RobustController(x),
    ):
        with pytest.raises(ValueRangeError) as caught:
            call("arm.yaml")
        assert str(caught.value) == "robot: expected a Robot, got str; load_robot(...) makes one"
    with pytest.raises(ValueRangeError) as caught:
        mr.load_robot(None)  # type: ignore[arg-type]
    assert str(caught.value) == (
        "robot: None; the name of a built-in robot or the path of a file is expected"
    )


def test_integer_arrays_keep_their_values() -> None:
    far = 2**32 + 5
    bounds = Bounded(np.array([0]), np.array([-far]), np.array([far], np.uint64))
    assert [*bounds.lo, *bounds.hi] == [-far, far]
    robot = replace(synthetic_chain(2), gravity=np.array([0, 0, -(2**32) - 10]))
    assert robot.gravity.dtype == np.float64
    assert robot.gravity.tolist() == [0.0, 0.0, -(2.0**32) - 10.0]
    assert replace(robot, parents=np.array([-1, 0], np.int64)).parents.dtype == np.int32


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("gravity", np.array([0, 0, 1j]), "gravity: holds complex entries; expected numbers"),
        ("gravity", np.array([True] * 3), "gravity: holds truth values; expected numbers"),
        ("gravity", ["0", "0", "1"], "gravity: holds text; expected numbers"),
        ("parents", [-1.0, 0.0], "parents: holds floats; expected whole numbers, which are"),
        ("parents", [False, True], "parents: holds truth values; expected whole numbers, "),
        ("parents", [[-1], [0, 0]], "parents: setting an array element with a sequence"),
        ("parents", [-1, 2**32], "parents: holds 4294967296; an index must lie in [-2^31, 2^31)"),
        ("body_joints", [0, -(2**31) - 1], "body_joints: holds -2147483649; an index must lie"),
    ],
)
def test_an_array_of_the_wrong_kind_is_refused_by_name(name: str, value: Any, message: str) -> None:
    with pytest.raises(ValueRangeError) as caught:
        replace(synthetic_chain(2), **{name: value})
    assert str(caught.value).startswith(message)


def test_leaders_beyond_32_bits_are_refused_and_never_wrapped() -> None:
    with pytest.raises(ValueRangeError, match=r"^leaders: holds 4294967296; an index must lie"):
        MimicJoints(("f",), np.array([2**32]), np.ones(1), np.zeros(1))
    with pytest.raises(ValueRangeError, match=r"^multiplier: holds truth values; expected numbers"):
        MimicJoints(("f",), np.array([0]), np.array([True]), np.zeros(1))
    with pytest.raises(ValueRangeError, match=r"^hi: holds complex entries; expected numbers"):
        Bounded(np.zeros(1), np.zeros(1), np.array([1j]))
