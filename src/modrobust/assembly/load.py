r"""From an assembly file to a `Robot`: links, placements, settings.

The chain is a sequence of constant spans S and joints. With S_1 ... S_k between joint i and the
next one (or the tip), in order,

.. math:: E_i = S_1 \cdots S_k, \qquad
          P = (S_j \cdots S_k)^{-1}

are the ``after`` of joint i and the placement of a body at the start of S_j: all that follows the
motion of joint i is one link, whatever modules it spreads over. Spans before the first joint are
its ``before``; bodies there belong to the base (joint -1) with placement S_1 ... S_(j-1). The
spans are as written, and each of these products is rounded to doubles once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import accumulate
from operator import matmul
from os import PathLike
from pathlib import Path
from reprlib import repr as short

import numpy as np

from modrobust.assembly.construction import build
from modrobust.assembly.modules.catalogue import builtin_robots
from modrobust.assembly.modules.mounting import EndStep, JointStep, Mounted, SpanStep, mount_chain
from modrobust.assembly.options import Vector, urdf_assembly, with_options
from modrobust.assembly.parts import Parts, PlacedBody, PlacedJoint
from modrobust.assembly.urdf.xml import SUFFIXES as URDF_SUFFIXES
from modrobust.checks import did_you_mean
from modrobust.checks.files import kind_of_path
from modrobust.checks.types import Array
from modrobust.errors import FileError, ValueRangeError
from modrobust.formats import Assembly, BodyItem, load_assembly
from modrobust.kernel import own_environment
from modrobust.model import Robot
from modrobust.model.geometry import IDENTITY, Transform


@own_environment()
def load_robot(
    path_or_name: str | Path,
    *,
    base: str | None = None,
    tip: str | None = None,
    lock: Mapping[str, float | str] | None = None,
    tolerance: str | Mapping[str, object] | None = None,
    payload: str | Mapping[str, object] | None = None,
    mount: Vector | None = None,
    gravity: Vector | None = None,
    xacro: Mapping[str, object] | None = None,
    packages: Mapping[str, str | Path] | None = None,
    drive: str | Mapping[str, object] | None = None,
) -> Robot:
    """The robot of an assembly file or a URDF, or one that comes with modrobust, by name.

    Args:
        path_or_name: A file; or the name of a built-in robot when there is no such file.
        base: URDF only: link that the robot stands on, None = the root.
        tip: URDF only: link where the chain ends, None = every branch.
        lock: URDF only: joint name to the position [rad] or [m] that it is frozen at.
        tolerance: URDF only: bounds where there are none, such as ``"mass=5%,com=5mm"``, or
            ``{"mass": "5%", "com": "5 mm"}`` with the keys of ``tolerance:`` in a file.
        payload: Such as ``"mass=[0 kg, 2 kg], com=[0, 0, 50 mm], at=tool0"``, or a mapping with
            the keys of ``payload:`` in a file; numbers are in SI units.
        mount: Roll, pitch, yaw [rad] of the root (of modules: of the base) in the world, in place
            of ``base: {rpy}``: three numbers or texts with units, or one text such as
            ``"0, 90 deg, 0"``.
        gravity: In world axes [m/s^2], in place of ``gravity:``; written as `mount` is.
        xacro: Arguments of a xacro file, by name.
        packages: Folders of packages by name, for ``package://NAME/...`` as the file and
            ``$(find NAME)`` in xacro.
        drive: URDF only: drive and friction of every joint that moves freely, in place of the
            file's, such as ``"rotor_inertia=1e-5 ± 20%, gear_ratio=100, viscous=1, coulomb=2"``, or
            a mapping with these keys; numbers are in SI units of each joint, bounds may be given.

    Raises:
        FileError: There is neither such a file nor such a robot.
        DescriptionError: The description, or a module of it, is at fault.
        ValueRangeError: No file or name is given, or an option is not of its form.
        MissingExtraError: A xacro file, and the package that expands it is not installed.
    """
    if not str(path_or_name).strip():
        raise ValueRangeError(
            "robot: an empty text; the name of a built-in robot or the path of a file is expected"
        )
    if str(path_or_name).startswith("package://"):
        description = urdf_assembly(str(path_or_name))
    else:
        path = _file_of(path_or_name)
        is_urdf = path.suffix.lower() in (*URDF_SUFFIXES, ".hrdf")
        description = urdf_assembly(path) if is_urdf else load_assembly(path)
    options = (base, tip, lock or {}, tolerance, payload, mount, gravity, xacro, packages, drive)
    return assemble(with_options(description, *options))


def _file_of(path_or_name: str | Path) -> Path:
    if not isinstance(path_or_name, str | PathLike):
        raise ValueRangeError(
            f"robot: {short(path_or_name)}; the name of a built-in robot or the path of a file is "
            "expected"
        )
    path = Path(path_or_name)
    # Only a bare word is a name: "arm.yaml" or "robots/arm" stay files, found or not.
    if kind_of_path(path) == "file" or path.suffix or len(path.parts) != 1:
        return path
    robots = builtin_robots()
    if path.name in robots:
        return robots[path.name]
    known = sorted(robots)
    raise FileError(
        path,
        f"neither a file nor a built-in robot; {did_you_mean(path.name, known)}"
        f"give a file or one of {', '.join(known)}",
    )


@own_environment()
def assemble(description: Assembly) -> Robot:
    """The robot of a description.

    Raises:
        DescriptionError: The chain has no joint or cannot be mounted, a per-joint value or a
            scenario names what is not there, or the mass matrix is singular.
    """
    if description.urdf is not None:
        from modrobust.assembly.urdf.robot import urdf_parts

        name, parts = urdf_parts(description.urdf)
        return build(replace(description, name=description.name or name), parts)
    mounted = mount_chain(description)
    steps = _collect(mounted)
    if not steps.joints:
        raise description.where.error(
            "chain", "no joint in the chain; a robot moves; add a module with a joint"
        )
    return build(description, steps.parts(mounted))


@dataclass(frozen=True)
class _Body:
    """A body on link `link` (-1 = base), at the `position`-th point between the link's spans."""

    name: str
    link: int
    position: int
    item: BodyItem


@dataclass
class _Steps:
    """Joints, bodies and the spans of each link: spans[0] of the base, spans[i + 1] of link i."""

    joints: list[JointStep] = field(default_factory=list)
    bodies: list[_Body] = field(default_factory=list)
    spans: list[list[Transform]] = field(default_factory=lambda: [[]])
    ends: dict[str, tuple[int, int]] = field(default_factory=dict)  # instance: link, position

    def parts(self, mounted: Mounted) -> Parts:
        """The same with transforms: ``before`` only of the first joint, ``after`` of all."""
        last = len(self.joints) - 1
        on_base, *on_links = self.spans
        behind = list(accumulate(on_base, matmul, initial=IDENTITY))
        ahead = [
            list(accumulate(reversed(spans), lambda far, near: near @ far, initial=IDENTITY))[::-1]
            for spans in on_links
        ]

        def frame(link: int, position: int) -> Array:
            there = behind[position] if link < 0 else ahead[link][position].inverse()
            return there.rounded()

        return Parts(
            joints=tuple(
                PlacedJoint(
                    step.name,
                    step.item,
                    i - 1,
                    behind[-1].rounded() if i == 0 else np.eye(4),
                    ahead[i][0].rounded(),
                )
                for i, step in enumerate(self.joints)
            ),
            bodies=tuple(
                PlacedBody(
                    body.name,
                    body.link,
                    frame(body.link, body.position),
                    body.item.mass,
                    body.item.com,
                    body.item.inertia,
                    body.item.inertia_about,
                )
                for body in self.bodies
            ),
            ends={name: (end[0], frame(*end)) for name, end in self.ends.items()},
            tip=(last, np.eye(4)),
            notes=mounted.notes,
            nodes=mounted.nodes,
        )


def _collect(mounted: Mounted) -> _Steps:
    steps = _Steps()
    for step in mounted.steps:
        spans, link = steps.spans[-1], len(steps.joints) - 1
        if isinstance(step, JointStep):
            steps.joints.append(step)
            steps.spans.append([])
        elif isinstance(step, SpanStep):
            spans.append(step.span)
        elif isinstance(step, EndStep):
            steps.ends[step.instance] = (link, len(spans))
        else:
            position = len(spans) + (1 if step.item.at_end else 0)
            spans.append(step.item.span)
            steps.bodies.append(_Body(step.name, link, position, step.item))
    return steps
