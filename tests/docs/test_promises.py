"""Docstrings of the public numerics keep five promises, as tools/promises.py measures them."""

from __future__ import annotations

import importlib.util
import sys
from types import ModuleType

import pytest

from support.paths import ROOT


@pytest.fixture(scope="module")
def promises() -> ModuleType:
    path = ROOT / "tools" / "promises.py"
    spec = importlib.util.spec_from_file_location("promises", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["promises"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_every_promise_is_kept(promises: ModuleType) -> None:
    counts, missing = promises.measured()
    assert missing == []
    assert all(kept == due for kept, due in counts.values())
    assert min(due for _, due in counts.values()) > 15  # the rule leaves no promise empty


KEPT = """A torque.

.. math:: x = y

Args:
    q: Positions, ``(n,)`` [rad].
    tau, w: Torques,
        ``(k, n)`` [N m].
    count: How many.

Returns:
    Torques ``(n,)`` [N m].

Raises:
    ShapeError: A shape is wrong.

Source: (3) of [GA17].
"""


def public(promises: ModuleType, doc: str) -> object:
    given = {"q": "ArrayLike", "tau": "Array", "w": "Array", "count": "int"}
    return promises.Public("f", given, "Array", True, True, doc, {})


def broken(promises: ModuleType, doc: str) -> list[tuple[str, str]]:
    f = public(promises, doc)
    return [
        (promise, place)
        for promise in promises.PROMISES
        for place in promises.applies(f, promise)
        if not promises.kept(f, promise, place)
    ]


def test_a_docstring_that_keeps_them_all_passes(promises: ModuleType) -> None:
    assert broken(promises, KEPT) == []


@pytest.mark.parametrize(
    ("cut", "instead", "promise", "place"),
    [
        (".. math:: x = y", "", "equation", "whole"),
        ("Source: ", "", "source", "whole"),
        ("ShapeError", "KeyError", "errors", "whole"),
        ("Raises:\n    ShapeError: A shape is wrong.", "", "errors", "whole"),
        ("Positions, ``(n,)``", "Positions", "shape", "q"),
        ("``(n,)`` [rad]", "``(n,)``", "unit", "q"),
        ("``(k, n)``", "", "shape", "tau"),
        ("Torques ``(n,)``", "Torques", "shape", "result"),
        ("``(n,)`` [N m].\n\nRaises", "``(n,)`` [GA17].\n\nRaises", "unit", "result"),
    ],
)
def test_a_docstring_that_lacks_one_is_found(
    promises: ModuleType, cut: str, instead: str, promise: str, place: str
) -> None:
    assert cut in KEPT
    doc = KEPT.replace(cut, instead)
    if promise == "equation":  # the number in the source line would do
        doc = doc.replace("(3)", "")
    assert (promise, place) in broken(promises, doc)
