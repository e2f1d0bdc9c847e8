"""The loop of a campaign from its options, laid over that of the file."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from modrobust.cli.options import hertz

if TYPE_CHECKING:
    from modrobust.model import LoopSettings, Robot


def laid_over(
    robot: Robot, rate: str | None, noise: str | None, saturation: bool | None
) -> LoopSettings:
    """The robot's loop with what is not None laid over it."""
    loop = robot.loop
    if rate is not None:
        loop = replace(loop, rate=hertz(rate))
    if noise is not None:
        from modrobust.formats.loop import parse_noise

        loop = replace(loop, **parse_noise(noise, "--noise", robot.joint_names, robot.free_types))
    return loop if saturation is None else replace(loop, saturation=saturation)


def size(text: str, option: str) -> float:
    """An error such as ``0.01``, ``5 mrad`` or ``2 mm`` in SI units."""
    from modrobust.formats import parse_quantity

    return parse_quantity(
        text, "angle", field=option, bounds=False, alternatives=("length",)
    ).nominal
