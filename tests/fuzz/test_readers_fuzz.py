"""A short run of the readers' fuzz target; `make fuzz` goes on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from fuzz import readers_fuzz
from fuzz.reader_seeds import TIMOR

HERE = Path(__file__).parent
SECONDS = 60


def test_no_reader_raises_anything_but_our_errors(tmp_path: Path) -> None:
    answer = subprocess.run(
        [sys.executable, HERE / "readers_fuzz.py", tmp_path, f"--seconds={SECONDS}"],
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    assert answer.returncode == 0, answer.stdout
    seeds, grown = (len(os.listdir(tmp_path / name)) for name in ("seeds", "grown"))
    assert seeds > 50
    assert grown > 50


def test_an_exception_that_is_not_ours_is_a_bug(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def careless(file: Path) -> None:
        readers_fuzz.read_quantity(file)
        if "kg" in file.read_text():
            raise KeyError("kg")

    (tmp_path / "assemblies").mkdir()
    monkeypatch.setitem(readers_fuzz.READERS, b"q", ("assemblies/quantity", careless))
    ways, problem = readers_fuzz.ways_of(b"q5 kg", tmp_path)
    assert isinstance(problem, KeyError)
    more, problem = readers_fuzz.ways_of(b"q5 mm +- 2 %", tmp_path)
    assert problem is None
    assert more - ways  # another way through the grammar


@pytest.mark.parametrize(
    "data",
    [
        b"amodrobust: 1\nrobot: robot\nmodules: " + b"9" * 400 + b"\nchain: [a]\n",
        b"t" + json.dumps(TIMOR).replace("0.01", "1e309").encode(),
        b"t" + json.dumps(TIMOR).replace("[1, 0", "[1e309, 0").encode(),
    ],
    ids=["a name that is too long", "a tensor beyond a double", "a pose beyond a double"],
)
def test_what_fuzzing_found_once_is_refused(data: bytes, tmp_path: Path) -> None:
    (tmp_path / "assemblies").mkdir()
    assert b"9" * 400 in data or b"1e309" in data
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        readers_fuzz.read(data, tmp_path)
