"""The robust tracking controller: settings and their checks, and the command at one tick.

The laws are computed in C, ``mr_command``; gains of the law ``auto`` come from `modrobust.design`.
"""

from modrobust.control.controller import Command, RateWarning, RobustController
from modrobust.control.rate import RateNeed, needed_rate
from modrobust.control.settings import AUTO, ControllerOptions, PerJoint, settings_dict

__all__ = [
    "AUTO",
    "Command",
    "ControllerOptions",
    "PerJoint",
    "RateNeed",
    "RateWarning",
    "RobustController",
    "needed_rate",
    "settings_dict",
]
