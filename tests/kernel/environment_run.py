"""Computes pickled cases in a hostile floating-point environment; run by test_environment.py.

Arguments: the library of environment.c, an environment, the folder of the pickled cases. Prints, as
JSON, what differs from the results in the file and which calls changed the environment.
"""

from __future__ import annotations

import ctypes
import json
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from support.kernel.kernel_cases import by_extension, differences, outcome
from support.kernel.python_cases import from_python


def main(library: str, kind: str, folder: str) -> None:
    fenv = ctypes.CDLL(library)
    fenv.environment.restype = ctypes.c_uint64
    changed: list[str] = []

    def run(call: Callable[..., Any], *arguments: Any) -> Any:
        """Makes one call in the environment; "given" is the one that the process came with."""
        if kind != "given":
            fenv[f"be_{kind}"]()
        before = fenv.environment()
        result = outcome(call, *arguments)
        after = fenv.environment()
        if kind != "given":
            fenv.be_normal()
        if before != after:
            changed.append(f"{getattr(call, '__name__', call)}: {before:x} to {after:x}")
        return result

    wrong: list[str] = []
    cases, in_python = pickle.loads((Path(folder) / "cases").read_bytes())
    for robot, state, expected in cases:
        found = by_extension(robot, state, run)
        wrong += [f"{robot.name} {name}" for name in differences(expected, found)]
    found = from_python(Path(folder), run)
    wrong += [name for name in in_python if found[name] != in_python[name]]
    print(json.dumps({"wrong": wrong, "changed": changed, "was": fenv.environment()}))


main(*sys.argv[1:])
