"""Robust tracking controllers with guaranteed bounds for robots assembled from modules.

>>> import modrobust as mr
>>> robot = mr.load_robot("lwa4p-paper")
>>> mr.simulate(robot, scenario="1").summary()["violations"]
0

Names are imported when first used, so that the command line starts at once. Keys such as [GA17] in
docstrings are those of docs/references.md.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from modrobust.assembly import load_robot
    from modrobust.control import Command, RobustController
    from modrobust.dynamics import (
        forward_dynamics,
        forward_kinematics,
        inverse_dynamics,
        inverse_dynamics_bounds,
        inverse_dynamics_bounds_batch,
        mass_matrix,
        perturbation_bounds,
    )
    from modrobust.errors import ModrobustError
    from modrobust.model import Parameters, Robot
    from modrobust.simulation import SimulationResult, simulate

__all__ = [
    "Command",
    "ModrobustError",
    "Parameters",
    "Robot",
    "RobustController",
    "SimulationResult",
    "forward_dynamics",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_dynamics_bounds",
    "inverse_dynamics_bounds_batch",
    "load_robot",
    "mass_matrix",
    "perturbation_bounds",
    "simulate",
]

_HOMES = {
    "Command": "control",
    "ModrobustError": "errors",
    "Parameters": "model",
    "Robot": "model",
    "RobustController": "control",
    "SimulationResult": "simulation",
    "load_robot": "assembly",
    "simulate": "simulation",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from modrobust.kernel import own_environment

    with own_environment():  # modules compute their constants when they are imported
        home = importlib.import_module(f"{__name__}.{_HOMES.get(name, 'dynamics')}")
    value = globals()[name] = getattr(home, name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
