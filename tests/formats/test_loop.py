"""The ``loop:`` of an assembly file, and noise and quantisation on one line."""

from __future__ import annotations

import pytest

from modrobust.errors import DescriptionError, ModrobustError, SeveralFaultsError
from modrobust.formats import load_assembly
from modrobust.formats.loop import parse_noise, parse_quantisation
from modrobust.model import LoopSettings
from support.formats.format_samples import ASSEMBLY

NAMES = ("arm.axis", "tool.slide")
TYPES = ("revolute", "prismatic")
LINE = ASSEMBLY.count("\n") + 1


def load(text):
    with open("r.yaml", "w", encoding="utf-8") as file:
        file.write(f"{ASSEMBLY}loop: {text}\n")
    return load_assembly("r.yaml").loop


@pytest.fixture(autouse=True)
def _in_an_empty_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the messages name the file as it was given


def test_without_a_loop_the_defaults_hold():
    with open("r.yaml", "w", encoding="utf-8") as file:
        file.write(ASSEMBLY)
    assert load_assembly("r.yaml").loop.resolve(NAMES, TYPES) == LoopSettings()


def test_all_keys_of_a_loop_are_read():
    loop = load(
        "{rate: 2 kHz, delay: 0.5, noise: {position: 1e-4, velocity: 1e-2, sign: worst}, "
        "quantisation: {position: {arm.axis: 0.01 deg, tool.slide: 0.1 mm}}, saturation: true, "
        "disturbance: sine, frequency: 3 Hz}"
    )
    assert loop.resolve(NAMES, TYPES) == LoopSettings(
        rate=2000.0,
        delay=0.5,
        noise_position=(1e-4, 1e-4),
        noise_velocity=(1e-2, 1e-2),
        noise="worst",
        quantisation_position=(1.7453292519943296e-4, 1e-4),
        saturation=True,
        disturbance="sine",
        frequency=3.0,
    )


def test_a_velocity_is_differentiated_with_a_filter():
    loop = load("{velocity: differentiated, filter: 0.05 kHz}").resolve(NAMES, TYPES)
    assert (loop.velocity, loop.filter) == ("differentiated", 50.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{rat: 1 kHz}", 'loop: unknown key "rat"; did you mean "rate"? known: rate, delay, noise'),
        ("{rate: 0}", "loop.rate: 0 is not positive; it must be above 0; write a positive number"),
        ("{rate: 1 khz}", 'loop.rate: "1 khz": unknown unit "khz"; did you mean "kHz"? known: m,'),
        (
            "{rate: 1 ms}",
            'loop.rate: "1 ms" has the unit "ms"; a frequency [Hz] is expected; write it in Hz',
        ),
        (
            "{delay: 2}",
            "loop.delay: 2 periods; a command acts 0 to 1 periods late; write a number in [0, 1], "
            "or the rate at which it is so",
        ),
        ("{delay: -0.1}", "loop.delay: -0.1 periods; a command acts 0 to 1 periods late; "),
        (
            "{delay: 1 ms}",
            'loop.delay: "1 ms" has the unit "ms"; a number without unit is expected; leave the '
            "unit out",
        ),
        ("{noise: 1e-4}", 'loop.noise: "1e-4"; a mapping is expected; write its keys: position,'),
        (
            "{noise: {sign: worst}}",
            'loop.noise: neither "position" nor "velocity"; it is of one of them or both; '
            "add position",
        ),
        ("{noise: {position: -1}}", "loop.noise.position: -1 is negative; it is at least 0; "),
        (
            "{noise: {position: 1 kg}}",
            'loop.noise.position: "1 kg" has the unit "kg"; an angle [rad] or a length [m] is '
            "expected; write it in rad or m",
        ),
        (
            "{noise: {position: 1, sign: wost}}",
            'loop.noise.sign: "wost" is not allowed here; did you mean "worst"? known: uniform, '
            "worst",
        ),
        ("{quantisation: {position: 1, sign: worst}}", 'loop.quantisation: unknown key "sign"; '),
        (
            "{filter: 100 Hz}",
            "loop.filter: without velocity: differentiated; a measured velocity is not filtered; "
            "remove it or write velocity: differentiated",
        ),
        (
            "{frequency: 1 Hz}",
            "loop.frequency: beside disturbance: constant; it is the frequency of a sine; remove "
            "it or write disturbance: sine",
        ),
        (
            "{velocity: differentiated, noise: {velocity: 1}}",
            "loop.noise.velocity: beside velocity: differentiated; such a velocity has the errors "
            "of the position; remove it",
        ),
        (
            "{velocity: differentiated, quantisation: {position: 1, velocity: 1}}",
            "loop.quantisation.velocity: beside velocity: differentiated; ",
        ),
        ("{saturation: yes}", 'loop.saturation: "yes"; true or false is expected; write one of'),
        (
            "{disturbance: wurst}",
            'loop.disturbance: "wurst" is not allowed here; did you mean "worst"?',
        ),
        ("1 kHz", 'loop: "1 kHz"; a mapping is expected; write its keys: rate, delay, noise, '),
    ],
)
def test_a_loop_is_refused_for(text, message):
    with pytest.raises(DescriptionError) as caught:
        load(text)
    assert str(caught.value).startswith(f"r.yaml:{LINE}: {message}")


def test_all_faults_of_a_loop_are_told_in_one_reading():
    with pytest.raises(SeveralFaultsError) as caught:
        load("{rate: 0, delay: 2, noise: {position: -1}, filter: 1}")
    fields = ["loop.rate", "loop.delay", "loop.noise.position", "loop.filter"]
    assert [fault.field for fault in caught.value.faults] == fields


def test_noise_of_a_joint_that_is_not_there_is_refused_when_resolved():
    loop = load("{noise: {position: {arm.axes: 1, tool.slide: 1}}}")
    with pytest.raises(DescriptionError, match=r'no joint named "arm\.axes"; did you mean'):
        loop.resolve(NAMES, TYPES)


def test_noise_on_one_line_is_that_of_a_file():
    text = "position=1e-4, velocity={arm.axis: 1e-2 rad/s, tool.slide: 1 mm/s}, sign=worst"
    found = parse_noise(text, "--noise", NAMES, TYPES)
    assert found == {
        "noise_position": (1e-4, 1e-4),
        "noise_velocity": (1e-2, 1e-3),
        "noise": "worst",
    }
    written = load("{noise: {position: 1e-4, velocity: {arm.axis: 1e-2, tool.slide: 1e-3}}}")
    assert written.resolve(NAMES, TYPES) == LoopSettings(**{**found, "noise": "uniform"})


def test_noise_and_quantisation_of_one_signal_are_none_of_the_other():
    assert parse_noise({"velocity": 0.01}, "noise", NAMES, TYPES) == {
        "noise_position": (),
        "noise_velocity": (0.01, 0.01),
        "noise": "uniform",
    }
    assert parse_quantisation("position=1e-4", "quantisation", NAMES, TYPES) == {
        "quantisation_position": (1e-4, 1e-4),
        "quantisation_velocity": (),
    }


def test_none_is_no_noise_whatever_a_file_has():
    assert parse_noise("none", "noise", NAMES, TYPES)["noise_position"] == ()
    assert parse_quantisation("none", "quantisation", NAMES, TYPES)["quantisation_velocity"] == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1e-4", '--noise: "1e-4": "1e-4" is no key=value; write "key=value, key=value" with '),
        ("positon=1", '--noise: unknown key "positon"; did you mean "position"? known: position,'),
        ("position=-1", "--noise.position: -1 is negative; it is at least 0; write 0 or more"),
        (
            "position=1e-4 rad",
            '--noise.position (joint tool.slide): "1e-4 rad" has the unit "rad"; a length [m] is '
            "expected; write it in m",
        ),
        ("sign=worst", '--noise: neither "position" nor "velocity"; it is of one of them'),
    ],
)
def test_noise_on_one_line_is_refused_for(text, message):
    with pytest.raises(ModrobustError) as caught:
        parse_noise(text, "--noise", NAMES, TYPES)
    assert str(caught.value).startswith(message)
