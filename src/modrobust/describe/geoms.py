"""Capsules and cylinders, drawn from the kinematics alone, so that one sees a robot."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from modrobust.describe.common import body_origin, joint_origin, number, numbers
from modrobust.robot import Parameters, Robot

Array = NDArray[np.float64]


def add_geoms(frames: dict[int, ET.Element], robot: Robot, point: Parameters) -> None:
    """Placeholder."""
    _ = (frames, robot, point, body_origin, joint_origin, number, numbers)
