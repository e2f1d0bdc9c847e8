"""From files to a `Robot`: module chains and URDFs, options, tolerances, payload, scenarios."""

from modrobust.assembly.load import builtin_robots, load_robot

__all__ = ["builtin_robots", "load_robot"]
