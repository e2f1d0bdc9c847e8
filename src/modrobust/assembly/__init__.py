"""From files to a `Robot`: module chains and URDFs, options, tolerances, payload, scenarios."""

from modrobust.assembly.load import load_robot
from modrobust.assembly.modules.catalogue import builtin_robots

__all__ = ["builtin_robots", "load_robot"]
