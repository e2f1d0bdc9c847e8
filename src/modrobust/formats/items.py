"""What the files say, resolved: frozen, in SI units, tolerances applied.

``Quantity`` is a number with hard closed bounds; ``inertia`` is always the six tensor entries
xx, xy, xz, yy, yz, zz in body axes [kg m^2], products with their minus sign, about the point that
``inertia_about`` names: "com", or "frame" for the origin of the body's frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from modrobust.formats.controller import Controller
from modrobust.formats.loop import Loop
from modrobust.formats.nodes import Node, Where
from modrobust.formats.overlay import UrdfSource
from modrobust.formats.perjoint import PerJoint
from modrobust.formats.quantity import Quantity
from modrobust.model.geometry import IDENTITY, Transform


@dataclass(frozen=True)
class JointItem:
    """A joint about or along z of the frame where the chain has got to.

    A row of modified D-H brings a transform `ahead` of the joint and one `behind` it.
    """

    name: str
    type: str  # "revolute", "continuous" (it has no position limits) or "prismatic"
    position: tuple[float, float] | None  # [rad] or [m]
    velocity: float | None  # [rad/s] or [m/s]
    effort: float | None  # [N m] or [N]
    acceleration: float | None  # [rad/s^2] or [m/s^2]
    gear_ratio: float | None  # motor over joint: dimensionless, or [rad/m]; None = no drive
    rotor_inertia: Quantity | None  # motor side [kg m^2]
    viscous: Quantity | None  # joint side [N m s/rad] or [N s/m]
    coulomb: Quantity | None  # joint side [N m] or [N]
    coulomb_speed: float  # [rad/s] or [m/s]
    where: Where
    ahead: Transform = IDENTITY
    behind: Transform = IDENTITY


@dataclass(frozen=True, eq=False)
class BodyItem:
    """A rigid body and the span that it bridges; its frame is the span's start or end."""

    name: str
    span: Transform
    at_end: bool
    mass: Quantity  # [kg]
    com: tuple[Quantity, Quantity, Quantity]  # [m], body axes
    inertia: tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]
    inertia_about: str
    where: Where
    modified: Where | None = None  # of a span that is a row of modified D-H


@dataclass(frozen=True, eq=False)
class FrameItem:
    """A span without mass."""

    name: str
    span: Transform
    where: Where
    modified: Where | None = None  # of a span that is a row of modified D-H


@dataclass(frozen=True)
class NestedItem:
    """A module mounted in a chain. `overrides` maps a path inside the module to a new value."""

    module: str
    as_name: str | None
    mount: Fraction  # [rad]
    overrides: Mapping[str, Node]
    where: Where


Item = JointItem | BodyItem | FrameItem | NestedItem


@dataclass(frozen=True)
class Connector:
    """One end of a module. `clocking` [rad] is the step of the allowed mounts, None = any."""

    type: str
    size: str | None
    gender: str  # "m", "f" or "n"
    clocking: float | None
    where: Where


@dataclass(frozen=True)
class Module:
    """A module file, resolved. `notes` holds the file's own notes and ours, for the user."""

    id: str
    name: str
    source: tuple[str, ...]
    licence: str | None
    product: bool
    connector_in: Connector | None
    connector_out: Connector | None
    items: tuple[Item, ...]
    unused_tolerances: tuple[str, ...]
    notes: tuple[str, ...]
    where: Where

    @property
    def remarks(self) -> tuple[str, ...]:
        """The notes, and that some tolerances apply to nothing."""
        if not self.unused_tolerances:
            return self.notes
        unused = ", ".join(self.unused_tolerances)
        return (*self.notes, f"tolerance without a parameter it applies to: {unused}")


@dataclass(frozen=True)
class Payload:
    """A body in the end frame of instance `at` (None = the last of the chain).

    `assumed_point`: neither inertia nor size was written; the inertia is exactly zero.
    """

    at: str | None
    mass: Quantity
    com: tuple[Quantity, Quantity, Quantity]
    inertia: tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]
    inertia_about: str
    assumed_point: bool
    where: Where


@dataclass(frozen=True)
class SinesEntry:
    """q_des = amplitude * prod_k sin(omega_k t)."""

    amplitude: PerJoint  # [rad] or [m]
    omega: tuple[float, ...]  # [rad/s]
    duration: float | None  # [s]


@dataclass(frozen=True)
class QuinticEntry:
    """Rest-to-rest through points: (time [s], position per joint); through drawn ones if empty."""

    points: tuple[tuple[float, PerJoint], ...]
    duration: float | None  # [s]


@dataclass(frozen=True)
class CsvEntry:
    """A file of t and q, resolved against the description's directory."""

    file: Path
    duration: float | None  # [s]


TrajectoryEntry = SinesEntry | QuinticEntry | CsvEntry


@dataclass(frozen=True, eq=False)
class Assembly:
    """An assembly file, resolved as far as that goes without the modules themselves."""

    name: str
    file: Path
    modules: tuple[Path, ...]  # directories to search first
    base: Transform  # world to base frame
    gravity: tuple[float, float, float]  # [m/s^2], world axes
    chain: tuple[Item, ...]  # of a file: modules
    payload: Payload | None
    disturbance: PerJoint | None  # [N m] or [N]
    controller: Controller
    trajectory: TrajectoryEntry | None
    initial_q: PerJoint | None  # [rad] or [m]
    initial_dq: PerJoint | None  # [rad/s] or [m/s]
    scenarios: Mapping[str, Mapping[str, Node]]
    where: Where
    source: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    scenario_notes: Mapping[str, str] = field(default_factory=dict)
    urdf: UrdfSource | None = None  # in place of a chain
    loop: Loop = field(default_factory=Loop)
    payloads: Mapping[str, Payload] = field(default_factory=dict)  # `payload` is then their box
