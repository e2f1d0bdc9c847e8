"""What an assembly file says about a robot that a URDF describes: selection, locks, overlays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from pydantic import Field

from modrobust.formats.fields import Part, Value, Vector, choice
from modrobust.formats.models import (
    DriveModel,
    FrictionModel,
    LimitsModel,
    ToleranceModel,
)
from modrobust.formats.nodes import Node, ScalarNode, Where


class InertiaOverlay(Part):
    """Tensor entries [kg m^2] that replace those of the URDF."""

    about: Annotated[str, choice("com", "frame")] | None = Field(
        None, description="Reference point, default com"
    )
    xx: Value | None = Field(None, description="Tensor entry xx [kg m^2]")
    yy: Value | None = Field(None, description="Tensor entry yy [kg m^2]")
    zz: Value | None = Field(None, description="Tensor entry zz [kg m^2]")
    xy: Value | None = Field(None, description="Tensor entry xy [kg m^2]")
    xz: Value | None = Field(None, description="Tensor entry xz [kg m^2]")
    yz: Value | None = Field(None, description="Tensor entry yz [kg m^2]")


class LinkOverlay(Part):
    """What replaces the inertial of a link; com and inertia in the axes of the link."""

    mass: Value | None = Field(None, description="Mass [kg]")
    com: Vector | None = Field(None, description="Centre of mass in the link frame [m]")
    inertia: InertiaOverlay | None = Field(None, description="Inertia tensor [kg m^2]")


class JointOverlay(Part):
    """What a URDF cannot say about a joint, or what replaces what it says."""

    limits: LimitsModel | None = Field(None, description="Limits")
    drive: DriveModel | None = Field(None, description="Drive, motor side")
    friction: FrictionModel | None = Field(None, description="Friction, joint side")


@dataclass(frozen=True)
class UrdfSource:
    """A URDF and what is laid over it.

    Args:
        file: Path of the file, or ``package:NAME/PATH`` for a file of an installed package.
        base_link, tip_link: Ends of the chain to take, None = the root, and all branches.
        lock: Joint name to the position [rad] or [m] that it is frozen at.
        links, joints: Overlays by name.
        tolerance: Bounds for parameters that have none of their own.
        where: Where the URDF is named.
    """

    file: str
    where: Where
    directory: Path = Path()  # what a relative file is relative to
    base_link: ScalarNode | None = None
    tip_link: ScalarNode | None = None
    lock: Mapping[str, Node] = field(default_factory=dict)
    links: Mapping[str, LinkOverlay] = field(default_factory=dict)
    joints: Mapping[str, JointOverlay] = field(default_factory=dict)
    tolerance: ToleranceModel | None = None
