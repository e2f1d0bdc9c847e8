"""The run as a moving picture: what is drawn, what is written, what is said where it cannot be."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import FileError, MissingExtraError, ValueRangeError
from modrobust.model import Robot
from modrobust.pictures.scene import Scene, offscreen
from modrobust.pictures.video import check_video, frame_indices, save_video
from modrobust.simulation import SimulationResult, simulate

SMALL = (160, 120)  # [pixels]; software rendering is slow


def renders() -> str:
    """Why no picture can be rendered on this machine; empty where it can."""
    try:
        offscreen(SMALL).free()
    except MissingExtraError as problem:
        return str(problem)
    return ""


needs_opengl = pytest.mark.skipif(bool(renders()), reason=renders())


@pytest.fixture(scope="module")
def robot() -> Robot:
    return mr.load_robot("lwa4p")


@pytest.fixture(scope="module")
def run(robot: Robot) -> SimulationResult:
    return simulate(robot, duration=0.5, rate=2e3)


def changed(one: Any, other: Any) -> Any:
    """Where two pictures differ clearly."""
    return np.abs(one.astype(int) - other.astype(int)).max(axis=2) > 40


@needs_opengl
def test_the_robot_moves_in_the_picture_and_stays_inside(robot: Robot) -> None:
    q = np.zeros((2, robot.n))
    q[1, 1] = -1.2
    with Scene(robot, q, size=SMALL) as scene:
        straight, bent = scene.picture(q[0]), scene.picture(q[1])
        again = scene.picture(q[0])
    assert straight.shape == (120, 160, 3)
    top, bottom = straight[0].astype(int), straight[-1].astype(int)
    assert (top[:, 2] - top[:, 0]).mean() > 10  # the sky is blue
    assert (bottom[:, 2] - bottom[:, 0]).mean() < 10  # the floor is not
    assert not changed(straight, again).any()
    difference = changed(straight, bent)
    assert 0.01 < difference.mean() < 0.3
    rows, columns = np.nonzero(difference)
    assert 0 < rows.min() < rows.max() < 119
    assert 0 < columns.min() < columns.max() < 159


@needs_opengl
def test_the_tip_s_way_is_drawn_where_the_tip_was(robot: Robot) -> None:
    q = np.zeros((30, robot.n))
    q[:, 1] = np.linspace(0.0, -1.2, 30)
    with Scene(robot, q, size=SMALL) as scene:
        without = scene.picture(q[0])
        traced = scene.picture(q[0], was=q)
        wanted = scene.picture(q[0], wanted=q)
    orange, blue = traced[changed(without, traced)], wanted[changed(without, wanted)]
    assert len(orange) > 30
    assert (orange[:, 0] > orange[:, 2]).mean() > 0.8
    assert len(blue) > 10
    assert (blue[:, 2] > blue[:, 0]).mean() > 0.8


@needs_opengl
@pytest.mark.parametrize("name", ["concert-wall", "gantry", "lwa4p-payload"])
def test_other_robots_fill_the_picture_too(name: str) -> None:
    robot = mr.load_robot(name)
    with Scene(robot, np.zeros((1, robot.n)), size=SMALL) as scene:
        picture = scene.picture(np.zeros(robot.n)).astype(int)
    orange = (picture[..., 0] > 120) & (picture[..., 0] > 2 * picture[..., 2])
    assert 0.002 < orange.mean() < 0.3  # joints are orange


@needs_opengl
def test_a_gif_holds_the_run_in_real_time(run: SimulationResult, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    parts: list[float] = []
    save_video(run, tmp_path / "run.gif", rate=10.0, size=SMALL, progress=parts.append)
    with image.open(tmp_path / "run.gif") as gif:
        assert gif.size == SMALL
        assert gif.n_frames == 6
        assert gif.info["duration"] == 100
        first = np.array(gif.convert("RGB"))
        gif.seek(5)
        last = np.array(gif.convert("RGB")).astype(int)
        assert changed(first, last).mean() > 0.003
        assert (
            (last - first)[..., 2] - (last - first)[..., 0] > 20
        ).any()  # a blue trail has grown
    assert parts[-1] == 1.0
    assert [p.name for p in tmp_path.iterdir()] == ["run.gif"]


@needs_opengl
def test_an_mp4_holds_the_run_in_real_time(run: SimulationResult, tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    save_video(run, tmp_path / "run.mp4", rate=10.0, size=SMALL)
    file = str(tmp_path / "run.mp4")
    read = [ffmpeg.get_ffmpeg_exe(), "-i", file, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(read, capture_output=True, check=True)
    pictures = np.frombuffer(done.stdout, np.uint8).reshape(-1, 120, 160, 3)
    assert b"h264" in done.stderr
    assert b"10 fps" in done.stderr
    assert len(pictures) == 6
    assert changed(pictures[0], pictures[-1]).mean() > 0.003
    assert [p.name for p in tmp_path.iterdir()] == ["run.mp4"]


def test_pictures_are_the_logged_ticks_nearest_to_their_instants() -> None:
    t = np.arange(0.0, 1.0005, 1e-3)
    assert frame_indices(t, 4.0) == [0, 250, 500, 750, 1000]
    assert frame_indices(np.array([0.0]), 30.0) == [0]
    assert frame_indices(np.array([0.0, 0.4, 1.1]), 1.0) == [0, 2]
    assert frame_indices(np.array([0.0, 0.9, 1.9]), 1.0) == [0, 1, 2]


class Recorder:
    """A scene that keeps what it was to draw."""

    calls: ClassVar[list[tuple[Any, Any, Any]]] = []

    def __init__(self, *_: Any) -> None:
        self.calls.clear()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def picture(self, q: Any, was: Any, wanted: Any) -> Any:
        self.calls.append((q, was, wanted))
        return np.zeros((120, 160, 3), np.uint8)


def test_trails_stand_still_end_at_the_present_and_are_short(
    robot: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("PIL.Image")
    monkeypatch.setattr("modrobust.pictures.video.Scene", Recorder)
    result = simulate(robot, duration=3.0, rate=2e3)
    save_video(result, tmp_path / "run.gif", size=SMALL)
    rows = {q.tobytes(): k for k, q in enumerate(result.q)}
    assert len(Recorder.calls) == 61
    for q, was, wanted in Recorder.calls[::10]:
        now, trail = rows[q.tobytes()], [rows[state.tobytes()] for state in was]
        assert trail == list(range(0, now + 1, 50))[:-31:-1]  # a dot each 50 ms
        np.testing.assert_array_equal(wanted, result.q_des[trail])


def test_a_wrong_suffix_or_place_is_refused_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(FileError) as caught:
        check_video("run.avi")
    assert str(caught.value) == 'run.avi: suffix ".avi"; a video ends in .mp4 or .gif; name it so'
    with pytest.raises(FileError, match="no directory"):
        check_video(tmp_path / "nowhere" / "run.mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("suffix", "package"), [("mp4", "mujoco"), ("mp4", "imageio_ffmpeg"), ("gif", "PIL.Image")]
)
def test_a_missing_package_names_the_extra(
    suffix: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingExtraError) as caught:
        check_video(tmp_path / f"run.{suffix}")
    assert str(caught.value) == (
        f"video: the package {package} is not installed; "
        'install it with pip install "modrobust[video]"'
    )


def test_without_opengl_the_message_says_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("mujoco")
    for kind in ("egl", "osmesa", "glfw", "cgl"):
        monkeypatch.setitem(sys.modules, f"mujoco.{kind}", None)
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(MissingExtraError) as caught:
        check_video(tmp_path / "run.gif")
    assert "no OpenGL that renders offscreen (egl: " in str(caught.value)
    assert "install EGL (Debian: libegl1 libgl1-mesa-dri)" in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_bad_arguments_are_refused(run: SimulationResult, tmp_path: Path) -> None:
    with pytest.raises(ValueRangeError, match=r"rate: 0 pictures/s; must lie in \[1, 120\]"):
        save_video(run, tmp_path / "a.gif", rate=0.0)
    with pytest.raises(ValueRangeError, match="size: 161 x 120; sides must be even"):
        save_video(run, tmp_path / "a.gif", size=(161, 120))
    assert list(tmp_path.iterdir()) == []
