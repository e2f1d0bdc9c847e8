"""The viewer plays a run from its beginning to its end; without a screen a message says so."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import MissingExtraError
from modrobust.pictures.viewer import check_viewer, view
from modrobust.simulation import simulate


class Window:
    """What MuJoCo's window looks like to us; it keeps what it was shown."""

    def __init__(self, data: Any) -> None:
        self.data, self.cam = data, SimpleNamespace()
        self.shown: list[Any] = []

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *exception: object) -> None:
        self.closed = True

    def is_running(self) -> bool:
        return True

    def sync(self) -> None:
        self.shown.append(self.data.qpos.copy())


def test_the_run_is_played_from_beginning_to_end(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    windows: list[Window] = []

    def launch(model: Any, data: Any, **options: Any) -> Window:
        windows.append(Window(data))
        return windows[-1]

    monkeypatch.setitem(sys.modules, "mujoco.viewer", SimpleNamespace(launch_passive=launch))
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("modrobust.pictures.viewer._PAUSE", 0.1)
    result = simulate(mr.load_robot("lwa4p-payload"), duration=0.3, rate=3e3)
    view(result, rounds=1)
    (window,) = windows
    assert len(window.shown) > 3
    np.testing.assert_allclose(window.shown[0], result.q[0], atol=0.05)
    np.testing.assert_array_equal(window.shown[-1], result.q[-1])
    assert window.closed
    assert window.cam.distance > 0.5


@pytest.mark.skipif(sys.platform != "linux", reason="screens are named in DISPLAY on Linux only")
def test_without_a_screen_the_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(MissingExtraError) as caught:
        check_viewer()
    assert str(caught.value) == (
        "view: there is no screen (neither DISPLAY nor WAYLAND_DISPLAY is set); "
        "run it on a desktop, or save a video of it"
    )


def test_without_mujoco_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r'pip install "modrobust\[mujoco\]"'):
        check_viewer()


def test_a_window_that_cannot_open_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")

    def launch(*_: Any, **options: Any) -> None:
        raise RuntimeError("could not create window")

    monkeypatch.setitem(sys.modules, "mujoco.viewer", SimpleNamespace(launch_passive=launch))
    monkeypatch.setenv("DISPLAY", ":0")
    result = simulate(mr.load_robot("lwa4p-payload"), duration=0.01, rate=3e3)
    with pytest.raises(MissingExtraError, match=r"cannot be opened \(could not create window\)"):
        view(result, rounds=1)
