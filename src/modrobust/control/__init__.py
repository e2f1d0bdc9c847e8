"""The robust tracking controller: settings and their checks, and the command at one tick.

The laws are computed in C, ``mr_command``; gains of the law ``auto`` come from `modrobust.design`.
"""

from modrobust.control.controller import Command, RateWarning, RobustController
from modrobust.control.settings import ControllerOptions, PerJoint, settings_dict

__all__ = [
    "Command",
    "ControllerOptions",
    "PerJoint",
    "RateWarning",
    "RobustController",
    "settings_dict",
]
