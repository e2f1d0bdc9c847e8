"""Tolerances, payloads and locks as Python mappings: the same robots as their texts give."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from support.urdf_texts import two_links, written


def resolved(path: Path, **options: Any) -> dict[str, Any]:
    return mr.load_robot(path, **options).to_dict()


@pytest.mark.parametrize(
    ("text", "mapping"),
    [
        ("mass=5%,com=5mm", {"mass": "5%", "com": "5 mm"}),
        ("inertia=10%", {"inertia": "10%"}),
        ("com=0.005", {"com": 0.005}),
        ("com=0.005", {"com": np.float64(0.005)}),
    ],
)
def test_a_tolerance_as_a_mapping_is_that_of_the_text(tmp_path: Path, text, mapping) -> None:
    path = written(tmp_path, two_links())
    assert resolved(path, tolerance=mapping) == resolved(path, tolerance=text)


@pytest.mark.parametrize(
    "mapping",
    [
        {"mass": ["0 kg", "2 kg"], "com": [0, 0, "50 mm"], "at": "arm"},
        {"mass": [0, 2], "com": np.array([0.0, 0.0, 0.05]), "at": "arm"},
        {"mass": {"nominal": 1, "lo": 0, "hi": 2.0}, "com": (0, 0, 0.05), "at": "arm"},
    ],
)
def test_a_payload_as_a_mapping_is_that_of_the_text(tmp_path: Path, mapping) -> None:
    path = written(tmp_path, two_links())
    text = "mass=[0 kg, 2 kg], com=[0, 0, 50 mm], at=arm"
    assert resolved(path, payload=mapping) == resolved(path, payload=text)


BAD = [
    ({"tolerance": 5}, "tolerance: 5; must be a text or a mapping; such as "),
    ({"tolerance": {}}, "tolerance: an empty mapping; such as "),
    ({"tolerance": {5: "5%"}}, "tolerance: key 5; keys are texts; quote it"),
    ({"tolerance": {"mass": None}}, "tolerance.mass: None; must be a number, a text such as "),
    ({"tolerance": {"mass": True}}, 'tolerance.mass: "true" is not a number; a quantity is '),
    ({"tolerance": {"mas": "5%"}}, 'tolerance: unknown key "mas"; did you mean "mass"?'),
    ({"tolerance": {"mass": float("nan")}}, 'tolerance.mass: "nan" is not a number; '),
    ({"tolerance": {"mass": "5 %x"}}, 'tolerance.mass: "5 %x"'),
    ({"payload": ["1 kg"]}, "payload: ['1 kg']; must be a text or a mapping; such as "),
    ({"payload": {"mass": 1, "com": [0, 0]}}, "payload.com: a list of 2; a vector is a list"),
    ({"payload": {"mass": 1, "com": [0, {0}, 0]}}, "payload.com[1]: {0}; must be a number, "),
    ({"lock": {"turm": 0}}, 'lock.turm: no joint named "turm"; did you mean "turn"?'),
    ({"lock": {"turn": [1]}}, "lock.turn: a list; one number without bounds is expected; "),
    ({"tip": "amr"}, 'tip: tip_link: no link named "amr"; did you mean "arm"?'),
    ({"tolerance": "mass"}, 'tolerance: "mass": "mass" is no key=value; '),
]


@pytest.mark.parametrize(("options", "message"), BAD)
def test_what_is_no_tolerance_payload_or_lock_is_refused_by_name(
    tmp_path: Path, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot(written(tmp_path, two_links()), **options)
    assert str(caught.value).startswith(message)
    assert "--" not in str(caught.value)


def test_what_is_nested_without_end_is_refused(tmp_path: Path) -> None:
    loop: dict[str, Any] = {}
    loop["mass"] = loop
    with pytest.raises(mr.ModrobustError, match="more than 8 levels deep"):
        mr.load_robot(written(tmp_path, two_links()), payload=loop)


def test_a_robot_of_modules_names_the_argument_and_no_option() -> None:
    with pytest.raises(mr.ModrobustError) as caught:
        mr.load_robot("lwa4p-paper", tolerance={"mass": "5%"})
    assert str(caught.value).startswith("tolerance: a robot of modules; ")
