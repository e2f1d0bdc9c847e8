r"""From an assembly file to a `Robot`: links, placements, bounds, settings.

The chain is a sequence of constant spans S and joints. With S_1 ... S_k between joint i and the
next one (or the tip), in order,

.. math:: E_i = S_1 \cdots S_k, \qquad
          P = (S_j \cdots S_k)^{-1}

are the ``after`` of joint i and the placement of a body at the start of S_j: all that follows the
motion of joint i is one link, whatever modules it spreads over. Spans before the first joint are
its ``before``; bodies there belong to the base (joint -1) with placement S_1 ... S_(j-1).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from modrobust.catalogue import builtin_robots
from modrobust.errors import FileError
from modrobust.formats import Assembly, JointItem, Quantity, load_assembly
from modrobust.formats.structure import did_you_mean
from modrobust.geometry import inverse
from modrobust.mounting import EndStep, JointStep, Mounted, SpanStep, mount_chain
from modrobust.physical import is_physical
from modrobust.regularity import refuse_singular
from modrobust.robot import Bounded, Parameters, Robot
from modrobust.scenarios import scenario_parameters
from modrobust.settings import controller_settings, per_joint, trajectory_settings

Array = NDArray[np.float64]

_ZERO = Quantity(0.0, 0.0, 0.0, False)
_ENTRIES = ("xx", "xy", "xz", "yy", "yz", "zz")
_SQUARE = [[0, 1, 2], [1, 3, 4], [2, 4, 5]]  # six entries to a tensor


def load_robot(path_or_name: str | Path) -> Robot:
    """The robot of an assembly file, or one that comes with modrobust, by name.

    Args:
        path_or_name: A file; or the name of a built-in robot when there is no such file.

    Raises:
        FileError: There is neither such a file nor such a robot.
        DescriptionError: The assembly or one of its modules is at fault.
    """
    return assemble(load_assembly(_file_of(path_or_name)))


def _file_of(path_or_name: str | Path) -> Path:
    path = Path(path_or_name)
    # Only a bare word is a name: "arm.yaml" or "robots/arm" stay files, found or not.
    if path.is_file() or path.suffix or len(path.parts) != 1:
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


def assemble(description: Assembly) -> Robot:
    """The robot of a description.

    Raises:
        DescriptionError: The chain has no joint or cannot be mounted, a per-joint value or a
            scenario names what is not there, or the mass matrix is singular.
    """
    mounted = mount_chain(description)
    parts = _collect(mounted)
    if not parts.joints:
        raise description.where.error(
            "chain", "no joint in the chain; a robot moves; add a module with a joint"
        )
    bodies = [*parts.bodies, *_payload(description, parts)]
    nominal, lower, upper = (
        _parameters(bodies, parts.joints, end) for end in ("nominal", "lo", "hi")
    )
    names = tuple(step.name for step in parts.joints)
    body_names = tuple(body.name for body in bodies)
    items = [step.item for step in parts.joints]
    types = tuple(item.type for item in items)
    n = len(names)
    before = np.tile(np.eye(4), (n, 1, 1))
    before[0] = _product(parts.spans[0])
    disturbance = per_joint(description.disturbance, names, types) or [_ZERO] * n
    scenarios = scenario_parameters(
        description.scenarios, body_names, parts.joints, nominal, lower, upper
    )
    limits = [(-np.inf, np.inf) if item.position is None else item.position for item in items]
    robot = Robot(
        name=description.name,
        gravity=np.array(description.gravity),
        base=description.base,
        joint_names=names,
        joint_types=types,
        parents=np.arange(-1, n - 1, dtype=np.int32),
        before=before,
        after=np.array([_product(spans) for spans in parts.spans[1:]]),
        position_limits=np.array(limits),
        velocity_limits=np.array([_or_infinite(item.velocity) for item in items]),
        effort_limits=np.array([_or_infinite(item.effort) for item in items]),
        gear_ratio=np.array([item.gear_ratio or 0.0 for item in items]),
        coulomb_speed=np.array([item.coulomb_speed for item in items]),
        body_names=body_names,
        body_joints=np.array([body.link for body in bodies], dtype=np.int32),
        placement=np.array([parts.placement(body) for body in bodies]).reshape(-1, 4, 4),
        nominal=nominal,
        lower=lower,
        upper=upper,
        disturbance=Bounded(
            np.array([q.nominal for q in disturbance]),
            np.array([q.lo for q in disturbance]),
            np.array([q.hi for q in disturbance]),
        ),
        controller=controller_settings(description.controller, names, types),
        exact=_exact(bodies, parts.joints),
        not_modelled=_not_modelled(description, parts.joints),
        notes=(
            *_payload_notes(description),
            *_scenario_notes(scenarios, body_names, nominal),
            *description.notes,
            *mounted.notes,
        ),
        scenarios=scenarios,
        trajectory=trajectory_settings(description.trajectory, names, types),
        initial_q=_vector(per_joint(description.initial_q, names, types)),
        initial_dq=_vector(per_joint(description.initial_dq, names, types)),
        modules=mounted.nodes,
    )
    refuse_singular(robot, [item.where for item in items])
    return robot


@dataclass(frozen=True)
class _Body:
    """A body on link `link` (-1 = base), at the `position`-th point between the link's spans."""

    name: str
    link: int
    position: int
    mass: Quantity
    com: tuple[Quantity, ...]
    inertia: tuple[Quantity, ...]


@dataclass
class _Parts:
    """Joints, bodies and the spans of each link: spans[0] of the base, spans[i + 1] of link i."""

    joints: list[JointStep] = field(default_factory=list)
    bodies: list[_Body] = field(default_factory=list)
    spans: list[list[Array]] = field(default_factory=lambda: [[]])
    ends: dict[str, tuple[int, int]] = field(default_factory=dict)  # instance: link, position

    def placement(self, body: _Body) -> Array:
        """Body frame in its link frame, exactly the identity at the end of the link's spans."""
        spans = self.spans[body.link + 1]
        if body.link < 0:
            return _product(spans[: body.position])
        return inverse(_product(spans[body.position :]))


def _collect(mounted: Mounted) -> _Parts:
    parts = _Parts()
    for step in mounted.steps:
        spans, link = parts.spans[-1], len(parts.joints) - 1
        if isinstance(step, JointStep):
            parts.joints.append(step)
            parts.spans.append([])
        elif isinstance(step, SpanStep):
            spans.append(step.span)
        elif isinstance(step, EndStep):
            parts.ends[step.instance] = (link, len(spans))
        else:
            item = step.item
            position = len(spans) + (1 if item.at_end else 0)
            spans.append(item.span)
            body = _Body(step.name, link, position, item.mass, item.com, item.inertia)
            parts.bodies.append(body)
    return parts


def _product(transforms: Sequence[Array]) -> Array:
    return reduce(np.matmul, transforms) if transforms else np.eye(4)


def _payload(description: Assembly, parts: _Parts) -> list[_Body]:
    payload = description.payload
    if payload is None:
        return []
    last = len(parts.joints) - 1, len(parts.spans[-1])
    if payload.at is None:
        link, position = last
    elif payload.at in parts.ends:
        link, position = parts.ends[payload.at]
    else:
        known = sorted(parts.ends)
        raise payload.where.error(
            "payload.at",
            f'no instance named "{payload.at}"; {did_you_mean(payload.at, known)}'
            f"known: {', '.join(known)}",
        )
    if link < 0:
        raise payload.where.error(
            "payload.at",
            f'"{payload.at}" is fixed to the base, where a payload moves with no joint; '
            "name an instance behind a joint",
        )
    return [_Body("payload", link, position, payload.mass, payload.com, payload.inertia)]


def _payload_notes(description: Assembly) -> tuple[str, ...]:
    payload = description.payload
    if payload is None or not payload.assumed_point:
        return ()
    return ("payload: taken as a point mass, since neither its inertia nor its size is given",)


def _scenario_notes(
    scenarios: Mapping[str, Parameters], body_names: Sequence[str], nominal: Parameters
) -> list[str]:
    return [
        f"scenario {name}: {body} has a tensor that no rigid body has"
        for name, point in scenarios.items()
        for body, physical in zip(
            body_names, is_physical(point.inertia, nominal.inertia), strict=True
        )
        if not physical
    ]


def _parameters(bodies: Sequence[_Body], joints: Sequence[JointStep], end: str) -> Parameters:
    def drive(name: str) -> Array:
        return np.array([getattr(getattr(step.item, name) or _ZERO, end) for step in joints])

    six = np.array([[getattr(q, end) for q in body.inertia] for body in bodies]).reshape(-1, 6)
    return Parameters(
        mass=np.array([getattr(body.mass, end) for body in bodies]),
        com=np.array([[getattr(q, end) for q in body.com] for body in bodies]).reshape(-1, 3),
        inertia=six[:, _SQUARE],
        rotor_inertia=drive("rotor_inertia"),
        viscous=drive("viscous"),
        coulomb=drive("coulomb"),
    )


def _exact(bodies: Sequence[_Body], joints: Sequence[JointStep]) -> tuple[str, ...]:
    """Names of parameters without width; a COM or tensor by its entries only where some have."""
    names: list[str] = []
    for body in bodies:
        groups = (("mass", ("",), (body.mass,)), ("com", ("x", "y", "z"), body.com))
        for group, entries, values in (*groups, ("inertia", _ENTRIES, body.inertia)):
            points = [q.lo == q.hi for q in values]
            if all(points):
                names.append(f"{body.name}.{group}")
            else:
                kept = zip(entries, points, strict=True)
                names += [f"{body.name}.{group}.{entry}" for entry, point in kept if point]
    for step in joints:
        for group, name in _DRIVE:
            quantity = getattr(step.item, name)
            if quantity is not None and quantity.lo == quantity.hi:
                names.append(f"{step.name}.{group}.{name}")
    return tuple(names)


_DRIVE = (("drive", "rotor_inertia"), ("friction", "viscous"), ("friction", "coulomb"))


def _not_modelled(description: Assembly, joints: Sequence[JointStep]) -> tuple[str, ...]:
    """Names of what the description leaves out and the model takes as zero."""
    names: list[str] = []
    for step in joints:
        names += [f"{step.name}.{missing}" for missing in _missing(step.item)]
    return (*names, *(() if description.disturbance else ("disturbance",)))


def _missing(item: JointItem) -> list[str]:
    drive = [] if item.gear_ratio and item.rotor_inertia else ["drive"]
    friction = [name for name in ("viscous", "coulomb") if getattr(item, name) is None]
    if len(friction) == 2:
        return [*drive, "friction"]
    return [*drive, *(f"friction.{name}" for name in friction)]


def _or_infinite(value: float | None) -> float:
    return float(np.inf) if value is None else value


def _vector(values: list[Quantity] | None) -> Array | None:
    return None if values is None else np.array([q.nominal for q in values])
