"""Settings of a description, resolved for the joints of its robot."""

from __future__ import annotations

from typing import Any

from modrobust import build_robot
from modrobust.model import LoopSettings

CHAIN: list[Any] = [
    {"joint": "turn", "type": "revolute"},
    {"body": "arm", "mass": 2, "com": [0.1, 0, 0], "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}},
    {"joint": "slide", "type": "prismatic"},
    {"body": "hand", "mass": 1, "com": [0.1, 0, 0], "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}},
]


def test_a_robot_without_a_loop_has_the_default_one():
    assert build_robot("two", CHAIN).loop == LoopSettings()


def test_a_robot_has_the_loop_of_its_description():
    loop = {
        "rate": 500,
        "delay": 1,
        "saturation": True,
        "noise": {"position": {"turn": "0.1 deg", "slide": "1 mm"}, "velocity": 0.01},
    }
    assert build_robot("two", CHAIN, loop=loop).loop == LoopSettings(
        rate=500.0,
        delay=1.0,
        saturation=True,
        noise_position=(0.0017453292519943296, 0.001),
        noise_velocity=(0.01, 0.01),
    )


def test_a_robot_has_the_controller_of_its_description():
    settings = build_robot("two", CHAIN, controller={"G": 40, "predictor": False}).controller
    assert (settings.law, settings.G, settings.Lambda, settings.predictor) == (
        *("sampled", 40.0, 20.0),
        False,
    )
    for controller in (None, "auto", {"epsilon": 0.01}):
        assert build_robot("two", CHAIN, controller=controller).controller.law == "auto"
