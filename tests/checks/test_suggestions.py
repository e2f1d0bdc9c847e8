"""Words for a name that is not known."""

from __future__ import annotations

import pytest

from modrobust.checks import did_you_mean, unknown_name

KNOWN = ("elbow", "Wrist")


@pytest.mark.parametrize(
    ("name", "meant"), [("elbwo", "elbow"), ("WRIST", "Wrist"), ("gripper", None), (7, None)]
)
def test_a_close_name_is_suggested(name: object, meant: str | None) -> None:
    assert did_you_mean(name, KNOWN) == (f'did you mean "{meant}"? ' if meant else "")


def test_the_message_has_what_was_found_what_was_meant_and_what_is_known() -> None:
    assert unknown_name('no joint "elbwo"', "elbwo", KNOWN) == (
        'no joint "elbwo"; did you mean "elbow"? known: elbow, Wrist'
    )
    assert unknown_name('no joint "hip"', "hip", iter(KNOWN)) == (
        'no joint "hip"; known: elbow, Wrist'
    )
    assert unknown_name('no joint "hip"', "hip", ()) == 'no joint "hip"; known: none'
