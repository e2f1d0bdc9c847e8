"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from modrobust.robot import Robot

RobotFile = Annotated[
    str,
    typer.Argument(metavar="FILE", help="Assembly file, URDF, or the name of a built-in robot."),
]
Base = Annotated[
    str | None, typer.Option(metavar="LINK", help="URDF: link that the robot stands on. [root]")
]
Tip = Annotated[
    str | None,
    typer.Option(metavar="LINK", help="URDF: link where the chain ends. [every branch]"),
]
Lock = Annotated[
    list[str] | None,
    typer.Option(metavar="JOINT=VALUE", help="URDF: joint to freeze, and where; repeatable."),
]
Tolerance = Annotated[
    str | None,
    typer.Option(
        metavar="BOUNDS",
        help='URDF: bounds where there are none, e.g. "mass=5%,com=5mm,inertia=10%".',
    ),
]
Payload = Annotated[
    str | None,
    typer.Option(
        metavar="BODY",
        help='Payload, e.g. "mass=[0 kg, 2 kg], com=[0, 0, [20 mm, 80 mm]], at=LINK".',
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]


_HERTZ = re.compile(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*(Hz|kHz|MHz)?\s*", re.IGNORECASE)
_SCALE = {"": 1.0, "hz": 1.0, "khz": 1e3, "mhz": 1e6}


class PlainCommand(TyperCommand):
    """A command whose refusals do not speak of the library that found them."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as refusal:
            said = refusal.message.removeprefix("Value error, ")
            refusal.message = re.sub(r"^Input should be(.*?)(, unable.*)?$", r"must be\1", said)
            raise


def seconds(text: str | None) -> float | None:
    """A duration such as ``10 s``, ``500 ms`` or ``10``, in seconds."""
    if text is None:
        return None
    from modrobust.formats import parse_quantity

    return parse_quantity(text, "time", field="--duration", bounds=False).nominal


def hertz(text: str) -> float:
    """A rate such as ``5kHz``, ``3000`` or ``1e4 Hz``, in Hz."""
    found = _HERTZ.fullmatch(text)
    try:
        return float((found or [])[1]) * _SCALE[((found or [])[2] or "").lower()]
    except (IndexError, ValueError):
        from modrobust.errors import ValueRangeError
        from modrobust.formats.nodes import shown

        raise ValueRangeError(
            f"--control-rate: {shown(text)} is no rate; write a number of Hz such as 5000 or 5kHz"
        ) from None


def robot(
    file: str,
    base: str | None,
    tip: str | None,
    lock: list[str] | None,
    tolerance: str | None,
    payload: str | None,
    say_exact: bool = True,
) -> Robot:
    """The robot of a command, with its options laid over it.

    Where nothing has a bound, this is said on stderr, unless the command shows it anyway.
    """
    from modrobust.assembly import load_robot
    from modrobust.cli.wording import named_as_options
    from modrobust.errors import ValueRangeError
    from modrobust.urdf_xml import SUFFIXES

    locked: dict[str, float | str] = {}
    for text in lock or []:
        name, sign, value = text.rpartition("=")
        if not sign or not name.strip():
            raise ValueRangeError(
                f'--lock: "{text[:60]}" is no JOINT=VALUE; write e.g. --lock finger_joint=0.02'
            )
        if name.strip() in locked:
            raise ValueRangeError(f"--lock: {name.strip()} is locked twice; give one value")
        locked[name.strip()] = value.strip()
    options = ("base", "tip", "lock", "tolerance", "payload")
    with named_as_options(*options, remedies=Path(file).suffix.lower() in SUFFIXES):
        loaded = load_robot(
            file, base=base, tip=tip, lock=locked, tolerance=tolerance, payload=payload
        )
    if say_exact and not loaded.uncertain:
        from modrobust.cli.output import note

        note(f"{file}: no bounds are given; every parameter is taken as exact")
    return loaded
