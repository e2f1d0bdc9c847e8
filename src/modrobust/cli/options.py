"""Options that several commands take, and how their texts are read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

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


def seconds(text: str | None) -> float | None:
    """A duration such as ``10 s``, ``500 ms`` or ``10``, in seconds."""
    if text is None:
        return None
    from modrobust.formats import parse_quantity

    return parse_quantity(text, "time", field="duration", bounds=False).nominal


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
    from modrobust.errors import ValueRangeError

    locked: dict[str, float | str] = {}
    for text in lock or []:
        name, sign, value = text.rpartition("=")
        if not sign or not name.strip():
            raise ValueRangeError(
                f'--lock: "{text[:60]}" is no JOINT=VALUE; write e.g. --lock finger_joint=0.02'
            )
        locked[name.strip()] = value.strip()
    loaded = load_robot(file, base=base, tip=tip, lock=locked, tolerance=tolerance, payload=payload)
    if say_exact and bool((loaded.lower.packed == loaded.upper.packed).all()):
        from modrobust.cli.output import note

        note(f"{file}: no bounds are given; every parameter is taken as exact")
    return loaded
