"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from modrobust.model import LoopSettings, Robot

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
Drive = Annotated[
    str | None,
    typer.Option(
        metavar="FIGURES",
        help="URDF: drive and friction of every joint, e.g. "
        '"rotor_inertia=1e-5 ± 20%, gear_ratio=100, viscous=1, coulomb=2".',
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


Rate = Annotated[
    str | None,
    typer.Option(
        metavar="HZ",
        help="Commands a second, e.g. 4kHz or 500; each is held until the next. "
        "[file's, else 1 kHz]",
    ),
]
Delay = Annotated[
    float | None,
    typer.Option(
        metavar="PERIODS",
        min=0.0,
        max=1.0,
        help="How late a command acts, 0 to 1. [file's, else 0]",
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(
        metavar="SIZES",
        help='Errors of what is measured, e.g. "position=1e-4, velocity=1e-2" or "none"; '
        "sign=worst: always where they hide most. [file's]",
    ),
]
Quantisation = Annotated[
    str | None,
    typer.Option(
        metavar="SIZES",
        help='Steps of what is measured, e.g. "position=1e-4 rad" or "none". [file\'s]',
    ),
]
Saturation = Annotated[
    bool | None, typer.Option(help="Torques are cut at the limits, or not. [file's, else not]")
]
Disturbance = Annotated[
    Literal["constant", "sine", "random", "worst"] | None,
    typer.Option(help="Course inside its bounds. [file's, else constant]"),
]


Law = Annotated[
    Literal["norm", "componentwise", "sampled", "auto"] | None,
    typer.Option(help="Control law; auto chooses its gains. [file's]"),
]
HoldAware = Annotated[
    bool | None,
    typer.Option(help="Laws norm and componentwise: allow for the hold. [file's]"),
]


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


def error_norm(text: str | None, option: str) -> float | None:
    """The norm of an error, such as ``0.01 rad`` or ``5 mm``, in SI units."""
    if text is None:
        return None
    from modrobust.formats import parse_quantity

    return parse_quantity(
        text, "angle", field=option, bounds=False, alternatives=("length",)
    ).nominal


def loop_of(
    robot: Robot,
    rate: str | None = None,
    delay: float | None = None,
    noise: str | None = None,
    quantisation: str | None = None,
    saturation: bool | None = None,
    disturbance: str | None = None,
) -> LoopSettings:
    """The robot's own loop with the options laid over it; None = as the robot has it."""
    from modrobust.cli.wording import named_as_options
    from modrobust.errors import ValueRangeError
    from modrobust.formats import parse_quantity
    from modrobust.formats.loop import parse_noise, parse_quantisation

    joints = robot.joint_names, robot.free_types
    given: dict[str, Any] = {}
    if rate is not None:
        given["rate"] = parse_quantity(rate, "frequency", field="--rate", bounds=False).nominal
    with named_as_options("noise", "quantisation"):
        given |= {} if noise is None else parse_noise(noise, "noise", *joints)
        if quantisation is not None:
            given |= parse_quantisation(quantisation, "quantisation", *joints)
    for name in ("noise", "quantisation"):
        if robot.loop.velocity == "differentiated" and given.get(f"{name}_velocity"):
            raise ValueRangeError(
                f"--{name}: velocity beside velocity: differentiated of the file; such a velocity "
                "has the errors of the position; leave velocity out"
            )
    said = {"delay": delay, "saturation": saturation, "disturbance": disturbance}
    given |= {name: value for name, value in said.items() if value is not None}
    return replace(robot.loop, **given)


def start_error(robot: Robot, text: str | None) -> float | tuple[float, ...] | None:
    """An error at the start: its norm, such as ``0.02 rad``, or ``a=0.02 rad, b=5 mm`` by joint."""
    if text is None:
        return None
    from modrobust.cli.wording import named_as_options
    from modrobust.formats import PerJoint
    from modrobust.formats.inline import parse_inline

    if "=" not in text and ":" not in text:
        return error_norm(text, "--initial-error")
    with named_as_options("initial_error"):
        errors = PerJoint(parse_inline(text, "initial_error"), "initial_error", "position")
        found = errors.resolve(robot.joint_names, robot.free_types)
    return tuple(error.nominal for error in found)


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
    drive: str | None = None,
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
        "drive",
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
            drive=drive,
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
