"""``modrobust bench --peers`` where a compiler is missing; the rest may or may not be installed."""

from __future__ import annotations

import json

import pytest


def test_a_peer_that_is_missing_is_named_and_the_others_are_measured(
    run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    result = run("bench", "lwa4p-paper", "--peers", "--json")
    assert result.returncode == 0
    assert "comparison in C: no compiler no-such-compiler on this machine" in result.stderr
    (robot,) = json.loads(result.stdout)
    assert robot["robot"] == "lwa4p-paper"
    assert "Pinocchio, C++" in robot["absent"]
    named = [*robot["absent"], *(item["peer"] for item in robot["peers"])]
    assert sorted(named) == ["NumPy, Algorithm 1", "Pinocchio, C++", "Pinocchio, Python"]
