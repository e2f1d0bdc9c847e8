"""What belongs to the whole process is as it was: filters, handlers, modes, locale, hooks."""

from __future__ import annotations

import csv
import decimal
import gc
import locale
import logging
import os
import signal
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust import _kernel
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.simulation import simulate
from modrobust.timor import import_timor, write_modules
from support.timor_databases import database, powerball
from support.urdf_texts import two_links, written


def state() -> dict[str, Any]:
    environment = _kernel.enter_environment()
    _kernel.leave_environment(environment)
    known = set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}
    here: dict[str, Any] = {
        "warnings": list(warnings.filters),
        "signals": {number: signal.getsignal(number) for number in known},
        "environment": dict(os.environ),
        "directory": os.getcwd(),
        "locale": locale.setlocale(locale.LC_ALL),
        "numpy": (np.geterr(), repr(np.get_printoptions())),
        "random": np.random.get_state()[1].tolist(),  # type: ignore[index]  # noqa: NPY002
        "decimal": repr(decimal.getcontext()),
        "rounding": environment,
        "interpreter": (sys.getrecursionlimit(), sys.getswitchinterval(), gc.get_threshold()),
        "hooks": (sys.excepthook, sys.unraisablehook, sys.displayhook, sys.stdout, sys.stderr),
        "csv": csv.field_size_limit(),
        "logging": (logging.root.level, list(logging.root.handlers), logging.root.disabled),
    }
    if "mujoco" in sys.modules:
        mujoco = sys.modules["mujoco"]
        names = [name for name in dir(mujoco) if name.startswith(("get_mjcb", "get_mju"))]
        here["mujoco"] = {name: getattr(mujoco, name)() for name in names}
    return here


def everything(folder: Path) -> None:
    robot = mr.load_robot("lwa4p-payload")
    mr.load_robot(written(folder, two_links()))
    write_modules(import_timor(database(folder, powerball())), folder / "timor")
    urdf_text(robot, robot.nominal)
    mjcf_text(robot, robot.nominal)
    robot.sample_parameters(1)
    for plant in ("builtin", "mujoco", "pinocchio"):
        result = simulate(robot, plant=plant, duration=0.01, rate=2e3)
        result.save(folder / "run.npz")
        assert result.summary()


def test_nothing_of_the_process_is_changed(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    pytest.importorskip("pinocchio")
    for name in ("first", "second"):  # packages may set what they like when they are imported
        (tmp_path / name).mkdir()
    everything(tmp_path / "first")
    before = state()
    everything(tmp_path / "second")
    after = state()
    assert before.keys() == after.keys()
    for name, value in before.items():
        assert after[name] == value, name


def test_nothing_of_the_process_is_changed_while_a_step_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Another thread would see it then."""
    mujoco = pytest.importorskip("mujoco")
    robot = mr.load_robot("lwa4p-payload")
    before: dict[str, Any] = {}
    seen = 0
    inner = mujoco.mj_rne

    def watched(*arguments: Any) -> None:
        nonlocal seen
        now = state()
        seen += 1
        for name in before.keys() - {"rounding"}:
            assert now[name] == before[name], name
        inner(*arguments)

    monkeypatch.setattr(mujoco, "mj_rne", watched)
    before.update(state())
    simulate(robot, plant="mujoco", duration=0.002, rate=2e3)
    assert seen > 0
