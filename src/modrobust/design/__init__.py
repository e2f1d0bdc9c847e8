"""Gains of the law ``sampled``, chosen for a robot's box and the loop that it is run in."""

from modrobust.design.points import central_parameters, light_parameters

__all__ = ["central_parameters", "light_parameters"]
