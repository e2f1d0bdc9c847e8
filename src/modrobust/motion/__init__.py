"""Desired motions: sines, quintics and splines, read from CSV files, held against the limits."""

from modrobust.motion.csv import read_trajectory_csv
from modrobust.motion.trajectory import (
    Quintic,
    Sines,
    Splined,
    Trajectory,
    default_trajectory,
    make_trajectory,
)

__all__ = [
    "Quintic",
    "Sines",
    "Splined",
    "Trajectory",
    "default_trajectory",
    "make_trajectory",
    "read_trajectory_csv",
]
