"""A simulated run as a video in real time, rendered offscreen.

The robot moves, with the path of its tips: where they were, and where they were to be. Any run can
be shown, whatever plant it came from.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from subprocess import PIPE, Popen
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from modrobust.checks import check_writable, replacing
from modrobust.checks.types import Array
from modrobust.errors import FileError, ValueRangeError
from modrobust.pictures.scene import SIZE, TRAIL_COLOURS, Picture, Scene, offscreen
from modrobust.simulation import SimulationResult
from modrobust.simulation.plants import engine

Progress = Callable[[float], None]

RATES = {".mp4": 30.0, ".gif": 20.0}  # [pictures/s]; a GIF counts in hundredths of a second
_TRAIL = 1.5  # [s], how long a tip's path stays visible
_TRAIL_POINTS = 30


def check_video(path: str | Path) -> None:
    """Refuse a video that could not be made, before a run starts.

    Raises:
        FileError: The suffix is neither ``.mp4`` nor ``.gif``, or the place cannot be written.
        MissingExtraError: A package, or an OpenGL that renders offscreen, is missing.
    """
    suffix = _suffix(path)
    check_writable(path, suffix, "this video")
    engine("mujoco", "video", "video")
    if suffix == ".gif":
        engine("PIL.Image", "video", "video")
    else:
        engine("imageio_ffmpeg", "video", "video")
    offscreen((16, 16)).free()


def save_video(
    result: SimulationResult,
    path: str | Path,
    *,
    rate: float | None = None,
    size: tuple[int, int] = SIZE,
    progress: Progress | None = None,
) -> None:
    """Write the run as a video in real time, whole or not at all.

    Args:
        result: A run.
        path: ``.mp4`` (H.264) or ``.gif``.
        rate: Pictures a second; 30, 20 for a GIF when None.
        size: Width and height [pixels], even.
        progress: Called with the part that is done, 0 to 1.

    Raises:
        FileError: The file cannot be written; one that was there is as it was.
        MissingExtraError: A package, or an OpenGL that renders offscreen, is missing.
        ValueRangeError: The run is empty, or the rate or size out of range.
    """
    suffix = _suffix(path)
    if rate is None:
        rate = RATES[suffix]
    if not 1.0 <= rate <= 120.0:
        raise ValueRangeError(f"rate: {rate:g} pictures/s; must lie in [1, 120]")
    if any(side < 16 or side % 2 for side in size):
        raise ValueRangeError(f"size: {size[0]} x {size[1]}; sides must be even and at least 16")
    if len(result.t) == 0:
        raise ValueRangeError("video: the run has no logged tick; there is nothing to show")
    with replacing(path, suffix, "this video") as part:
        pictures = _pictures(result, rate, size, progress)
        if suffix == ".gif":
            _write_gif(part, pictures, rate)
        else:
            _write_mp4(part, pictures, rate, size)


def _suffix(path: str | Path) -> str:
    suffix = Path(path).suffix.lower()
    if suffix not in RATES:
        raise FileError(
            path, f'suffix "{Path(path).suffix}"; a video ends in {" or ".join(RATES)}; name it so'
        )
    return suffix


def frame_indices(t: Array, rate: float) -> list[int]:
    """Logged ticks that are nearest to the instants of the pictures, the first at t[0]."""
    instants = np.arange(t[0], t[-1] + 0.5 / rate, 1.0 / rate)
    right = np.clip(np.searchsorted(t, instants), 0, len(t) - 1)
    left = np.maximum(right - 1, 0)
    return [int(k) for k in np.where(instants - t[left] < t[right] - instants, left, right)]


def _pictures(
    result: SimulationResult, rate: float, size: tuple[int, int], progress: Progress | None
) -> Iterator[Picture]:
    finite = np.isfinite(result.q).all(axis=1) & (np.abs(result.q).max(axis=1) < 1e3)
    t, q, q_des = result.t[finite], result.q[finite], result.q_des[finite]
    if not len(t):
        raise ValueRangeError("video: the run diverged at once; there is nothing to show")
    indices = frame_indices(t, rate)
    step = max(1, round(_TRAIL / _TRAIL_POINTS * len(t) / max(t[-1] - t[0], 1e-9)))
    seen = q[:: max(1, len(q) // 100)]
    with Scene(result.robot, seen, result.parameters, size) as scene:
        for number, k in enumerate(indices):
            # Dots on a fixed grid of ticks, so that they stand still from picture to picture.
            trail = np.arange(k - k % step, -1, -step)[:_TRAIL_POINTS]
            yield scene.picture(q[k], q[trail], q_des[trail])
            if progress is not None:
                progress((number + 1) / len(indices))


def _write_gif(part: Path, pictures: Iterator[Picture], rate: float) -> None:
    image: Any = engine("PIL.Image", "video", "video")
    shown = list(pictures)
    # One palette for all, or colours flicker; the trails, which grow from nothing, count in it.
    height, width = shown[0].shape[:2]
    trails = [np.full((height, width // 16, 3), colour, np.uint8) for colour in TRAIL_COLOURS]
    sample = image.fromarray(np.concatenate([shown[0], shown[-1], *trails], axis=1))
    palette = sample.quantize(128, dither=image.Dither.NONE)
    frames = [
        image.fromarray(picture).quantize(palette=palette, dither=image.Dither.NONE)
        for picture in shown
    ]
    milliseconds = round(1000.0 / rate)
    frames[0].save(
        part,
        format="GIF",
        save_all=True,
        append_images=frames[1:],
        duration=milliseconds,
        loop=0,
        optimize=False,
    )


def _write_mp4(part: Path, pictures: Iterator[Picture], rate: float, size: tuple[int, int]) -> None:
    ffmpeg: Any = engine("imageio_ffmpeg", "video", "video")
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", f"{rate:g}"]
    coded = ["-an", "-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", str(part)]
    command = [ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, "-i", "-", *coded]
    with TemporaryFile() as errors, Popen(command, stdin=PIPE, stderr=errors) as process:
        assert process.stdin is not None
        try:
            for picture in pictures:
                process.stdin.write(picture.tobytes())
            process.stdin.close()
        except BrokenPipeError:
            pass  # its reason is in errors
        except BaseException:
            process.kill()
            raise
        if process.wait() != 0:
            errors.seek(0)
            reason = " ".join(errors.read().decode(errors="replace").split())[:200]
            raise OSError(None, f"ffmpeg: {reason}")  # `replacing` says where
