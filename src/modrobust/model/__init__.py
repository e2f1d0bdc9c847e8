"""The robot as frozen arrays, the box of its parameters and points of that box.

Rigid transforms and D-H tables are here too; files become a `Robot` in `modrobust.assembly`.
"""

from modrobust.model.loop import checked_loop
from modrobust.model.parameters import Bounded, Parameters
from modrobust.model.parts import (
    DISTURBANCES,
    NOISES,
    SENSOR_SIZES,
    ControllerSettings,
    LoopSettings,
    MimicJoints,
    ModuleNode,
    TrajectorySettings,
    default_gains,
)
from modrobust.model.robot import Robot, check_parameters, check_robot, owner_of
from modrobust.model.synthetic import synthetic_chain

__all__ = [
    "DISTURBANCES",
    "NOISES",
    "SENSOR_SIZES",
    "Bounded",
    "ControllerSettings",
    "LoopSettings",
    "MimicJoints",
    "ModuleNode",
    "Parameters",
    "Robot",
    "TrajectorySettings",
    "check_parameters",
    "check_robot",
    "checked_loop",
    "default_gains",
    "owner_of",
    "synthetic_chain",
]
