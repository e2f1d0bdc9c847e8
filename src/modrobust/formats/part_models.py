"""Models that module files and assembly files share, and the overlays of a URDF."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from modrobust.formats.fields import Pair, Part, Point, Value, Vector, choice


class LimitsModel(Part):
    """Limits of a joint."""

    position: Pair | None = Field(None, description="[lo, hi] [rad] or [m]")
    velocity: Point | None = Field(None, description="Largest speed [rad/s] or [m/s]")
    torque: Point | None = Field(None, description="Largest torque [N m], revolute joints")
    force: Point | None = Field(None, description="Largest force [N], prismatic joints")
    acceleration: Point | None = Field(None, description="[rad/s^2] or [m/s^2]")


class DriveModel(Part):
    """Drive of a joint, motor side."""

    gear_ratio: Point | None = Field(
        None, description="Motor over joint; [rad/m] for prismatic joints"
    )
    rotor_inertia: Value | None = Field(None, description="Rotor inertia, motor side [kg m^2]")


class FrictionModel(Part):
    """Friction of a joint, joint side."""

    viscous: Value | None = Field(None, description="[N m s/rad] or [N s/m]")
    coulomb: Value | None = Field(None, description="[N m] or [N]")
    coulomb_speed: Point | None = Field(
        None, description="Speed v_c of the smooth sign dq / sqrt(dq^2 + v_c^2), default 1e-3"
    )


class DriveOptionModel(Part):
    """Drive and friction of every joint that moves freely."""

    rotor_inertia: Value | None = Field(None, description="Rotor inertia, motor side [kg m^2]")
    gear_ratio: Point | None = Field(
        None, description="Motor over joint; [rad/m] for prismatic joints"
    )
    viscous: Value | None = Field(None, description="[N m s/rad] or [N s/m]")
    coulomb: Value | None = Field(None, description="[N m] or [N]")


class InertiaModel(Part):
    """Tensor entries [kg m^2], products with their minus sign."""

    about: Annotated[str, choice("com", "frame")] | None = Field(
        None, description="Reference point, default com"
    )
    xx: Value = Field(description="Tensor entry xx [kg m^2]")
    yy: Value = Field(description="Tensor entry yy [kg m^2]")
    zz: Value = Field(description="Tensor entry zz [kg m^2]")
    xy: Value | None = Field(None, description="Tensor entry xy [kg m^2], default 0")
    xz: Value | None = Field(None, description="Tensor entry xz [kg m^2], default 0")
    yz: Value | None = Field(None, description="Tensor entry yz [kg m^2], default 0")
    physical: Annotated[str, choice("as-written")] | None = Field(
        None, description="as-written: take the figures even where no rigid body has them"
    )


class ToleranceModel(Part):
    """Bounds for parameters that have none of their own: per cent or absolute."""

    mass: Point | None = Field(None, description="x% or [kg]")
    com: Point | None = Field(None, description="x% of each entry or [m]")
    inertia: Point | None = Field(None, description="x% of the largest principal moment, [kg m^2]")
    rotor_inertia: Point | None = Field(None, description="x% or [kg m^2]")
    viscous: Point | None = Field(None, description="x% or [N m s/rad] or [N s/m]")
    coulomb: Point | None = Field(None, description="x% or [N m] or [N]")


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
