"""The exported files read by the engines they are for, called with the free joints in our order.

Mimic joints are like others to the engines; G gives them all, q_all = G q + offset.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin


class Mimicking:
    def __init__(self, robot: Any) -> None:
        self.robot = robot
        f = robot.mimic
        self.G = np.zeros((robot.j, robot.n))
        self.G[robot.free, np.arange(robot.n)] = 1.0
        self.G[f.joints, f.leaders] = f.multiplier


class UrdfTwin(Mimicking):
    """A URDF text in Pinocchio. Gravity and armature are ours to set: URDF holds neither."""

    def __init__(self, text: str, robot: Any) -> None:
        super().__init__(robot)
        self.model = pin.buildModelFromXML(text)
        self.model.gravity.linear = np.array(robot.gravity)
        self.ids = [self.model.getJointId(name) for name in robot.all_joint_names]
        assert max(self.ids, default=0) < self.model.njoints
        self.idx_v = np.array([self.model.joints[i].idx_v for i in self.ids])
        self.data = self.model.createData()

    def q(self, q: Any) -> Any:
        """Configuration of Pinocchio: endless joints are a cosine and a sine."""
        out = np.zeros(self.model.nq)
        for i, angle in zip(self.ids, self.robot.all_positions(q), strict=True):
            joint = self.model.joints[i]
            pair = joint.nq == 2
            out[joint.idx_q : joint.idx_q + joint.nq] = (
                [np.cos(angle), np.sin(angle)] if pair else [angle]
            )
        return out

    def v(self, v: Any) -> Any:
        out = np.empty(self.model.nv)
        out[self.idx_v] = self.G @ v
        return out

    def rnea(self, q: Any, dq: Any, ddq: Any) -> Any:
        tau = pin.rnea(self.model, self.data, self.q(q), self.v(dq), self.v(ddq))
        return self.G.T @ np.array(tau)[self.idx_v]

    def mass_matrix(self, q: Any) -> Any:
        M = np.triu(pin.crba(self.model, self.data, self.q(q)))
        M = M + np.triu(M, 1).T
        return self.G.T @ M[np.ix_(self.idx_v, self.idx_v)] @ self.G


class MjcfTwin(Mimicking):
    """An MJCF text in MuJoCo."""

    def __init__(self, text: str, robot: Any) -> None:
        super().__init__(robot)
        import mujoco

        self.mujoco = mujoco
        self.model = mujoco.MjModel.from_xml_string(text)
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_EQUALITY)
        self.data = mujoco.MjData(self.model)
        names = robot.all_joint_names
        self.dofs = np.array([self.model.joint(name).dofadr[0] for name in names])

    def set(self, q: Any, dq: Any) -> None:
        self.data.qpos[self.dofs] = self.robot.all_positions(q)
        self.data.qvel[self.dofs] = self.G @ dq

    def mass_matrix(self, q: Any) -> Any:
        self.set(q, np.zeros(len(q)))
        self.mujoco.mj_forward(self.model, self.data)
        M = np.zeros((self.model.nv, self.model.nv))
        self.mujoco.mj_fullM(self.model, self.data, M)
        return self.G.T @ M[np.ix_(self.dofs, self.dofs)] @ self.G

    def inverse_dynamics(self, q: Any, dq: Any, ddq: Any) -> Any:
        """Generalised force that makes ddq, damping and armature included, frictionloss not."""
        self.model.dof_frictionloss[:] = 0.0
        self.set(q, dq)
        self.data.qacc[self.dofs] = self.G @ ddq
        self.mujoco.mj_inverse(self.model, self.data)
        return self.G.T @ self.data.qfrc_inverse[self.dofs]
