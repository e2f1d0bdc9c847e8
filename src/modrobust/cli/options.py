"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from modrobust.model import Robot

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
Mount = Annotated[
    str | None,
    typer.Option(
        metavar="RPY", help='Turn of the root in the world [rad], e.g. "0, 90 deg, 0". [file\'s]'
    ),
]
Gravity = Annotated[
    str | None,
    typer.Option(metavar="XYZ", help='In world axes [m/s^2], e.g. "0 0 -1.62". [file\'s]'),
]
Xacro = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME:=VALUE", help="Argument of a xacro file; repeatable."),
]
Package = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=PATH", help="Folder of package://NAME and $(find NAME); repeatable."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]


_HERTZ = re.compile(r"\s*([0-9.]+(?:e[+-]?[0-9]+)?)\s*(Hz|kHz|MHz)?\s*", re.IGNORECASE)
_SCALE = {"": 1.0, "hz": 1.0, "khz": 1e3, "mhz": 1e6}


class PlainCommand(TyperCommand):
    """A command whose refusals do not speak of the library that found them."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """The arguments left over; a refusal by typer comes in the words of modrobust."""
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
    mount: str | None = None,
    gravity: str | None = None,
    xacro: list[str] | None = None,
    package: list[str] | None = None,
    say_exact: bool = True,
) -> Robot:
    """The robot of a command, with its options laid over it.

    Where nothing has a bound, this is said on stderr, unless the command shows it anyway.
    """
    from modrobust.assembly import load_robot
    from modrobust.assembly.urdf.xml import SUFFIXES
    from modrobust.cli.wording import named_as_options

    locked = _pairs(lock, "=", "--lock", "JOINT=VALUE", "finger_joint=0.02", "locked")
    arguments = _pairs(xacro, ":=", "--xacro", "NAME:=VALUE", "prefix:=left_", "given")
    folders = _pairs(package, "=", "--package", "NAME=PATH", "ur_description=src/ur", "given")
    options = (
        "base",
        "tip",
        "lock",
        "tolerance",
        "payload",
        "mount",
        "gravity",
        "xacro",
        "packages",
    )
    with named_as_options(*options, remedies=Path(file).suffix.lower() in SUFFIXES):
        loaded = load_robot(
            file,
            base=base,
            tip=tip,
            lock=locked,
            tolerance=tolerance,
            payload=payload,
            mount=mount,
            gravity=gravity,
            xacro=arguments,
            packages=folders,
        )
    if say_exact and not loaded.uncertain:
        from modrobust.cli.output import note

        note(f"{file}: no bounds are given; every parameter is taken as exact")
    return loaded


def _pairs(
    texts: list[str] | None, sign: str, option: str, form: str, example: str, done: str
) -> dict[str, str]:
    """What the texts of a repeatable option say, by name."""
    from modrobust.errors import ValueRangeError

    found: dict[str, str] = {}
    for text in texts or []:
        name, written, value = text.rpartition(sign) if sign == "=" else text.partition(sign)
        if not written or not name.strip():
            raise ValueRangeError(
                f'{option}: "{text[:60]}" is no {form}; write e.g. {option} {example}'
            )
        if name.strip() in found:
            raise ValueRangeError(f"{option}: {name.strip()} is {done} twice; give one value")
        found[name.strip()] = value.strip()
    return found
