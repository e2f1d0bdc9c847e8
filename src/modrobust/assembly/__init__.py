"""From files or arguments to a `Robot`: modules, URDFs, tolerances, payload, scenarios."""

from modrobust.assembly.build import build_robot
from modrobust.assembly.load import load_robot
from modrobust.assembly.modules.catalogue import builtin_robots

__all__ = ["build_robot", "builtin_robots", "load_robot"]
