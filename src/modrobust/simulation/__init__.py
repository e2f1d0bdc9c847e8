"""The closed loop of controller and plant: the run, its plants, log, figures and remarks."""

from modrobust.simulation.result import SimulationResult
from modrobust.simulation.run import simulate, true_robot

__all__ = ["SimulationResult", "simulate", "true_robot"]
