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

from modrobust.checks import did_you_mean
from modrobust.checks.types import Array
from modrobust.errors import MissingExtraError, ValueRangeError
from modrobust.export.mjcf import mjcf_text
from modrobust.export.urdf import urdf_text
from modrobust.model import Parameters, Robot

BUILTIN = "builtin"
_OUT_OF_RANGE = 1e10  # [rad] or [m], as MuJoCo has it


class Plant(Protocol):
    """A robot in motion: positions q and velocities dq, ``(n,)`` [rad] or [m], per s."""

    q: Array
    dq: Array

    def advance(self, tau: Array) -> None:
        """One tick under the torques of the drives ``tau`` (n,), held, and the disturbance."""


class MujocoPlant:
    """The robot in MuJoCo: mass matrix and bias forces of our MJCF, classical Runge-Kutta.

    Friction and integration are ours, as with Pinocchio: MuJoCo takes a force that follows the
    velocity within a step only by a callback, which would act on every model of the process. So
    none of its functions is used that calls one, that of a user included, or that warns, which
    writes a file. With mimic joints, both are projected on the free ones; MuJoCo's own
    constraint is soft.

    Args:
        robot: Any robot with n free joints, j in all.
        parameters: What the plant is made of.
        disturbance: Constant true disturbance ``(n,)`` [N m] or [N].
        q0, dq0: State at the start, ``(n,)``.
        dt: Tick [s].
        substeps: Steps of the integrator a tick.

    Raises:
        MissingExtraError: The package mujoco is not installed.
    """

    def __init__(
        self,
        robot: Robot,
        parameters: Parameters,
        disturbance: Array,
        q0: Array,
        dq0: Array,
        dt: float,
        substeps: int,
    ) -> None:
        self._mujoco: Any = engine("mujoco", "mujoco", 'plant "mujoco"')
        text = mjcf_text(robot, parameters, timestep=dt / substeps, visual=False).text
        self._model = self._mujoco.MjModel.from_xml_string(text)
        # Neither soft mimic joints nor dry friction: both are made here.
        self._model.opt.disableflags |= int(self._mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        self._data = self._mujoco.MjData(self._model)
        joints = [self._model.joint(name) for name in robot.all_joint_names]
        self._dofs = np.array([joint.dofadr[0] for joint in joints], dtype=np.intp)
        self._places = np.array([joint.qposadr[0] for joint in joints], dtype=np.intp)
        self._friction = _Friction(robot, parameters)
        self._mimic = MimicProjection(robot) if robot.j > robot.n else None
        self._disturbance, self._h, self._substeps = disturbance, dt / substeps, substeps
        self._bias, self._torque = np.empty(self._model.nv), np.empty((1, self._model.nv))
        self._answer = np.empty((1, self._model.nv))
        self.q, self.dq = np.array(q0), np.array(dq0)

    def advance(self, tau: Array) -> None:
        """One tick."""
        drive = tau + self._disturbance
        for _ in range(self._substeps):
            self.q, self.dq = runge_kutta(self._acceleration, self.q, self.dq, drive, self._h)

    def _acceleration(self, q: Array, dq: Array, drive: Array) -> Array:
        mujoco, model, data, mimic = self._mujoco, self._model, self._data, self._mimic
        everything = q if mimic is None else mimic.positions(q)
        rates = dq if mimic is None else mimic.G @ dq
        if not (np.abs(everything) < _OUT_OF_RANGE).all():
            return np.full(len(q), np.nan)
        data.qpos[self._places] = everything
        data.qvel[self._dofs] = rates
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_comVel(model, data)
        mujoco.mj_rne(model, data, 0, self._bias)
        bias = self._bias[self._dofs] + self._friction(rates)
        if mimic is None:
            self._torque[0, self._dofs] = drive - bias
            mujoco.mj_solveM(model, data, self._answer, self._torque)
            return np.asarray(self._answer[0, self._dofs])
        M = np.empty((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        return mimic.acceleration(M[np.ix_(self._dofs, self._dofs)], bias, drive)


class PinocchioPlant:
    """The robot in Pinocchio: our URDF, its articulated-body algorithm, classical Runge-Kutta.

    Arguments as those of `MujocoPlant`. Armature, gravity and friction, which URDF does not hold or
    Pinocchio does not use, are given beside it. With mimic joints, its mass matrix and
    nonlinear effects are projected on the free ones.

    Raises:
        MissingExtraError: The package pin is not installed.
    """

    def __init__(
        self,
        robot: Robot,
        parameters: Parameters,
        disturbance: Array,
        q0: Array,
        dq0: Array,
        dt: float,
        substeps: int,
    ) -> None:
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
        self._friction = _Friction(robot, parameters)
        self._mimic = MimicProjection(robot) if robot.j > robot.n else None
        self._disturbance, self._h, self._substeps = disturbance, dt / substeps, substeps
        self._velocity, self._torque = np.empty(robot.j), np.empty(robot.j)
        self.q, self.dq = np.array(q0), np.array(dq0)

    def advance(self, tau: Array) -> None:
        """One tick."""
        drive = tau + self._disturbance
        for _ in range(self._substeps):
            self.q, self.dq = runge_kutta(self._acceleration, self.q, self.dq, drive, self._h)

    def _acceleration(self, q: Array, dq: Array, drive: Array) -> Array:
        pin, model, data, mimic = self._pin, self._model, self._data, self._mimic
        everything = q if mimic is None else mimic.positions(q)
        rates = dq if mimic is None else mimic.G @ dq
        self._configuration[self._plain_at] = everything[self._plain]
        if len(self._circle):
            angle = everything[self._circle]
            self._configuration[self._circle_at] = np.cos(angle)
            self._configuration[self._circle_at + 1] = np.sin(angle)
        friction = self._friction(rates)
        self._velocity[self._order] = rates
        if mimic is None:
            self._torque[self._order] = drive - friction
            a = pin.aba(model, data, self._configuration, self._velocity, self._torque)
            free: Array = a[self._order]
            return free
        upper = np.triu(pin.crba(model, data, self._configuration))
        M = upper + np.triu(upper, 1).T
        bias = pin.nonLinearEffects(model, data, self._configuration, self._velocity)[self._order]
        return mimic.acceleration(M[np.ix_(self._order, self._order)], bias + friction, drive)


class _Friction:
    """F_v dq + F_c s(dq) of the j joints, (20)."""

    def __init__(self, robot: Robot, parameters: Parameters) -> None:
        self._viscous, self._coulomb = parameters.viscous, parameters.coulomb
        self._speed2 = robot.coulomb_speed**2

    def __call__(self, dq: Array) -> Array:
        smooth = dq / np.sqrt(dq * dq + self._speed2)
        return np.asarray(self._viscous * dq + self._coulomb * smooth)


class MimicProjection:
    """The j joints of a robot from its n free ones, q_all = G q + offset, (15)."""

    def __init__(self, robot: Robot) -> None:
        f = robot.mimic
        self.positions = robot.all_positions
        self.G = np.zeros((robot.j, robot.n))
        self.G[robot.free, np.arange(robot.n)] = 1.0
        self.G[f.joints, f.leaders] = f.multiplier

    def acceleration(self, M: Array, bias: Array, drive: Array) -> Array:
        """Of the free joints ``(n,)``: M (j, j), bias (j,), drive (n,)."""
        G = self.G
        return np.asarray(np.linalg.solve(G.T @ M @ G, drive - G.T @ bias), dtype=np.float64)


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


def make_plant(
    name: str,
    robot: Robot,
    parameters: Parameters,
    disturbance: Array,
    q0: Array,
    dq0: Array,
    dt: float,
    substeps: int,
) -> Plant:
    """The plant of that name, see `MujocoPlant`.

    Raises:
        MissingExtraError: Its engine is not installed.
    """
    return _PLANTS[name](robot, parameters, disturbance, q0, dq0, dt, substeps)


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
