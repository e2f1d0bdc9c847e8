"""Dynamics by Pinocchio's own URDF reader."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Array = NDArray[np.float64]


def pinocchio_terms(
    path: Path, names: tuple[str, ...], q: Array, dq: Array, ddq: Array, locked: dict[str, float]
) -> tuple[Array, Array, Array]:
    """RNEA, gravity torque and mass matrix by Pinocchio's own URDF reader, in our joint order."""
    model = pin.buildModelFromUrdf(str(path))
    if locked:
        still = pin.neutral(model)
        for name, value in locked.items():
            put(model, still, name, value)
        model = pin.buildReducedModel(model, [model.getJointId(name) for name in locked], still)
    model.gravity.linear = np.array([0.0, 0.0, -9.81])
    data = model.createData()
    position = pin.neutral(model)
    for name, value in zip(names, q, strict=True):
        put(model, position, name, value)
    order = [model.joints[model.getJointId(name)].idx_v for name in names]
    velocity, acceleration = np.zeros(model.nv), np.zeros(model.nv)
    velocity[order], acceleration[order] = dq, ddq
    tau = pin.rnea(model, data, position, velocity, acceleration)[order]
    g = pin.computeGeneralizedGravity(model, data, position)[order]
    upper = np.triu(pin.crba(model, data, position))
    M = (upper + np.triu(upper, 1).T)[np.ix_(order, order)]
    return tau, g, M


def put(model: pin.Model, q: Array, name: str, value: float) -> None:
    own = model.joints[model.getJointId(name)]
    if own.nq == 2:  # a continuous joint: cosine and sine
        q[own.idx_q : own.idx_q + 2] = math.cos(value), math.sin(value)
    else:
        q[own.idx_q] = value
