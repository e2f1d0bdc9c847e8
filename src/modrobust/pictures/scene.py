"""A robot in a scene with floor and light, for pictures and for the viewer; rendered by MuJoCo.

The robot is drawn from its kinematics alone, see `modrobust.export.geoms`.
"""

from __future__ import annotations

import os
import sys
from types import TracebackType
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.errors import MissingExtraError
from modrobust.export.common import leaves, numbers
from modrobust.export.geoms import reach
from modrobust.export.mjcf import mjcf_element
from modrobust.model import Parameters, Robot
from modrobust.simulation.plants import engine

Picture = NDArray[np.uint8]

SIZE = (640, 480)  # [pixels], width and height; even, as H.264 demands
_FONT = 100  # the scale of texts, of which there are none [%]
_ROUND = {"numslices": "16", "numstacks": "8"}  # software OpenGL pays for every facet
_WAS, _WANTED = (0.95, 0.45, 0.1, 0.9), (0.1, 0.4, 0.9, 0.25)
TRAIL_COLOURS = [  # of the trails over a grey floor, thick and thin, 0 to 255
    tuple(round(255 * (share * part + (1.0 - share) * 0.5)) for part in colour[:3])
    for colour in (_WAS, _WANTED)
    for share in (1.0, 0.5, 0.25)
]


class Scene:
    """A robot in a scene with floor and light, rendered offscreen; use it in a ``with``.

    Args:
        robot: Any robot.
        q: Positions that the camera has to take in, (m, n) [rad] or [m].
        parameters: For the places of the COMs; the nominal ones when None.
        size: Width and height [pixels].

    Raises:
        MissingExtraError: mujoco or an OpenGL that renders offscreen is missing.
    """

    def __init__(
        self,
        robot: Robot,
        q: Array,
        parameters: Parameters | None = None,
        size: tuple[int, int] = SIZE,
    ) -> None:
        self._mujoco = engine("mujoco", "video", "video")
        self._size, self._robot = size, robot
        self._gl = offscreen(size)
        self.model, floor, self._camera = scene_model(self._mujoco, robot, q, parameters, size)
        self._data = self._mujoco.MjData(self.model)
        self._places = joint_places(self.model, robot)
        self._tips = leaves(robot)
        self._dot = 0.006 * max(reach(robot), floor)
        self._scene = self._mujoco.MjvScene(self.model, 2000)
        self._option = self._mujoco.MjvOption()
        self._renderer = self._mujoco.MjrContext(self.model, _FONT)
        self._mujoco.mjr_setBuffer(self._mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._renderer)

    def __enter__(self) -> Scene:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._renderer.free()
        self._gl.free()

    def picture(self, q: Array, was: Array | None = None, wanted: Array | None = None) -> Picture:
        """The robot at q (n,), with trails through the tips at `was` and `wanted` (k, n).

        Returns:
            Height x width x 3.
        """
        mj = self._mujoco
        self._data.qpos[self._places] = self._robot.all_positions(q)
        mj.mj_forward(self.model, self._data)
        mj.mjv_updateScene(
            self.model,
            self._data,
            self._option,
            None,
            self._camera,
            mj.mjtCatBit.mjCAT_ALL.value,
            self._scene,
        )
        for states, colour, size in ((was, _WAS, 1.0), (wanted, _WANTED, 1.8)):
            for state in () if states is None else states:
                self._dots(state, colour, size * self._dot)
        width, height = self._size
        rectangle = mj.MjrRect(0, 0, width, height)
        pixels = np.empty((height, width, 3), dtype=np.uint8)
        mj.mjr_render(rectangle, self._scene, self._renderer)
        mj.mjr_readPixels(pixels, None, rectangle, self._renderer)
        return np.flipud(pixels)

    def _dots(self, q: Array, colour: tuple[float, float, float, float], radius: float) -> None:
        frames = _kernel.forward_kinematics(self._robot.model, np.ascontiguousarray(q))
        for tip in self._tips:
            if self._scene.ngeom >= self._scene.maxgeom:
                return
            self._mujoco.mjv_initGeom(
                self._scene.geoms[self._scene.ngeom],
                self._mujoco.mjtGeom.mjGEOM_SPHERE.value,
                np.full(3, radius),
                (self._robot.base @ frames[tip])[:3, 3],
                np.eye(3).ravel(),
                np.array(colour, dtype=np.float32),
            )
            self._scene.ngeom += 1


def scene_model(
    mujoco: Any,
    robot: Robot,
    q: Array,
    parameters: Parameters | None = None,
    size: tuple[int, int] = SIZE,
) -> tuple[Any, float, Any]:
    """MuJoCo's model of robot, floor and light; the extent [m] and a camera that take in all of q.

    The floor lies below everything that moves, up is against gravity's usual direction, world z.
    """
    root, _ = mjcf_element(robot, parameters)
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    low, high = _extent(mujoco, model, robot, q)
    extent = float(np.linalg.norm(high - low))
    margin = 0.05 * reach(robot)
    base = robot.base[:3, 3]
    floor = min(low[2], base[2]) - margin
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "global", offwidth=str(size[0]), offheight=str(size[1]))
    ET.SubElement(
        visual, "headlight", ambient=".35 .35 .35", diffuse=".35 .35 .35", specular="0 0 0"
    )
    ET.SubElement(visual, "quality", {"shadowsize": "1024", "offsamples": "4", **_ROUND})
    ET.SubElement(visual, "map", znear="0.01", zfar="50")
    asset = ET.SubElement(root, "asset")
    ET.SubElement(
        asset, "texture", type="skybox", builtin="gradient", rgb1=".75 .82 .9", rgb2=".95 .96 .98",
        width="64", height="384",
    )  # fmt: skip
    ET.SubElement(
        asset, "texture", name="tiles", type="2d", builtin="checker", rgb1=".78 .8 .82",
        rgb2=".7 .72 .75", width="256", height="256",
    )  # fmt: skip
    ET.SubElement(
        asset, "material", name="tiles", texture="tiles", texrepeat="2 2", texuniform="true"
    )
    world = root.find("worldbody")
    assert world is not None
    centre = 0.5 * (low + high)
    lamp = [*(centre[:2] + np.array([0.4, -0.6]) * extent), high[2] + 1.5 * extent]
    ET.SubElement(
        world, "light", pos=numbers(lamp), dir=numbers(centre - lamp), diffuse=".6 .6 .6",
        specular=".1 .1 .1", castshadow="true",
    )  # fmt: skip
    fixed = {"contype": "0", "conaffinity": "0", "mass": "0"}
    ET.SubElement(
        world, "geom", {"type": "plane", "size": "0 0 .05", "material": "tiles", **fixed},
        pos=numbers([centre[0], centre[1], floor]),
    )  # fmt: skip
    if robot.base[2, 2] > 0.5 and base[2] - floor > 1.5 * margin:  # upright, above the floor
        post = {"type": "cylinder", "size": numbers([1.2 * margin, 0.5 * (base[2] - floor)])}
        middle = numbers([base[0], base[1], 0.5 * (base[2] + floor)])
        ET.SubElement(world, "geom", {**post, **fixed, "rgba": ".35 .37 .4 1"}, pos=middle)
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    camera = mujoco.MjvCamera()
    camera.lookat[:] = 0.5 * (low + high)
    camera.distance = max(1.2 * extent, 1e-2)
    camera.azimuth, camera.elevation = 140.0, -18.0
    return model, extent, camera


def _extent(mujoco: Any, model: Any, robot: Robot, q: Array) -> tuple[Array, Array]:
    """Corners of the box that all drawn parts stay in, (3,), (3,) [m]."""
    data, places = mujoco.MjData(model), joint_places(model, robot)
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for state in q:
        data.qpos[places] = robot.all_positions(state)
        mujoco.mj_kinematics(model, data)
        size = model.geom_rbound[:, None]
        low = np.minimum(low, (data.geom_xpos - size).min(axis=0))
        high = np.maximum(high, (data.geom_xpos + size).max(axis=0))
    return low, high


def joint_places(model: Any, robot: Robot) -> NDArray[np.intp]:
    """Where the positions of our j joints are in MuJoCo's, (j,)."""
    joints = [model.joint(name) for name in robot.all_joint_names]
    return np.array([joint.qposadr[0] for joint in joints], dtype=np.intp)


def offscreen(size: tuple[int, int]) -> Any:
    """An OpenGL context for rendering without a screen, current.

    MUJOCO_GL chooses as it does for MuJoCo itself; without it EGL is tried, then OSMesa, then a
    window system.

    Raises:
        MissingExtraError: None of them works; the message has every reason.
    """
    chosen = os.environ.get("MUJOCO_GL", "").lower().strip()
    kinds: tuple[str, ...] = ("egl", "osmesa", "glfw") if sys.platform == "linux" else ("glfw",)
    if sys.platform == "darwin":
        kinds = ("cgl", "glfw")
    if chosen in (*kinds, "egl", "osmesa", "cgl", "glfw"):
        kinds = (chosen,)
    mujoco = engine("mujoco", "video", "video")
    reasons = []
    for kind in kinds:
        try:
            context: Any = engine(f"mujoco.{kind}", "video", "video").GLContext(*size)
            context.make_current()
            # Without a screen some contexts show only when used that they are none.
            model = mujoco.MjModel.from_xml_string("<mujoco/>")
            mujoco.MjrContext(model, _FONT).free()
        except Exception as problem:  # libraries fail here in any way they like
            reasons.append(f"{kind}: {_reason(problem)}")
        else:
            return context
    raise MissingExtraError(
        f"video: no OpenGL that renders offscreen ({'; '.join(reasons)}); install EGL (Debian: "
        "libegl1 libgl1-mesa-dri) or OSMesa (libosmesa6), or choose one with MUJOCO_GL"
    )


def _reason(problem: Exception) -> str:
    text = " ".join(str(problem).split()) or type(problem).__name__
    return text if len(text) <= 100 else f"{text[:97]}..."
