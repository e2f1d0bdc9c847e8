"""The structure of module and assembly files: which keys there are. Numbers stay nodes here."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, Tag

from modrobust.checks import did_you_mean, unknown_name
from modrobust.formats.controller import ControllerEntry
from modrobust.formats.fields import (
    Anything,
    Flag,
    Name,
    Part,
    PerJointValue,
    Point,
    Points,
    Text,
    Texts,
    Value,
    Vector,
    Version,
    as_dict,
    as_list,
    choice,
    refuse,
)
from modrobust.formats.loop import LoopModel
from modrobust.formats.nodes import MapNode, Node, ScalarNode, kind_of
from modrobust.formats.part_models import (
    DriveModel,
    FrictionModel,
    InertiaModel,
    JointOverlay,
    LimitsModel,
    LinkOverlay,
    ToleranceModel,
)
from modrobust.formats.payloads import PayloadEntry, PayloadModel

ENTRY_KINDS = ("joint", "body", "frame", "module")


class DhModel(Part):
    """A Denavit-Hartenberg row as a constant transform."""

    convention: Annotated[str, choice("standard", "modified")] = Field(
        description="standard = Rz(theta) Tz(d) Tx(a) Rx(alpha), "
        "modified = Rx(alpha) Tx(a) Rz(theta) Tz(d)"
    )
    a: Point | None = Field(None, description="Length along x [m], default 0")
    alpha: Point | None = Field(None, description="Twist about x [rad], default 0")
    d: Point | None = Field(None, description="Offset along z [m], default 0")
    theta: Point | None = Field(None, description="Angle about z [rad], default 0")


class JointDhModel(Part):
    """A modified Denavit-Hartenberg row with its joint: Rx(alpha) Tx(a), the motion, Tz(d)."""

    convention: Annotated[str, choice("modified")] = Field(
        description="modified = Rx(alpha) Tx(a) Rz(q) Tz(d); a standard row is a joint and a span"
    )
    a: Point | None = Field(None, description="Length along x before the joint [m], default 0")
    alpha: Point | None = Field(None, description="Twist about x before it [rad], default 0")
    d: Point | None = Field(None, description="Offset along z behind it [m], default 0")


class Giusti2015Model(Part):
    """Extended D-H letters of Giusti and Althoff 2015."""

    convention: Annotated[str, choice("giusti", "iit")] = Field(
        description="giusti = Tz(-p) Rz(-delta_in) Tx(a) Rx(alpha) Tz(n) Rz(delta_out); "
        "iit = p and delta_in with the opposite sign"
    )
    p: Point | None = Field(None, description="Proximal offset along z [m], default 0")
    delta_in: Point | None = Field(None, description="Proximal angle about z [rad], default 0")
    a: Point | None = Field(None, description="Length along x [m], default 0")
    alpha: Point | None = Field(None, description="Twist about x [rad], default 0")
    n: Point | None = Field(None, description="Distal offset along z [m], default 0")
    delta_out: Point | None = Field(None, description="Distal angle about z [rad], default 0")


class SpanModel(Part):
    """A constant transform: one of dh, giusti2015, or xyz and rpy."""

    dh: DhModel | None = Field(None, description="Denavit-Hartenberg parameters")
    giusti2015: Giusti2015Model | None = Field(None, description="Extended D-H letters")
    xyz: Points | None = Field(None, description="Translation [m], default [0, 0, 0]")
    rpy: Points | None = Field(
        None, description="Roll, pitch, yaw [rad]: Rz(y) Ry(p) Rx(r), default [0, 0, 0]"
    )


class JointModel(Part):
    """A joint about or along z of the current frame."""

    joint: Name = Field(description="Name of the joint")
    type: Annotated[str, choice("revolute", "prismatic", "continuous")] = Field(
        description="Kind of motion"
    )
    dh: JointDhModel | None = Field(None, description="The joint's row of modified D-H")
    limits: LimitsModel | None = Field(None, description="Limits")
    drive: DriveModel | None = Field(None, description="Drive, motor side")
    friction: FrictionModel | None = Field(None, description="Friction, joint side")


class BodyModel(Part):
    """A rigid body that bridges a span."""

    body: Name = Field(description="Name of the body")
    span: SpanModel | None = Field(None, description="Transform that it bridges, default none")
    expressed_in: Annotated[str, choice("start", "end")] | None = Field(
        None, description="Frame of com and inertia: start (default) or end of the span"
    )
    mass: Value = Field(description="Mass [kg]")
    com: Vector = Field(description="Centre of mass [m]")
    inertia: InertiaModel = Field(description="Inertia tensor [kg m^2]")


class FrameModel(Part):
    """A span without mass."""

    frame: Name = Field(description="Name of the frame")
    span: SpanModel | None = Field(None, description="Transform, default none")


class NestedModel(Part):
    """A module mounted in a chain."""

    module: Name = Field(description="Module id")
    as_: Name | None = Field(None, alias="as", description="Name of the instance")
    mount: Point | None = Field(None, description="Turn about z at the connector [rad], default 0")
    set: Annotated[dict[str, Anything], as_dict] | None = Field(
        None, description="Values that replace the module's: path inside the module to value"
    )


def _kind(node: Any) -> str | None:
    kinds = [kind for kind in ENTRY_KINDS if kind in node.entries]
    return f"<{kinds[0]}>" if kinds else None


def _one_kind(node: Node) -> Node:
    known = ", ".join(ENTRY_KINDS)
    if not isinstance(node, MapNode):
        raise refuse(
            node.where,
            f"{kind_of(node)}; a chain entry is a mapping with one of {known}; "
            'write e.g. "- body: name"',
        )
    kinds = [kind for kind in ENTRY_KINDS if kind in node.entries]
    if len(kinds) > 1:
        raise refuse(
            node.where,
            f"{' and '.join(kinds)} in one entry; a chain entry is exactly one of {known}; "
            "split it into two entries",
        )
    if not kinds:
        found = next(iter(node), "")
        raise refuse(
            node.where,
            f"none of {known}; {did_you_mean(found, ENTRY_KINDS)}"
            'a chain entry is exactly one of them; start it with e.g. "- body: name"',
        )
    return node


ChainEntry = Annotated[
    Annotated[JointModel, Tag("<joint>")]
    | Annotated[BodyModel, Tag("<body>")]
    | Annotated[FrameModel, Tag("<frame>")]
    | Annotated[NestedModel, Tag("<module>")],
    Discriminator(_kind),
    BeforeValidator(_one_kind),
]


class ConnectorModel(Part):
    """One end of a module."""

    type: Text = Field(description="Family of the connector")
    size: Text | None = Field(None, description="Size within the family")
    gender: Annotated[str, choice("m", "f", "n")] | None = Field(
        None, description="m, f or n (default)"
    )
    clocking: Point | None = Field(None, description="Step of the allowed mounts [rad]")


class ConnectorsModel(Part):
    """The two ends of a module."""

    in_: ConnectorModel | None = Field(None, alias="in", description="Towards the base")
    out: ConnectorModel | None = Field(None, description="Towards the tip; a tool has none")


class ModuleModel(Part):
    """A module of a robot, described with its tolerances."""

    modrobust: Version = Field(description="Version of the format")
    module: Name = Field(description="Module id, the name of the file without its suffix")
    name: Text = Field(description="Name for people")
    source: Texts = Field(description="Where the figures come from")
    licence: Text | None = Field(None, description="Licence of the figures")
    notes: Texts | None = Field(None, description="Remarks")
    product: Flag | None = Field(None, description="false for generic parts, default true")
    tolerance: ToleranceModel | None = Field(None, description="Default bounds")
    connectors: ConnectorsModel | None = Field(None, description="Ends of the module")
    chain: Annotated[list[ChainEntry], as_list] = Field(
        description="Joints, bodies, frames and modules from in to out"
    )


class BaseFrameModel(Part):
    """World to the base frame."""

    xyz: Points | None = Field(None, description="Translation [m], default [0, 0, 0]")
    rpy: Points | None = Field(None, description="Roll, pitch, yaw [rad], default [0, 0, 0]")


def _mounted_kind(node: Any) -> str:
    return "<id>" if isinstance(node, ScalarNode) else "<mounted>"


MountedModel = Annotated[
    Annotated[Name, Tag("<id>")] | Annotated[NestedModel, Tag("<mounted>")],
    Discriminator(_mounted_kind),
]


class SinesModel(Part):
    """Products of sines, (13) of the paper."""

    kind: Annotated[str, choice("sines")] = Field(description="Kind of trajectory")
    amplitude: PerJointValue = Field(description="[rad] or [m] per joint")
    omega: Annotated[list[Point], as_list] = Field(description="Angular frequencies [rad/s]")
    duration: Point | None = Field(None, description="[s]")


class WaypointModel(Part):
    """A point of a quintic trajectory."""

    at: Point = Field(description="Time [s]")
    q: PerJointValue = Field(description="[rad] or [m] per joint")


class QuinticModel(Part):
    """Rest-to-rest motion through points."""

    kind: Annotated[str, choice("quintic")] = Field(description="Kind of trajectory")
    points: Annotated[list[WaypointModel], as_list] | None = Field(
        None, description="Points in time order; without them through drawn ones"
    )
    duration: Point | None = Field(None, description="[s]")


class CsvModel(Part):
    """A file of t and q."""

    kind: Annotated[str, choice("csv")] = Field(description="Kind of trajectory")
    file: Text = Field(description="CSV file, relative to this file")
    duration: Point | None = Field(None, description="[s]")


TRAJECTORY_KINDS = ("sines", "quintic", "csv")


def _trajectory_kind(node: Any) -> str:
    return f"<{node.entries['kind'].text}>"


def _known_trajectory(node: Node) -> Node:
    if not isinstance(node, MapNode) or "kind" not in node.entries:
        raise refuse(
            node.where,
            'no "kind"; a trajectory is a mapping with kind: one of '
            f"{', '.join(TRAJECTORY_KINDS)}; add it",
        )
    kind = node.entries["kind"]
    if not isinstance(kind, ScalarNode) or kind.text not in TRAJECTORY_KINDS:
        name = kind.text if isinstance(kind, ScalarNode) else ""
        found = f"{kind_of(kind)} is no kind of trajectory"
        raise refuse(kind.where, unknown_name(found, name, TRAJECTORY_KINDS))
    return node


TrajectoryModel = Annotated[
    Annotated[SinesModel, Tag("<sines>")]
    | Annotated[QuinticModel, Tag("<quintic>")]
    | Annotated[CsvModel, Tag("<csv>")],
    Discriminator(_trajectory_kind),
    BeforeValidator(_known_trajectory),
]


class InitialModel(Part):
    """State at the start."""

    q: PerJointValue | None = Field(None, description="[rad] or [m] per joint")
    dq: PerJointValue | None = Field(None, description="[rad/s] or [m/s] per joint")


class ScenarioModel(Part):
    """True parameters of a simulation; what is not set is nominal."""

    set: Annotated[dict[str, Anything], as_dict] = Field(description="Path to value")
    notes: Texts | None = Field(None, description="Remarks")


class AssemblyModel(Part):
    """A robot put together from modules."""

    modrobust: Version = Field(description="Version of the format")
    robot: Name = Field(description="Name of the robot, the file's name without its suffix")
    source: Texts | None = Field(None, description="Where the figures come from")
    notes: Texts | None = Field(None, description="Remarks")
    modules: Texts | None = Field(
        None, description="Directories of modules, searched before the built-in catalogue"
    )
    base: BaseFrameModel | None = Field(None, description="World to the base frame")
    gravity: Points | None = Field(None, description="[m/s^2], default [0, 0, -9.81], world axes")
    chain: Annotated[list[MountedModel], as_list] | None = Field(
        None, description="Modules from base to tip; or urdf"
    )
    urdf: Text | None = Field(
        None, description="URDF in place of a chain: a file, or package:NAME/PATH"
    )
    base_link: Text | None = Field(None, description="URDF: link that the robot stands on")
    tip_link: Text | None = Field(None, description="URDF: link where the chain ends")
    lock: Annotated[dict[str, Anything], as_dict] | None = Field(
        None, description="URDF: joint to the position [rad] or [m] that it is frozen at"
    )
    links: Annotated[dict[str, LinkOverlay], as_dict] | None = Field(
        None, description="URDF: what replaces the inertials, by link"
    )
    joints: Annotated[dict[str, JointOverlay], as_dict] | None = Field(
        None, description="URDF: limits, drive and friction, by joint"
    )
    tolerance: ToleranceModel | None = Field(None, description="URDF: default bounds")
    xacro: Annotated[dict[str, Anything], as_dict] | None = Field(
        None, description="URDF: arguments of a xacro file, by name"
    )
    packages: Annotated[dict[str, Text], as_dict] | None = Field(
        None,
        description="URDF: folders by package, for package://NAME and $(find NAME), relative to "
        "this file",
    )
    payload: PayloadModel | None = Field(None, description="Payload")
    payloads: Annotated[dict[str, PayloadEntry], as_dict] | None = Field(
        None, description="Several payloads by name, in place of one; the bounds hold for each"
    )
    disturbance: PerJointValue | None = Field(None, description="[N m] or [N] per joint, bounds")
    controller: ControllerEntry | None = Field(None, description="Controller settings")
    loop: LoopModel | None = Field(None, description="The loop as the drive runs it")
    trajectory: TrajectoryModel | None = Field(None, description="Reference motion")
    initial: InitialModel | None = Field(None, description="State at the start")
    scenarios: Annotated[dict[str, ScenarioModel], as_dict] | None = Field(
        None, description="Named sets of true parameters"
    )
