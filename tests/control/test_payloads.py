"""A controller that counts on another payload from one tick to the next."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.model import Robot

BOX = {"mass": "[1.5 kg, 2.5 kg]", "com": ["0", "0", "[40 mm, 60 mm]"]}


@pytest.fixture(scope="module")
def robot() -> Robot:
    """The catalogue's arm with an empty hand or a box in it."""
    arm = mr.load_robot("lwa4p-payload")
    last = arm.b - 1  # the payload's body

    def with_mass(point: mr.Parameters, mass: float) -> mr.Parameters:
        masses = point.mass.copy()
        masses[last] = mass
        return replace(point, mass=masses)

    assert arm.lower.mass[last] < arm.upper.mass[last]
    half = 0.5 * (arm.lower.mass[last] + arm.upper.mass[last])
    heavy = (with_mass(arm.nominal, half), with_mass(arm.lower, half), arm.upper)
    nominal = with_mass(arm.nominal, arm.lower.mass[last])
    light = (nominal, arm.lower, with_mass(arm.upper, half))
    return replace(arm, payloads={"light": light, "heavy": heavy})


def run(controller: mr.RobustController, ticks: int, offset: float = 1e-3) -> list[mr.Command]:
    q = np.full(controller.robot.n, 0.3)
    rest = np.zeros(controller.robot.n)
    return [controller.step(q, rest, q + offset, rest, rest) for _ in range(ticks)]


def test_the_next_set_is_that_of_the_payload(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="sampled", G=40.0, blend=0.0)
    run(controller, 3)
    controller.use("light")
    (command,) = run(controller, 1)
    nominal, lower, upper = robot.payloads["light"]
    own = replace(robot, nominal=nominal, lower=lower, upper=upper, payloads={})
    fresh = mr.RobustController(own, law="sampled", G=40.0, blend=0.0)
    (expected,) = run(fresh, 1)
    np.testing.assert_array_equal(command.nominal, expected.nominal)
    np.testing.assert_array_equal(command.phi_lo, expected.phi_lo)
    np.testing.assert_array_equal(command.phi_hi, expected.phi_hi)


def test_the_torque_does_not_jump_but_by_what_the_new_set_forbids(robot: Robot) -> None:
    stays = mr.RobustController(robot, law="sampled", G=40.0, blend=0.0)
    changes = mr.RobustController(robot, law="sampled", G=40.0, blend=0.0)
    for controller in (stays, changes):
        run(controller, 200)
    before = run(stays, 1)[0]
    changes.use("heavy")
    after = run(changes, 1)[0]
    n = robot.n
    sigma = changes.kernel.memory()[5][:n]
    inside = (after.phi_lo < sigma) & (sigma < after.phi_hi)
    assert inside.any()
    step = np.abs(after.nominal - before.nominal)[inside].max()
    assert step > 1e-3  # there is something to be hidden
    np.testing.assert_allclose(after.tau[inside], before.tau[inside], rtol=0, atol=1e-9)
    at_end = ~inside
    ends = np.where(sigma >= after.phi_hi, after.phi_hi, after.phi_lo)
    np.testing.assert_array_equal(sigma[at_end], ends[at_end])


def test_none_is_the_box_of_all_again(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="sampled", G=40.0, blend=0.0)
    (first,) = run(controller, 1)
    controller.use("light")
    run(controller, 1)
    controller.use(None)
    (again,) = run(controller, 1)
    np.testing.assert_array_equal(again.phi_lo, first.phi_lo)
    assert controller.payload is None


def test_integrals_of_the_paper_s_law_go_on(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="norm")
    run(controller, 50, 0.05)
    kappa = controller.kappa
    controller.use("heavy")
    run(controller, 1, 0.05)
    assert controller.kappa > kappa > controller.settings.kappa_P


@pytest.mark.parametrize("again", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_a_copy_counts_on_the_same_payload(robot: Robot, again: object) -> None:
    controller = mr.RobustController(robot, law="sampled", G=40.0)
    controller.use("light")
    run(controller, 2)
    twin = again(controller)  # type: ignore[operator]
    assert twin.payload == "light"
    for a, b in zip(run(controller, 3), run(twin, 3), strict=True):
        np.testing.assert_array_equal(a.tau, b.tau)


def test_an_unknown_payload_is_refused_and_changes_nothing(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="sampled", G=40.0)
    kernel = controller.kernel
    with pytest.raises(mr.ValueRangeError, match='did you mean "light"'):
        controller.use("ligth")
    assert controller.kernel is kernel
    with pytest.raises(mr.ValueRangeError, match="known: none"):
        mr.RobustController(replace(robot, payloads={})).use("light")


def test_a_command_that_fails_right_after_leaves_both_as_they_were(robot: Robot) -> None:
    controller = mr.RobustController(robot, law="sampled", G=40.0)
    run(controller, 20)
    controller.use("heavy")
    memory = controller.kernel.memory()
    bad = np.full(robot.n, np.nan)
    zero = np.zeros(robot.n)
    with pytest.raises(mr.ValueRangeError):
        controller.command(1.0, bad, zero, zero, zero, zero)
    np.testing.assert_array_equal(controller.kernel.memory()[5], memory[5])
    assert isinstance(controller.kernel, _kernel.Controller)
