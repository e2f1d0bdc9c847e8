"""A simulated run in MuJoCo's viewer, in real time, again and again until the window is closed."""

from __future__ import annotations

import os
import sys
import time

import numpy as np

from modrobust.errors import MissingExtraError
from modrobust.pictures.scene import joint_places, scene_model
from modrobust.simulation import SimulationResult
from modrobust.simulation.plants import engine

_RATE = 60.0  # [pictures/s]
_PAUSE = 1.0  # [s], between the end and the next beginning


def check_viewer() -> None:
    """Refuse a viewer that could not open, before a run starts.

    Raises:
        MissingExtraError: mujoco is not installed, or there is no screen.
    """
    engine("mujoco", "mujoco", "view")
    shown = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform == "linux" and not shown:
        raise MissingExtraError(
            "view: there is no screen (neither DISPLAY nor WAYLAND_DISPLAY is set); "
            "run it on a desktop, or save a video of it"
        )
    if sys.platform == "darwin" and not os.environ.get("MJPYTHON_BIN"):
        raise MissingExtraError(
            "view: MuJoCo's viewer needs its own Python on macOS; run "
            "mjpython instead of python, or save a video of it"
        )


def view(result: SimulationResult, *, rounds: int | None = None) -> None:
    """Show the run until the window is closed, or `rounds` times.

    Raises:
        MissingExtraError: mujoco is not installed, or the window cannot be opened.
    """
    check_viewer()
    mujoco = engine("mujoco", "mujoco", "view")
    finite = np.isfinite(result.q).all(axis=1)
    t, q = result.t[finite], result.q[finite]
    if not len(t):
        return
    robot = result.robot
    model, _, camera = scene_model(mujoco, robot, q[:: max(1, len(q) // 100)], result.parameters)
    data, places = mujoco.MjData(model), joint_places(model, robot)
    try:
        viewer = engine("mujoco.viewer", "mujoco", "view")
        window = viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False)
    except (RuntimeError, mujoco.FatalError) as problem:
        raise MissingExtraError(
            f"view: the window cannot be opened ({problem}); "
            "check the screen and its OpenGL, or save a video of it"
        ) from None
    with window:
        for name in ("lookat", "distance", "azimuth", "elevation"):
            setattr(window.cam, name, getattr(camera, name))
        done = 0
        while window.is_running() and (rounds is None or done < rounds):
            begin = time.monotonic()
            while window.is_running():
                now = time.monotonic() - begin
                k = min(int(np.searchsorted(t - t[0], now)), len(t) - 1)
                data.qpos[places] = robot.all_positions(q[k])
                mujoco.mj_forward(model, data)
                window.sync()
                if now > t[-1] - t[0] + _PAUSE:
                    break
                time.sleep(1.0 / _RATE)
            done += 1
