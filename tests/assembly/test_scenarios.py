"""Named scenarios: points inside the bounds, nominal where not set."""

import numpy as np
import pytest

from support.small_modules import message

CHAIN = """
chain:
  - module: hinge
    set:
      rotor.mass: 0.7 kg ± 10%
      rotor.com: [-20 mm ± 5 mm, 5 mm, 1 mm]
      rotor.inertia.yz: -2e-4 ± 1e-5
      axis.friction: {viscous: 3 N m s/rad ± 20%}
      axis.drive: {gear_ratio: 100, rotor_inertia: "[1e-5, 2e-5]"}
payload: {mass: [0 kg, 2 kg], com: [0, 0, 0.1]}
scenarios:
  heavy:
    set:
""".replace('"', "")


def scenario(*lines):
    return CHAIN + "".join(f"      {line}\n" for line in lines)


def test_what_is_set_takes_its_value_and_the_rest_is_nominal(load):
    robot = load(
        scenario(
            "hinge.rotor.mass: 0.75 kg",
            "hinge.rotor.com: [-16 mm, 5 mm, 1 mm]",
            "hinge.rotor.inertia.yz: -2.05e-4",
            "hinge.axis.friction.viscous: 2.5",
            "hinge.axis.drive.rotor_inertia: 2e-5",
            "payload.mass: 2 kg",
        )
    )
    point, nominal = robot.scenarios["heavy"], robot.nominal
    k = robot.body_names.index("hinge.rotor")
    assert point.mass.tolist() == [1.0, 0.75, 2.0]
    np.testing.assert_array_equal(point.com[k], [-0.016, 0.005, 0.001])
    assert point.inertia[k, 1, 2] == point.inertia[k, 2, 1] == -2.05e-4
    assert point.viscous.tolist() == [2.5]
    assert point.rotor_inertia.tolist() == [2e-5]
    np.testing.assert_array_equal(point.com[0], nominal.com[0])
    np.testing.assert_array_equal(point.inertia[k].diagonal(), nominal.inertia[k].diagonal())
    np.testing.assert_array_equal(point.coulomb, nominal.coulomb)


def test_the_ends_of_the_bounds_belong_to_them(load):
    for value in ("0.63 kg", "0.77 kg"):
        assert load(scenario(f"hinge.rotor.mass: {value}")).scenarios["heavy"].mass[1] > 0


def test_a_scenario_outside_its_bounds_is_refused(load):
    assert message(load, scenario("hinge.rotor.mass: 0.78 kg")) == (
        "arm.yaml:16: scenarios.heavy.set.hinge.rotor.mass: 0.78 lies outside the bounds "
        "[0.63, 0.77] of the description; a scenario is a robot that the bounds cover; widen them "
        "or change the value"
    )


def test_a_scenario_below_its_lower_bound_is_refused(load):
    assert "0.62 lies outside the bounds [0.63, 0.77]" in message(
        load, scenario("hinge.rotor.mass: 0.62 kg")
    )
    assert "1.9 lies outside the bounds" in message(
        load, scenario("hinge.axis.friction.viscous: 1.9")
    )


def test_an_exact_parameter_can_only_be_set_to_itself(load):
    assert load(scenario("hinge.stator.mass: 1 kg")).n == 1
    assert "lies outside the bounds [1, 1]" in message(load, scenario("hinge.stator.mass: 1.1 kg"))


def test_a_path_that_names_no_parameter_is_refused(load):
    assert message(load, scenario("hinge.roter.mass: 0.7 kg")) == (
        "arm.yaml:16: scenarios.heavy.set.hinge.roter.mass: no parameter of that name; did you "
        'mean "hinge.rotor.mass"? a path is instance.body.mass, .com or .inertia.xx, or '
        "instance.joint.friction.viscous, .friction.coulomb or .drive.rotor_inertia"
    )


def test_friction_that_the_module_does_not_have_cannot_be_set(load):
    text = scenario("hinge.axis.friction.coulomb: 1 N m")
    assert "no parameter of that name" in message(load, text)


@pytest.mark.parametrize("value", ["5 mm", "[1 mm, 2 mm]"])
def test_a_centre_of_mass_is_set_as_three_lengths(load, value):
    assert message(load, scenario(f"hinge.rotor.com: {value}")) == (
        "arm.yaml:16: scenarios.heavy.set.hinge.rotor.com: not a list of 3 lengths; a centre of "
        "mass is [x, y, z]; give three"
    )


def test_a_wrong_unit_in_a_scenario_is_refused(load):
    assert message(load, scenario("hinge.rotor.mass: 0.7 m")).startswith(
        "arm.yaml:16: scenarios.heavy.set.hinge.rotor.mass: "
    )


def test_a_scenario_with_an_impossible_tensor_is_remarked(load):
    text = """
chain: [{module: hinge, set: {rotor.inertia.xx: 0.001 ± 0.0009}}]
scenarios: {thin: {set: {hinge.rotor.inertia.xx: 1e-4}}}
"""
    robot = load(text)
    assert robot.notes[0] == "scenario thin: hinge.rotor has a tensor that no rigid body has"
