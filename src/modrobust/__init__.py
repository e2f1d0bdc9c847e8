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
    from modrobust.assembly import build_robot, builtin_robots, load_robot
    from modrobust.control import Command, RateWarning, RobustController
    from modrobust.dynamics import (
        forward_dynamics,
        forward_kinematics,
        inverse_dynamics,
        inverse_dynamics_bounds,
        inverse_dynamics_bounds_batch,
        mass_matrix,
        perturbation_bounds,
    )
    from modrobust.errors import (
        DescriptionError,
        DivergenceError,
        FileError,
        InputError,
        MissingExtraError,
        ModrobustError,
        SeveralFaultsError,
        ShapeError,
        SingularMassMatrixError,
        TimeOrderError,
        ValueRangeError,
    )
    from modrobust.model import Bounded, ControllerSettings, LoopSettings, Parameters, Robot
    from modrobust.motion import (
        Quintic,
        Sines,
        Splined,
        Trajectory,
        default_trajectory,
        make_trajectory,
        read_trajectory_csv,
    )
    from modrobust.simulation import SimulationResult, simulate

    __version__: str

__all__ = [
    "Bounded",
    "Command",
    "ControllerSettings",
    "DescriptionError",
    "DivergenceError",
    "FileError",
    "InputError",
    "LoopSettings",
    "MissingExtraError",
    "ModrobustError",
    "Parameters",
    "Quintic",
    "RateWarning",
    "Robot",
    "RobustController",
    "SeveralFaultsError",
    "ShapeError",
    "SimulationResult",
    "Sines",
    "SingularMassMatrixError",
    "Splined",
    "TimeOrderError",
    "Trajectory",
    "ValueRangeError",
    "__version__",
    "build_robot",
    "builtin_robots",
    "default_trajectory",
    "forward_dynamics",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_dynamics_bounds",
    "inverse_dynamics_bounds_batch",
    "load_robot",
    "make_trajectory",
    "mass_matrix",
    "perturbation_bounds",
    "read_trajectory_csv",
    "simulate",
]

_HOMES = {
    "assembly": ("build_robot", "builtin_robots", "load_robot"),
    "control": ("Command", "RateWarning", "RobustController"),
    "model": ("Bounded", "ControllerSettings", "LoopSettings", "Parameters", "Robot"),
    "motion": (
        *("Quintic", "Sines", "Splined", "Trajectory"),
        *("default_trajectory", "make_trajectory", "read_trajectory_csv"),
    ),
    "simulation": ("SimulationResult", "simulate"),
}


def _home(name: str) -> str:
    """The module below the package that a public name comes from."""
    if name.endswith("Error"):
        return "errors"
    return next((home for home, names in _HOMES.items() if name in names), "dynamics")


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "__version__":
        from importlib.metadata import version

        value = version(__name__)
    else:
        from modrobust.kernel import own_environment

        with own_environment():  # modules compute their constants when they are imported
            value = getattr(importlib.import_module(f"{__name__}.{_home(name)}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
