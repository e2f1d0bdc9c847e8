"""Gains of the law ``sampled``, chosen for a robot's box and the loop that it is run in."""

from modrobust.design.gains import Design, check_loop, design
from modrobust.design.points import central_parameters, light_parameters
from modrobust.design.remedies import Help

__all__ = [
    "Design",
    "Help",
    "central_parameters",
    "check_loop",
    "design",
    "light_parameters",
]
