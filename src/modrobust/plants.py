r"""The true robot in an engine that is not ours: MuJoCo or Pinocchio, built from our own export.

.. math:: M(q, \Delta)\,\ddot q + C(q, \dot q, \Delta)\,\dot q + g(q, \Delta)
          + F_v \dot q + F_c\,s(\dot q) + k^2 I_m \ddot q = u + d

The rigid-body terms are the engine's own. Coulomb friction is applied by us in its smooth form
(20) at every stage of the integrator, since MuJoCo's ``frictionloss`` is a constraint and Pinocchio
has none; so is viscous friction with Pinocchio, which has none in its forward dynamics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from modrobust.describe.mjcf import mjcf_text
from modrobust.describe.urdf import urdf_text
from modrobust.errors import MissingExtraError, ValueRangeError
from modrobust.names import did_you_mean
from modrobust.robot import Parameters, Robot

Array = NDArray[np.float64]

BUILTIN = "builtin"


class Plant(Protocol):
    """A robot in motion: positions q and velocities dq, ``(n,)`` [rad] or [m], per s."""

    q: Array
    dq: Array

    def advance(self, tau: Array) -> None:
        """One tick under the torques of the drives ``tau`` (n,), held, and the disturbance."""


class MujocoPlant:
    """The robot in MuJoCo: our MJCF with armature and damping, its own RK4.

    Joints that follow another are an equality constraint in MuJoCo, which is soft. Then only mass
    matrix and bias forces are MuJoCo's; they are projected on the free joints, and integrated here.

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
        # Without frictionloss: the smooth form is applied in _friction.
        point = replace(parameters, coulomb=np.zeros(robot.j))
        text = mjcf_text(robot, point, timestep=dt / substeps, visual=False).text
        self._model = self._mujoco.MjModel.from_xml_string(text)
        bits = self._mujoco.mjtDisableBit
        # A state that is out of range shall show, not start anew from zero.
        self._model.opt.disableflags |= int(bits.mjDSBL_AUTORESET) | int(bits.mjDSBL_EQUALITY)
        self._data = self._mujoco.MjData(self._model)
        joints = [self._model.joint(name) for name in robot.all_joint_names]
        self._dofs = np.array([joint.dofadr[0] for joint in joints], dtype=np.intp)
        self._places = np.array([joint.qposadr[0] for joint in joints], dtype=np.intp)
        self._coulomb, self._speed2 = np.empty(robot.j), np.empty(robot.j)
        self._coulomb[self._dofs] = parameters.coulomb
        self._speed2[self._dofs] = robot.coulomb_speed**2
        self._smooth = bool(self._coulomb.any())
        self._led = _Led(robot) if robot.j > robot.n else None
        self._disturbance, self._h, self._substeps = disturbance, dt / substeps, substeps
        self._data.qpos[self._places] = robot.all_positions(np.asarray(q0))
        self._data.qvel[self._dofs[robot.free]] = dq0
        self.q, self.dq = np.array(q0), np.array(dq0)

    def advance(self, tau: Array) -> None:
        """One tick."""
        mujoco = self._mujoco
        # Both hooks are the whole process's: ours for the time of the step. Without the second,
        # MuJoCo writes a file into the working directory when a state goes out of range.
        passive, warning = mujoco.get_mjcb_passive(), mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(_silent)
        if self._smooth:
            mujoco.set_mjcb_passive(self._friction)
        try:
            self._step(tau)
        finally:
            mujoco.set_mjcb_passive(passive)
            mujoco.set_mju_user_warning(warning)

    def _step(self, tau: Array) -> None:
        n = len(self.q)
        drive = tau + self._disturbance
        if self._led is None:
            # Not through the motors: MuJoCo sets controls beyond 1e10 to zero without a word.
            self._data.qfrc_applied[self._dofs] = drive
            self._mujoco.mj_step(self._model, self._data, self._substeps)
            self.q = self._data.qpos[self._places[:n]]
            self.dq = self._data.qvel[self._dofs[:n]]
            return
        for _ in range(self._substeps):
            self.q, self.dq = runge_kutta(self._acceleration, self.q, self.dq, drive, self._h)

    def _acceleration(self, q: Array, dq: Array, drive: Array) -> Array:
        assert self._led is not None
        mujoco, model, data = self._mujoco, self._model, self._data
        data.qpos[self._places] = self._led.positions(q)
        data.qvel[self._dofs] = self._led.G @ dq
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        M = np.empty((model.nv, model.nv))
        mujoco.mj_fullM(model, data, M)
        bias = (data.qfrc_bias - data.qfrc_passive)[self._dofs]
        return self._led.acceleration(M[np.ix_(self._dofs, self._dofs)], bias, drive)

    def _friction(self, _: Any, data: Any) -> None:
        v = data.qvel
        data.qfrc_passive[:] -= self._coulomb * v / np.sqrt(v * v + self._speed2)


def _silent(_: str) -> None:
    """A run that diverges says so itself."""


class PinocchioPlant:
    """The robot in Pinocchio: our URDF, its articulated-body algorithm, classical Runge-Kutta.

    Arguments as those of `MujocoPlant`. Armature, gravity and friction, which URDF does not hold or
    Pinocchio does not use, are given beside it. Where joints follow others, its mass matrix and
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
        self._viscous, self._coulomb = parameters.viscous, parameters.coulomb
        self._speed2 = robot.coulomb_speed**2
        self._led = _Led(robot) if robot.j > robot.n else None
        self._disturbance, self._h, self._substeps = disturbance, dt / substeps, substeps
        self._velocity, self._torque = np.empty(robot.j), np.empty(robot.j)
        self.q, self.dq = np.array(q0), np.array(dq0)

    def advance(self, tau: Array) -> None:
        """One tick."""
        drive = tau + self._disturbance
        for _ in range(self._substeps):
            self.q, self.dq = runge_kutta(self._acceleration, self.q, self.dq, drive, self._h)

    def _acceleration(self, q: Array, dq: Array, drive: Array) -> Array:
        pin, model, data, led = self._pin, self._model, self._data, self._led
        everything = q if led is None else led.positions(q)
        rates = dq if led is None else led.G @ dq
        self._configuration[self._plain_at] = everything[self._plain]
        if len(self._circle):
            angle = everything[self._circle]
            self._configuration[self._circle_at] = np.cos(angle)
            self._configuration[self._circle_at + 1] = np.sin(angle)
        smooth = rates / np.sqrt(rates * rates + self._speed2)
        friction = self._viscous * rates + self._coulomb * smooth
        self._velocity[self._order] = rates
        if led is None:
            self._torque[self._order] = drive - friction
            a = pin.aba(model, data, self._configuration, self._velocity, self._torque)
            free: Array = a[self._order]
            return free
        upper = np.triu(pin.crba(model, data, self._configuration))
        M = upper + np.triu(upper, 1).T
        bias = pin.nonLinearEffects(model, data, self._configuration, self._velocity)[self._order]
        return led.acceleration(M[np.ix_(self._order, self._order)], bias + friction, drive)


class _Led:
    """The j joints of a robot led by its n free ones, q_all = G q + offset, (15)."""

    def __init__(self, robot: Robot) -> None:
        f = robot.followers
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
