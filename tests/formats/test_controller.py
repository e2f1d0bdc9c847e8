"""The ``controller:`` of an assembly file: the law, and settings that this law has."""

from __future__ import annotations

import math

import pytest

from modrobust.assembly.settings import controller_settings
from modrobust.errors import DescriptionError, SeveralFaultsError
from modrobust.formats import load_assembly
from modrobust.model import ControllerSettings
from support.formats.format_samples import ASSEMBLY

OWN = "controller: {law: norm, K_r: 10, kappa_P: 2, epsilon: 0.01 rad}"
NAMES = ("arm.axis", "tool.axis")
TYPES = ("revolute", "revolute")


def load(text):
    assert OWN in ASSEMBLY
    line = "" if text is None else f"controller: {text}"
    with open("r.yaml", "w", encoding="utf-8") as file:
        file.write(ASSEMBLY.replace(OWN, line))
    return controller_settings(load_assembly("r.yaml").controller, NAMES, TYPES)


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the messages name the file as it was given


def test_the_bare_word_auto_is_the_law_auto_with_its_epsilon():
    assert load("auto") == load("{law: auto}") == load("{law: auto, epsilon: 0.01 rad}")
    assert (load("auto").law, load("auto").epsilon) == ("auto", 0.01)


@pytest.mark.parametrize(
    "text", [None, "{}", "{epsilon: 0.02}", "{bound: ianea}", "{integral: off}"]
)
def test_where_no_gains_are_written_the_law_is_auto(text):
    assert load(text).law == "auto"


@pytest.mark.parametrize(
    "text", ["{K_r: 20}", "{kappa_P: 1}", "{phi_max: 9}", "{leak: 1}", "{hold_aware: true}"]
)
def test_a_setting_of_norm_makes_the_law_norm(text):
    assert load(text).law == "norm"


def test_settings_of_norm_are_read_and_the_rest_is_that_of_the_paper():
    settings = load(
        "{law: componentwise, K_r: {arm.axis: 20, tool.axis: 30}, kappa_max: 50, phi_max: 500, "
        "leak: 0.1 1/s, hold_aware: true}"
    )
    assert settings == ControllerSettings(
        K_r=(20.0, 30.0),
        law="componentwise",
        kappa_max=50.0,
        phi_max=500.0,
        leak=0.1,
        hold_aware=True,
    )
    assert math.isinf(load("{law: norm}").kappa_max)


def test_the_gain_of_sampled_gives_the_others():
    assert load("{G: 40}") == ControllerSettings(
        K_r=(20.0, 20.0), law="sampled", G=40.0, Lambda=20.0, L_i=80.0
    )


def test_settings_of_sampled_are_read():
    settings = load(
        "{law: sampled, bound: ianea, G: 40 1/s, Lambda: 10, L_i: 0 1/s^2, blend: 300 ms, "
        "integral: off, predictor: false, vector_saturation: false, epsilon: 2 mm}"
    )
    assert settings == ControllerSettings(
        K_r=(10.0, 10.0),
        law="sampled",
        bound="ianea",
        epsilon=0.002,
        G=40.0,
        Lambda=10.0,
        L_i=0.0,
        blend=0.3,
        integral=False,
        predictor=False,
        vector_saturation=False,
    )


def test_parts_of_sampled_can_be_left_out_of_the_law_auto():
    assert load("{law: auto, integral: off}").integral is False


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "atuo",
            'controller: "atuo"; a controller is auto or a mapping of its settings; write "auto", '
            "or e.g. law: norm in a mapping",
        ),
        ("[auto]", "controller: a list; a mapping is expected; write its keys: law, bound, "),
        (
            "{law: sampeld, G: 1}",
            'controller.law: "sampeld" is not allowed here; did you mean "sampled"? known: norm, '
            "componentwise, sampled, auto",
        ),
        (
            "{law: norm, G: 40}",
            "controller.G: beside law norm, which has no G; it is a setting of sampled; remove it "
            "or write law: sampled",
        ),
        (
            "{law: sampled, G: 40, K_r: 10}",
            "controller.K_r: beside law sampled, which has no K_r; it is a setting of norm and "
            "componentwise; remove it or write law: norm",
        ),
        (
            "{law: auto, G: 40}",
            "controller.G: beside law auto, which chooses it; it is a setting of sampled; remove "
            "it or write law: sampled",
        ),
        ("{law: auto, K_r: 10}", "controller.K_r: beside law auto, which has no K_r; it is a "),
        ("{K_r: 10, G: 40}", "controller.G: beside law norm, which has no G; "),
        (
            "{law: componentwise, integral: off}",
            "controller.integral: beside law componentwise, which has no integral; it is a "
            "setting of sampled; remove it or write law: sampled",
        ),
        (
            "{law: sampled}",
            'controller: law sampled and no "G"; its gains are for one loop and have no default; '
            "add G, or write law: auto, which chooses them",
        ),
        ("{blend: 1 s}", 'controller: law sampled and no "G"; '),
        ("{G: 0}", "controller.G: 0 is not positive; it must be above 0; write a positive number"),
        ("{G: 1, Lambda: -1}", "controller.Lambda: -1 is not positive; it must be above 0; "),
        ("{G: 1, L_i: -1}", "controller.L_i: -1 is negative; it is at least 0; write 0 or more"),
        (
            "{G: 1, L_i: 1 1/s}",
            'controller.L_i: "1 1/s" has the unit "1/s"; a rate of a rate [1/s^2] is expected; '
            "write it in 1/s^2",
        ),
        (
            "{G: 1, blend: -1 s}",
            "controller.blend: -1 is negative; it is at least 0; write 0 or more",
        ),
        (
            "{kappa_P: 3, kappa_max: 2.5}",
            "controller.kappa_max: 2.5 is below kappa_P = 3; kappa begins at kappa_P and grows to "
            "its ceiling; raise the ceiling or lower kappa_P",
        ),
        ("{phi_max: 0.5}", "controller.phi_max: 0.5 is below phi_P = 1 (its default); phi "),
        (
            "{phi_max: 0}",
            "controller.phi_max: 0 is not positive; it must be above 0; write a positive number",
        ),
        ("{leak: -1}", "controller.leak: -1 is negative; it is at least 0; write 0 or more"),
        (
            "{hold_aware: on}",
            'controller.hold_aware: "on"; true or false is expected; write one of them',
        ),
        (
            "{G: 1, integral: true}",
            'controller.integral: "true" is not allowed here; known: on, off',
        ),
    ],
)
def test_a_controller_is_refused_for(text, message):
    with pytest.raises(DescriptionError) as caught:
        load(text)
    assert str(caught.value).startswith(f"r.yaml:10: {message}")


def test_all_faults_of_a_controller_are_told_in_one_reading():
    with pytest.raises(SeveralFaultsError) as caught:
        load("{law: norm, kappa_P: -1, leak: -1, G: 1}")
    fields = ["controller.kappa_P", "controller.leak", "controller.G"]
    assert [fault.field for fault in caught.value.faults] == fields
