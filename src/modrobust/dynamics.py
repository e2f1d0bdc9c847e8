"""Torques, their guaranteed bounds, mass matrix and forward dynamics of a robot.

Equation numbers are those of docs/theory/equations.md. Shapes: n joints, b bodies; SI units,
angles in radians; entries of prismatic joints in metres and newtons.
"""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from modrobust import _kernel
from modrobust.checks import as_array, as_integer, as_real, as_truth
from modrobust.checks.types import Array
from modrobust.errors import ValueRangeError
from modrobust.kernel import bound_code, status_error
from modrobust.model import Parameters, Robot, check_parameters, check_robot, owner_of

MAX_THREADS = 4096  # no machine of today has more processors


def inverse_dynamics(
    robot: Robot,
    q: ArrayLike,
    dq: ArrayLike,
    dq_a: ArrayLike,
    ddq_a: ArrayLike,
    parameters: Parameters | None = None,
    drives: bool = True,
) -> Array:
    r"""Torques of the passivity-based model: the modified recursive Newton-Euler algorithm NE*.

    .. math:: \tau = M(q)\,\ddot q_a + C(q,\dot q)\,\dot q_a + g(q)
              + F_v \dot q + F_c\, s(\dot q) + k^2 I_m \ddot q_a

    with the factorisation C for which dM/dt - 2 C is skew-symmetric. With ``dq_a = dq`` and
    ``ddq_a = ddq`` it is the ordinary inverse dynamics.

    Args:
        robot: Robot with n joints.
        q: Joint positions (n,) [rad].
        dq: Joint velocities (n,) [rad/s].
        dq_a: Auxiliary (reference) velocities (n,) [rad/s].
        ddq_a: Auxiliary accelerations (n,) [rad/s^2].
        parameters: Dynamic parameters; None = the robot's nominal ones.
        drives: Whether friction (20) and reflected rotor inertia (21) are included.

    Returns:
        Joint torques (n,) [N m].

    Raises:
        ShapeError: A vector does not have n entries, or `parameters` belong to another robot.
        ValueRangeError: An entry is not finite, or an angle is beyond 1e5 rad.

    Source: Algorithm 1 of [GA17]; kernel twin ``mr_inverse_dynamics``.
    """
    state = _vectors(robot, q=q, dq=dq, dq_a=dq_a, ddq_a=ddq_a)
    return _run(
        _kernel.inverse_dynamics,
        robot.model,
        _packed(robot, parameters),
        state,
        as_truth("drives", drives),
    )


def inverse_dynamics_bounds(
    robot: Robot,
    q: ArrayLike,
    dq: ArrayLike,
    dq_a: ArrayLike,
    ddq_a: ArrayLike,
    bound: str = "hull",
    drives: bool = True,
) -> tuple[Array, Array]:
    r"""Bounds of `inverse_dynamics` over every parameter point inside the robot's bounds.

    ``hull`` is the range itself, joint by joint, (17) to (19); ``ianea`` is the paper's interval
    arithmetic, linear in n and wider. Both enclose their own rounding. Where a joint with Coulomb
    friction moves no faster than its ``coulomb_speed`` both are wider, (20): they count [F_c] with
    [-1, 1], since the sign of so small a measured speed is unknown.

    Args:
        robot: Robot with n joints.
        q: Joint positions (n,) [rad].
        dq: Joint velocities (n,) [rad/s].
        dq_a: Auxiliary velocities (n,) [rad/s].
        ddq_a: Auxiliary accelerations (n,) [rad/s^2].
        bound: "hull" or "ianea".
        drives: Whether friction (20) and reflected rotor inertia (21) are included.

    Returns:
        Lower and upper bounds (n,), (n,) [N m]. As far apart as rounding may be where every
        parameter is exact.

    Raises:
        ShapeError: A vector does not have n entries.
        ValueRangeError: An entry is not finite, an angle is beyond 1e5 rad, or an unknown bound.

    Source: Algorithm 1 of [GA17]; kernel twin ``mr_inverse_dynamics_bounds``.
    """
    state = _vectors(robot, q=q, dq=dq, dq_a=dq_a, ddq_a=ddq_a)
    lo, hi = _run(
        _kernel.inverse_dynamics_bounds,
        robot.model,
        _box(robot),
        state,
        bound_code(bound),
        as_truth("drives", drives),
    )
    return lo, hi


def inverse_dynamics_bounds_batch(
    robot: Robot,
    Q: ArrayLike,
    dQ: ArrayLike,
    dQ_a: ArrayLike,
    ddQ_a: ArrayLike,
    bound: str = "hull",
    drives: bool = True,
    threads: int | None = None,
) -> tuple[Array, Array]:
    r"""`inverse_dynamics_bounds` for k states at once, bit for bit, in vector registers.

    Args:
        robot: Robot with n joints.
        Q: Joint positions (k, n) [rad].
        dQ: Joint velocities (k, n) [rad/s].
        dQ_a: Auxiliary velocities (k, n) [rad/s].
        ddQ_a: Auxiliary accelerations (k, n) [rad/s^2].
        bound: "hull" or "ianea".
        drives: Whether friction (20) and reflected rotor inertia (21) are included.
        threads: Number of threads, at most 4096; None = one for each processor it may use.

    Returns:
        Lower and upper bounds (k, n), (k, n) [N m].

    Raises:
        ShapeError: An array does not have n columns, or not k rows as `Q`.
        ValueRangeError: An entry is not finite, an angle is beyond 1e5 rad, a result overflows
            (the message has its row), or an unknown bound.

    Source: (17) to (19); kernel twin ``mr_inverse_dynamics_bounds_batch``.
    """
    check_robot(robot)
    owner = owner_of(robot)
    rows = as_real("Q", Q, "k rows of numbers").shape[:1] or (0,)
    names = {"Q": Q, "dQ": dQ, "dQ_a": dQ_a, "ddQ_a": ddQ_a}
    given = {name: as_array(name, value, (*rows, robot.n), owner) for name, value in names.items()}
    count = _processors() if threads is None else as_integer("threads", threads, 1, MAX_THREADS)
    lo, hi = _run(
        _kernel.inverse_dynamics_bounds_batch,
        robot.model,
        _box(robot),
        given,
        bound_code(bound),
        as_truth("drives", drives),
        count,
    )
    return lo, hi


def perturbation_bounds(
    robot: Robot,
    q: ArrayLike,
    dq: ArrayLike,
    dq_a: ArrayLike,
    ddq_a: ArrayLike,
    bound: str = "hull",
) -> tuple[Array, Array]:
    r"""The perturbation set: what the true torque may differ from the nominal one, (12).

    .. math:: [\Phi] = \mathrm{NE}^*([\Delta]) - u_0 - [d]

    with u_0 the nominal torque as computed, drives and disturbance included.

    Args:
        robot: Robot with n joints.
        q: Joint positions (n,) [rad].
        dq: Joint velocities (n,) [rad/s].
        dq_a: Auxiliary velocities (n,) [rad/s].
        ddq_a: Auxiliary accelerations (n,) [rad/s^2].
        bound: "hull" or "ianea".

    Returns:
        Lower and upper bounds of [Phi] (n,), (n,) [N m].

    Raises:
        ShapeError: A vector does not have n entries.
        ValueRangeError: An entry is not finite, an angle is beyond 1e5 rad, or an unknown bound.

    Source: (12) of [GA17]; kernel twin ``mr_perturbation_bounds``.
    """
    state = _vectors(robot, q=q, dq=dq, dq_a=dq_a, ddq_a=ddq_a)
    disturbance = np.stack([robot.disturbance.lo, robot.disturbance.hi])
    lo, hi = _run(
        _kernel.perturbation_bounds,
        robot.model,
        (*_box(robot), disturbance),
        state,
        bound_code(bound),
    )
    return lo, hi


def mass_matrix(
    robot: Robot, q: ArrayLike, parameters: Parameters | None = None, drives: bool = True
) -> Array:
    r"""Joint-space mass matrix M(q), symmetric and positive definite, (22).

    Args:
        robot: Robot with n joints.
        q: Joint positions (n,) [rad].
        parameters: Dynamic parameters; None = the robot's nominal ones.
        drives: Whether the reflected rotor inertia k^2 I_m is added on the diagonal.

    Returns:
        M (n, n) [kg m^2].

    Raises:
        ShapeError: q does not have n entries, or `parameters` belong to another robot.
        ValueRangeError: An entry is not finite, or an angle is beyond 1e5 rad.

    Source: composite rigid bodies [WO82]; kernel twin ``mr_mass_matrix``.
    """
    state = _vectors(robot, q=q)
    return _run(
        _kernel.mass_matrix,
        robot.model,
        _packed(robot, parameters),
        state,
        as_truth("drives", drives),
    )


def forward_dynamics(
    robot: Robot,
    q: ArrayLike,
    dq: ArrayLike,
    tau: ArrayLike,
    parameters: Parameters | None = None,
    drives: bool = True,
) -> Array:
    r"""Accelerations of the robot under joint torques, (23) without disturbance.

    .. math:: \ddot q = M(q)^{-1} (\tau - C(q,\dot q)\,\dot q - g(q) - F_v\dot q - F_c s(\dot q))

    Args:
        robot: Robot with n joints.
        q: Joint positions (n,) [rad].
        dq: Joint velocities (n,) [rad/s].
        tau: Joint torques (n,) [N m].
        parameters: Dynamic parameters; None = the robot's nominal ones.
        drives: Whether friction and reflected rotor inertia act.

    Returns:
        Joint accelerations (n,) [rad/s^2].

    Raises:
        ShapeError: A vector does not have n entries, or `parameters` belong to another robot.
        ValueRangeError: An entry is not finite, or an angle is beyond 1e5 rad.
        SingularMassMatrixError: M(q) is not positive definite.

    Source: kernel twin ``mr_forward_dynamics``.
    """
    state = _vectors(robot, q=q, dq=dq, tau=tau)
    return _run(
        _kernel.forward_dynamics,
        robot.model,
        _packed(robot, parameters),
        state,
        as_truth("drives", drives),
    )


def forward_kinematics(robot: Robot, q: ArrayLike) -> Array:
    r"""Link frames in the base frame: products of T_i = before_i J_i(q_i) after_i, (14).

    Args:
        robot: Robot with n joints.
        q: Joint positions (n,) [rad].

    Returns:
        Homogeneous transforms (j, 4, 4), link to base [m]; j = n but for mimic joints.

    Raises:
        ShapeError: q does not have n entries.
        ValueRangeError: An entry is not finite, or an angle is beyond 1e5 rad.

    Source: kernel twin ``mr_forward_kinematics``.
    """
    return _run(_kernel.forward_kinematics, robot.model, (), _vectors(robot, q=q))


def _vectors(robot: Robot, **named: ArrayLike) -> dict[str, Array]:
    check_robot(robot)
    owner = owner_of(robot)
    return {name: as_array(name, value, (robot.n,), owner) for name, value in named.items()}


def _packed(robot: Robot, parameters: Parameters | None) -> tuple[Array]:
    if parameters is None:
        return (robot.nominal.packed,)
    if not isinstance(parameters, Parameters):
        raise ValueRangeError(
            f"parameters: expected Parameters or None, got {type(parameters).__name__}; such as "
            "robot.sample_parameters(0)"
        )
    check_parameters(robot, parameters)
    return (parameters.packed,)


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _box(robot: Robot) -> tuple[Array, Array, Array]:
    return robot.nominal.packed, robot.lower.packed, robot.upper.packed


def _run(
    function: Callable[..., Array],
    model: _kernel.Model,
    parameters: tuple[Array, ...],
    given: dict[str, Array],
    *options: object,
) -> Array:
    """Calls the kernel; an error names the argument that is to blame."""
    try:
        return function(model, *parameters, *given.values(), *options)
    except _kernel.KernelError as problem:
        raise status_error(problem, given) from None
