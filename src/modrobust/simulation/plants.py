r"""The true robot in an engine that is not ours: MuJoCo or Pinocchio, built from our own export.

.. math:: M(q, \Delta)\,\ddot q + C(q, \dot q, \Delta)\,\dot q + g(q, \Delta)
          + F_v \dot q + F_c\,s(\dot q) + k^2 I_m \ddot q = u + d

The rigid-body terms are the engine's own. Friction is applied by us in its smooth form (20) at
every stage of the integrator, since MuJoCo's ``frictionloss`` is a constraint and Pinocchio has
none in its forward dynamics. Nothing here changes state that others in the process share.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, Protocol

import numpy as np

from modrobust import _kernel
from modrobust.checks import did_you_mean
from modrobust.checks.types import Array
from modrobust.errors import MissingExtraError, ValueRangeError
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.model import Parameters, Robot

BUILTIN = "builtin"
_SHARE, _PASSES, _SOLUTIONS = 1.0 - 0.5**0.5, 2, 60  # of the implicit step, as in mr_plant.c
_OUT_OF_RANGE = 1e10  # [rad] or [m], as MuJoCo has it
_TOO_FAST = 1e100  # [rad/s] or [m/s], before squares overflow


class Plant(Protocol):
    """A robot that another engine moves: positions q and velocities dq, ``(n,)``."""

    def step(self, q: Array, dq: Array, drive: Array, h: float) -> tuple[Array, Array]:
        """Q and dq after h [s] under the torques ``drive`` (n,), disturbance included, held."""


class _EnginePlant:
    """Mass matrix and bias forces of an engine; friction, mimic joints and integration are ours.

    Args:
        robot: Any robot with n free joints, j in all.
        parameters: What the plant is made of.
        implicit: An implicit step instead of Runge-Kutta's, for stiff friction.
    """

    def __init__(self, robot: Robot, parameters: Parameters, implicit: bool = False) -> None:
        self._positions = robot.all_positions
        self._G = np.zeros((robot.j, robot.n))
        self._G[robot.free, np.arange(robot.n)] = 1.0
        self._G[robot.mimic.joints, robot.mimic.leaders] = robot.mimic.multiplier
        self._viscous, self._coulomb = parameters.viscous, parameters.coulomb
        self._speed2 = robot.coulomb_speed**2
        speeds = robot.coulomb_speed[parameters.coulomb != 0.0]
        self._close = 1e-10 * float(speeds.min(initial=np.inf)) if len(speeds) else 0.0
        self._implicit = implicit

    def _rigid(self, q: Array, rates: Array) -> tuple[Array, Array]:
        """M, (j, j), and the bias forces, (j,), of all joints, without friction."""
        raise NotImplementedError

    def step(self, q: Array, dq: Array, drive: Array, h: float) -> tuple[Array, Array]:
        """Q and dq after h [s] under the torques ``drive`` (n,), held."""
        if self._implicit:
            return self._implicit_step(q, dq, drive, h)
        return runge_kutta(self._acceleration, q, dq, drive, h)

    def _free(self, q: Array, dq: Array) -> tuple[Array, Array, Array]:
        """M (n, n) and bias (n,) of the free joints, and the slope of friction along dq, (n,)."""
        if not ((np.abs(q) < _OUT_OF_RANGE).all() and (np.abs(dq) < _TOO_FAST).all()):
            raise _kernel.KernelError(_kernel.STATUS_DIVERGED)
        rates = self._G @ dq
        M, bias = self._rigid(self._positions(q), rates)
        return self._G.T @ M @ self._G, self._G.T @ bias, self._slope(dq)

    def _slope(self, dq: Array) -> Array:
        """F_v + F_c / sqrt(dq^2 + v_c^2), by which (20) is linear in dq, of the free joints."""
        rates = self._G @ dq
        slope = self._viscous + self._coulomb / np.sqrt(rates * rates + self._speed2)
        return np.asarray(slope @ self._G**2)

    def _derivative(self, dq: Array) -> Array:
        """Of friction (20), of the free joints."""
        rates = self._G @ dq
        root2 = rates * rates + self._speed2
        coulomb = np.divide(
            self._coulomb * self._speed2, root2**1.5, out=np.zeros(len(rates)), where=root2 > 0.0
        )
        return np.asarray((self._viscous + coulomb) @ self._G**2)

    def _acceleration(self, q: Array, dq: Array, drive: Array) -> Array:
        M, bias, slope = self._free(q, dq)
        return np.asarray(np.linalg.solve(M, drive - bias - slope * dq))

    def _implicit_step(self, q: Array, dq: Array, drive: Array, h: float) -> tuple[Array, Array]:
        """The two-stage method of Alexander, as ``mr_implicit_step`` has it."""
        g = _SHARE * h
        first = self._implicit_stage(q, dq, drive, g, dq)
        before = (1.0 - _SHARE) / _SHARE
        q0, dq0 = q + before * g * first, dq + before * (first - dq)
        second = self._implicit_stage(q0, dq0, drive, g, first)
        return q0 + g * second, second

    def _implicit_stage(self, q0: Array, dq0: Array, drive: Array, g: float, dq1: Array) -> Array:
        """dq1 = dq0 + g ddq(q0 + g dq1, dq1) from a first guess of it."""
        for _ in range(_PASSES):
            M, bias, _ = self._free(q0 + g * dq1, dq1)
            fixed = M @ dq0 + g * (drive - bias)
            for _ in range(_SOLUTIONS):
                found = self._friction_step(M, fixed, g, dq1)
                change, dq1 = float(np.abs(found - dq1).max()), found
                if not change > 1e-10 * float(np.abs(dq1).max()) + self._close:
                    break
        return dq1

    def _friction_step(self, M: Array, fixed: Array, g: float, x: Array) -> Array:
        """A better x for M x + g friction(x) = fixed, as ``friction_stage`` finds it."""
        slope, derivative = self._slope(x), self._derivative(x)
        safe = np.linalg.solve(M + np.diag(g * slope), fixed)
        residual = fixed - M @ x - g * slope * x
        fast = x + np.linalg.solve(M + np.diag(g * derivative), residual)

        def energy(x: Array) -> float:
            rates = self._G @ x
            root = np.sqrt(rates * rates + self._speed2)
            friction = 0.5 * self._viscous @ (rates * rates) + self._coulomb @ root
            return float(x @ (0.5 * M @ x - fixed) + g * friction)

        e_safe = energy(np.asarray(safe))
        better = energy(np.asarray(fast)) <= e_safe + 2.0**-50 * abs(e_safe)
        return np.asarray(fast if better else safe)


class MujocoPlant(_EnginePlant):
    """The robot in MuJoCo: mass matrix and bias forces of our MJCF, classical Runge-Kutta.

    Friction and integration are ours, as with Pinocchio: MuJoCo takes a force that follows the
    velocity within a step only by a callback, which would act on every model of the process. So
    none of its functions is used that calls one, that of a user included, or that warns, which
    writes a file. With mimic joints, both are projected on the free ones; MuJoCo's own
    constraint is soft.

    Args:
        robot: Any robot with n free joints, j in all.
        parameters: What the plant is made of.
        implicit: An implicit step instead of Runge-Kutta's, for stiff friction.

    Raises:
        MissingExtraError: The package mujoco is not installed.
    """

    def __init__(self, robot: Robot, parameters: Parameters, implicit: bool = False) -> None:
        super().__init__(robot, parameters, implicit)
        self._mujoco: Any = engine("mujoco", "mujoco", 'plant "mujoco"')
        text = mjcf_text(robot, parameters, visual=False).text
        self._model = self._mujoco.MjModel.from_xml_string(text)
        # Neither soft mimic joints nor dry friction: both are made here.
        self._model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        self._data = self._mujoco.MjData(self._model)
        joints = [self._model.joint(name) for name in robot.all_joint_names]
        self._dofs = np.array([joint.dofadr[0] for joint in joints], dtype=np.intp)
        self._places = np.array([joint.qposadr[0] for joint in joints], dtype=np.intp)
        self._bias = np.empty(self._model.nv)

    def _rigid(self, q: Array, rates: Array) -> tuple[Array, Array]:
        mujoco, model, data = self._mujoco, self._model, self._data
        if not (np.abs(q) < _OUT_OF_RANGE).all():
            raise _kernel.KernelError(_kernel.STATUS_DIVERGED)
        data.qpos[self._places] = q
        data.qvel[self._dofs] = rates
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_comVel(model, data)
        mujoco.mj_rne(model, data, 0, self._bias)
        M = np.empty((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        return M[np.ix_(self._dofs, self._dofs)], self._bias[self._dofs]


class PinocchioPlant(_EnginePlant):
    """The robot in Pinocchio: our URDF, its articulated-body algorithm, classical Runge-Kutta.

    Arguments as those of `MujocoPlant`. Armature, gravity and friction, which URDF does not hold or
    Pinocchio does not use, are given beside it. With mimic joints, its mass matrix and
    nonlinear effects are projected on the free ones.

    Raises:
        MissingExtraError: The package pin is not installed.
    """

    def __init__(self, robot: Robot, parameters: Parameters, implicit: bool = False) -> None:
        super().__init__(robot, parameters, implicit)
        self._pin: Any = engine("pinocchio", "pinocchio", 'plant "pinocchio"')
        self._model = self._pin.buildModelFromXML(urdf_text(robot, parameters).text)
        self._model.gravity.linear = np.array(robot.gravity)
        names = robot.all_joint_names
        joints = [self._model.joints[self._model.getJointId(name)] for name in names]
        self._order = np.array([joint.idx_v for joint in joints], dtype=np.intp)
        # An endless revolute joint is a cosine and a sine in Pinocchio.
        endless = np.array([joint.nq == 2 for joint in joints], dtype=bool)
        places = np.array([joint.idx_q for joint in joints], dtype=np.intp)
        self._plain, self._circle = np.flatnonzero(~endless), np.flatnonzero(endless)
        self._plain_at, self._circle_at = places[~endless], places[endless]
        self._configuration = np.zeros(self._model.nq)
        armature = np.empty(robot.j)
        armature[self._order] = robot.gear_ratio**2 * parameters.rotor_inertia
        self._model.armature = armature
        self._data = self._model.createData()
        self._velocity = np.empty(robot.j)

    def _rigid(self, q: Array, rates: Array) -> tuple[Array, Array]:
        pin, model, data = self._pin, self._model, self._data
        self._configuration[self._plain_at] = q[self._plain]
        if len(self._circle):
            angle = q[self._circle]
            self._configuration[self._circle_at] = np.cos(angle)
            self._configuration[self._circle_at + 1] = np.sin(angle)
        self._velocity[self._order] = rates
        upper = np.triu(pin.crba(model, data, self._configuration))
        M = upper + np.triu(upper, 1).T
        bias = pin.nonLinearEffects(model, data, self._configuration, self._velocity)
        return M[np.ix_(self._order, self._order)], bias[self._order]


def runge_kutta(
    acceleration: Callable[[Array, Array, Array], Array],
    q: Array,
    dq: Array,
    drive: Array,
    h: float,
) -> tuple[Array, Array]:
    """One step of the classical method: q and dq after h [s] under held torques."""
    a1 = acceleration(q, dq, drive)
    v2 = dq + 0.5 * h * a1
    a2 = acceleration(q + 0.5 * h * dq, v2, drive)
    v3 = dq + 0.5 * h * a2
    a3 = acceleration(q + 0.5 * h * v2, v3, drive)
    v4 = dq + h * a3
    a4 = acceleration(q + h * v3, v4, drive)
    after = q + h / 6.0 * (dq + 2.0 * (v2 + v3) + v4)
    return after, dq + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)


_PLANTS: dict[str, Callable[..., Plant]] = {"mujoco": MujocoPlant, "pinocchio": PinocchioPlant}
PLANTS = (BUILTIN, *_PLANTS)


def make_plant(name: str, robot: Robot, parameters: Parameters, implicit: bool = False) -> Plant:
    """The plant of that name, see `MujocoPlant`.

    Raises:
        MissingExtraError: Its engine is not installed.
    """
    return _PLANTS[name](robot, parameters, implicit)


def check_plant(name: str) -> None:
    """Refuse a plant that is not known, or whose engine is not installed, before a run.

    Raises:
        ValueRangeError: No plant of that name.
        MissingExtraError: The message names the extra.
    """
    if not isinstance(name, str) or name not in PLANTS:
        hint = did_you_mean(name, PLANTS)
        raise ValueRangeError(f'plant: no plant "{name}"; {hint}known: {", ".join(PLANTS)}')
    if name != BUILTIN:
        engine(name, name, f'plant "{name}"')


def engine(module: str, extra: str, wanted_by: str) -> Any:
    """An optional package, imported.

    Raises:
        MissingExtraError: It is not installed; the message names the extra that brings it.
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as problem:
        if (problem.name or "").split(".")[0] != module.split(".")[0]:
            raise
        raise MissingExtraError(
            f"{wanted_by}: the package {module} is not installed; "
            f'install it with pip install "modrobust[{extra}]"'
        ) from None
