"""Synthetic chains of any length, for measuring growth with the number of joints."""

from __future__ import annotations

import math

import numpy as np

from modrobust.checks.types import Array
from modrobust.errors import ValueRangeError
from modrobust.kernel import own_environment
from modrobust.model.geometry import dh_standard
from modrobust.model.robot import Bounded, ControllerSettings, Parameters, Robot


@own_environment()
def synthetic_chain(n: int, uncertainty: float = 0.05) -> Robot:
    """A serial chain of ``n`` revolute joints, alternating D-H rows, every body uncertain.

    Odd and even links differ (alpha = +-pi/2, a = 0 and 0.1 m, d = 0.1 m and 0); each carries one
    body of 1 kg, shrinking towards the tip so that long chains stay within reason.

    Args:
        n: Number of joints, at least 1.
        uncertainty: Half-width of mass and inertia over their nominal value; the COM moves by
            ``uncertainty`` times 0.1 m. 0 makes every parameter exact.

    Raises:
        ValueRangeError: ``n`` is not positive.
    """
    if n < 1:
        raise ValueRangeError(f"n: {n}; a chain has at least 1 joint")
    even, odd = dh_standard(0.0, -math.pi / 2, 0.1, 0.0), dh_standard(0.1, math.pi / 2, 0.0, 0.0)
    after = np.array([(odd if i % 2 else even).rounded() for i in range(n)])
    identity = np.tile(np.eye(4), (n, 1, 1))
    scale = 1.0 / (1.0 + 0.05 * np.arange(n, dtype=np.float64))
    com = np.tile([-0.02, 0.01, 0.015], (n, 1))  # [m]
    inertia = np.tile(np.diag([2e-3, 3e-3, 4e-3]), (n, 1, 1))  # [kg m^2]
    inertia[:, 0, 1] = inertia[:, 1, 0] = 1e-4
    inertia *= scale[:, None, None]
    zeros = np.zeros(n)

    def point(sign: float) -> Parameters:
        widened = inertia + sign * uncertainty * 4e-3 * scale[:, None, None]
        return Parameters(
            mass=scale * (1.0 + sign * uncertainty),
            com=com + sign * uncertainty * 0.1,
            inertia=widened,
            rotor_inertia=zeros,
            viscous=zeros,
            coulomb=zeros,
        )

    free: Array = np.full(n, np.inf)
    return Robot(
        name=f"chain-{n}",
        gravity=np.array([0.0, 0.0, -9.81]),
        base=np.eye(4),
        joint_names=tuple(f"link{i + 1}.axis" for i in range(n)),
        joint_types=("revolute",) * n,
        parents=np.arange(-1, n - 1, dtype=np.int32),
        before=identity,
        after=after,
        position_limits=np.stack([-free, free], axis=1),
        velocity_limits=free,
        effort_limits=free,
        gear_ratio=zeros,
        coulomb_speed=np.full(n, 1e-3),
        body_names=tuple(f"link{i + 1}.body" for i in range(n)),
        body_joints=np.arange(n, dtype=np.int32),
        placement=identity,
        nominal=point(0.0),
        lower=point(-1.0),
        upper=point(1.0),
        disturbance=Bounded(zeros, zeros, zeros),
        controller=ControllerSettings(K_r=(10.0,) * n),
    )
