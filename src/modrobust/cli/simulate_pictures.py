"""A simulated run as a video, or in a viewer."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

if TYPE_CHECKING:
    from modrobust.model import Robot
    from modrobust.simulation import SimulationResult

Plant = Annotated[
    Literal["builtin", "mujoco", "pinocchio"],
    typer.Option(help="What moves as the true robot; other engines are slower."),
]
Video = Annotated[
    Path | None, typer.Option(metavar="OUT", help="Render the run as .mp4 or .gif, in real time.")
]
View = Annotated[
    bool, typer.Option("--view", help="Play the run in MuJoCo's viewer; needs a screen.")
]


def check_pictures(video: Path | None, view: bool) -> None:
    """Refuse before the run what could not be shown after it."""
    # Warnings of a window system that is tried and not there; its failure is told as a reason.
    warnings.filterwarnings("ignore", r"\(\d+\) ", UserWarning)
    if video is not None:
        from modrobust.pictures.video import check_video

        check_video(video)
    if view:
        from modrobust.cli.wording import named_as_options
        from modrobust.pictures.viewer import check_viewer

        with named_as_options(remedies=True):
            check_viewer()


def check_shown(robot: Robot, video: Path | None, view: bool) -> None:
    """Refuse before the run a robot that MuJoCo, which draws it, does not take."""
    if video is not None or view:
        from modrobust.export.mjcf import refuse_unphysical

        refuse_unphysical(robot)


def show_pictures(result: SimulationResult, video: Path | None, view: bool) -> None:
    """Render the run, then play it; Ctrl-C ends either."""
    from modrobust.cli.output import ProgressBar, note

    try:
        if video is not None:
            from modrobust.pictures.video import save_video

            with ProgressBar(f"Rendering {video.name}") as bar:
                save_video(result, video, progress=bar)
        if view:
            from modrobust.cli.wording import named_as_options
            from modrobust.pictures.viewer import view as play

            with named_as_options(remedies=True):
                play(result)
    except KeyboardInterrupt:
        note("interrupted; the figures above stand, no video was written")
        raise typer.Exit(130) from None
