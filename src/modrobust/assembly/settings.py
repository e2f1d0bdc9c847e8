"""Controller and trajectory settings of an assembly file, resolved for its joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

from modrobust.formats import (
    Controller,
    PerJoint,
    Quantity,
    QuinticEntry,
    SinesEntry,
    TrajectoryEntry,
)
from modrobust.model import ControllerSettings, TrajectorySettings

_K_R = 10.0  # [1/s], Section V of [GA17]


def per_joint(
    value: PerJoint | None, names: Sequence[str], types: Sequence[str]
) -> list[Quantity] | None:
    """One quantity a joint; None where nothing is written."""
    return None if value is None else value.resolve(names, types)


def controller_settings(
    written: Controller, names: Sequence[str], types: Sequence[str]
) -> ControllerSettings:
    """The settings as written, the defaults of Section V where they are not.

    Lambda of ``sampled`` stands where K_r does: it has the same place in r.
    """
    gains = per_joint(written.K_r, names, types)
    same = (_K_R if written.Lambda is None else written.Lambda,) * len(names)
    K_r = tuple(q.nominal for q in gains) if gains else same
    names_of = (item.name for item in fields(ControllerSettings) if item.name != "K_r")
    given = {name: getattr(written, name) for name in names_of}
    return ControllerSettings(K_r, **{k: v for k, v in given.items() if v is not None})


def trajectory_settings(
    written: TrajectoryEntry | None, names: Sequence[str], types: Sequence[str]
) -> TrajectorySettings | None:
    """The trajectory as written, with one number a joint."""
    if written is None:
        return None
    if isinstance(written, SinesEntry):
        amplitude = written.amplitude.resolve(names, types)
        return TrajectorySettings(
            kind="sines",
            duration=written.duration,
            amplitude=tuple(q.nominal for q in amplitude),
            omega=written.omega,
        )
    if isinstance(written, QuinticEntry):
        points = [point.resolve(names, types) for _, point in written.points]
        return TrajectorySettings(
            kind="quintic",
            duration=written.duration,
            times=tuple(at for at, _ in written.points),
            points=tuple(tuple(q.nominal for q in point) for point in points),
        )
    return TrajectorySettings(kind="csv", duration=written.duration, file=str(written.file))
