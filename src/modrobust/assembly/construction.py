"""From placed parts and the settings of a description to a `Robot`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from modrobust.assembly.parts import Parts, PlacedBody, PlacedJoint
from modrobust.assembly.regularity import refuse_singular
from modrobust.assembly.scenarios import scenario_parameters
from modrobust.assembly.settings import controller_settings, per_joint, trajectory_settings
from modrobust.checks import unknown_name
from modrobust.checks.types import Array, Flags
from modrobust.formats import Assembly, JointItem, Payload, Quantity
from modrobust.model import Bounded, MimicJoints, Parameters, Robot
from modrobust.model.physical import ABOUT_FRAME
from modrobust.model.sampling import physical_bodies
from modrobust.model.symmetric import ENTRIES

_ZERO = Quantity(0.0, 0.0, 0.0, False)
_SQUARE = [[0, 1, 2], [1, 3, 4], [2, 4, 5]]  # six entries to a tensor
_DRIVE = (("drive", "rotor_inertia"), ("friction", "viscous"), ("friction", "coulomb"))


def build(description: Assembly, parts: Parts) -> Robot:
    """The robot of a description whose parts are placed.

    Raises:
        DescriptionError: A per-joint value, the payload or a scenario names what is not there, or
            the mass matrix is singular.
    """
    joints = parts.joints
    carried = _payload(description, parts)
    bodies = [*parts.bodies, *carried]
    nominal, lower, upper = _points(bodies, joints)
    free = [joint for joint in joints if joint.mimic is None]
    names = tuple(joint.name for joint in free)
    items = [joint.item for joint in free]
    types = tuple(item.type for item in items)
    disturbance = per_joint(description.disturbance, names, types) or [_ZERO] * len(names)
    body_names = tuple(body.name for body in bodies)
    abouts = tuple(body.inertia_about for body in bodies)
    framed = np.array([about == ABOUT_FRAME for about in abouts], dtype=np.bool_)
    scenarios = scenario_parameters(
        description.scenarios, body_names, joints, nominal, lower, upper
    )
    limits = [(-np.inf, np.inf) if item.position is None else item.position for item in items]
    robot = Robot(
        name=description.name,
        gravity=np.array(description.gravity),
        base=(description.base @ parts.base).rounded(),
        joint_names=names,
        joint_types=tuple(joint.item.type for joint in joints),
        parents=np.array([joint.parent for joint in joints], dtype=np.int32),
        before=np.array([joint.before for joint in joints]),
        after=np.array([joint.after for joint in joints]),
        position_limits=np.array(limits),
        velocity_limits=np.array([_or_infinite(item.velocity) for item in items]),
        effort_limits=np.array([_or_infinite(item.effort) for item in items]),
        acceleration_limits=np.array([_or_infinite(item.acceleration) for item in items]),
        gear_ratio=np.array([joint.item.gear_ratio or 0.0 for joint in joints]),
        coulomb_speed=np.array([joint.item.coulomb_speed for joint in joints]),
        body_names=body_names,
        body_joints=np.array([body.joint for body in bodies], dtype=np.int32),
        placement=np.array([body.placement for body in bodies]).reshape(-1, 4, 4),
        nominal=nominal,
        lower=lower,
        upper=upper,
        disturbance=Bounded(
            np.array([q.nominal for q in disturbance]),
            np.array([q.lo for q in disturbance]),
            np.array([q.hi for q in disturbance]),
        ),
        controller=controller_settings(description.controller, names, types),
        exact=_exact(bodies, joints),
        not_modelled=(*_not_modelled(description, joints), *parts.not_modelled),
        notes=(
            *_payload_notes(description),
            *_scenario_notes(scenarios, body_names, nominal, framed),
            *(f"source: {text}" for text in description.source),
            *description.notes,
            *parts.notes,
        ),
        scenarios=scenarios,
        scenario_notes=description.scenario_notes,
        trajectory=trajectory_settings(description.trajectory, names, types),
        initial_q=_vector(per_joint(description.initial_q, names, types)),
        initial_dq=_vector(per_joint(description.initial_dq, names, types)),
        modules=parts.nodes,
        mimic=_mimic_joints(joints),
        inertia_about=abouts,
        loop=description.loop.resolve(names, types),
        payloads={
            name: _points([*parts.bodies, *(_figures(body, payload) for body in carried)], joints)
            for name, payload in description.payloads.items()
        },
    )
    places = [joint.item.where for joint in joints]
    refuse_singular(robot, places)
    for name, (point, *_) in robot.payloads.items():
        alone = replace(robot, nominal=point, lower=point, upper=point, payloads={})
        refuse_singular(alone, places, f"payload {name}")
    remark = _unphysical(robot, parts.place)
    return replace(robot, notes=(*robot.notes, remark)) if remark else robot


def _payload(description: Assembly, parts: Parts) -> list[PlacedBody]:
    payload = description.payload
    if payload is None:
        return []
    known = sorted(parts.ends)
    if payload.at is None:
        if parts.tip is None:
            raise payload.where.error(
                "payload",
                f'no "at"; this robot has several ends; name the {parts.place} that carries it, '
                f"one of {', '.join(known)}",
            )
        joint, frame = parts.tip
    elif payload.at in parts.ends:
        joint, frame = parts.ends[payload.at]
    else:
        raise payload.where.error(
            "payload.at",
            unknown_name(f'no {parts.place} named "{payload.at}"', payload.at, known),
        )
    if joint < 0:
        raise payload.where.error(
            "payload.at",
            f'"{payload.at}" is fixed to the base, where a payload moves with no joint; '
            f"name {_article(parts.place)} behind a joint",
        )
    if any(body.name == "payload" for body in parts.bodies):
        raise payload.where.error(
            "payload", 'a body is named "payload" already; names differ; rename that one'
        )
    figures = (payload.mass, payload.com, payload.inertia, payload.inertia_about)
    return [PlacedBody("payload", joint, frame, *figures)]


def _figures(body: PlacedBody, payload: Payload) -> PlacedBody:
    """The body with the figures of another payload at the same place."""
    return replace(body, mass=payload.mass, com=payload.com, inertia=payload.inertia)


def _mimic_joints(joints: Sequence[PlacedJoint]) -> MimicJoints:
    free = [i for i, joint in enumerate(joints) if joint.mimic is None]
    entry = {i: k for k, i in enumerate(free)}
    found = [(i, *joint.mimic) for i, joint in enumerate(joints) if joint.mimic is not None]
    return MimicJoints(
        names=tuple(joints[i].name for i, *_ in found),
        leaders=np.array([entry[leader] for _, leader, _, _ in found], dtype=np.int32),
        multiplier=np.array([multiplier for _, _, multiplier, _ in found], dtype=np.float64),
        offset=np.array([offset for _, _, _, offset in found], dtype=np.float64),
        joints=np.array([i for i, *_ in found], dtype=np.int32),
    )


def _article(word: str) -> str:
    return f"an {word}" if word[0] in "aeiou" else f"a {word}"


def _payload_notes(description: Assembly) -> tuple[str, ...]:
    several = ((f"payload {name}", payload) for name, payload in description.payloads.items())
    return tuple(
        f"{name}: taken as a point mass, since neither its inertia nor its size is given"
        for name, payload in (("payload", description.payload), *several)
        if payload is not None and payload.assumed_point
    )


def _scenario_notes(
    scenarios: Mapping[str, Parameters],
    body_names: Sequence[str],
    nominal: Parameters,
    framed: Flags,
) -> list[str]:
    return [
        f"scenario {name}: {body} has a tensor that no rigid body has"
        for name, point in scenarios.items()
        for body, physical in zip(body_names, physical_bodies(nominal, point, framed), strict=True)
        if not physical
    ]


def _unphysical(robot: Robot, place: str) -> str:
    """The one remark on bodies whose figures no rigid body has; empty where there are none."""
    if not robot.unphysical:
        return ""
    kind, kinds = ("link", "links") if place == "link" else ("body", "bodies")
    count = len(robot.unphysical)
    worst = max(robot.unphysical, key=robot.unphysical.__getitem__)
    by = robot.unphysical[worst]
    mass = robot.nominal.mass[robot.body_names.index(worst)]
    if np.isfinite(by):
        found = f"largest principal moment {100.0 * by:.3g} % above the sum of the other two"
    elif mass == 0.0:
        found = "an inertia tensor without mass"
    else:
        found = "a principal moment about one axis alone"
    if count == 1:
        return (
            f"{kind} {worst}: {found}; no rigid body has that; taken as written, since the mass "
            "matrix is positive definite"
        )
    return (
        f"{count} {kinds} have figures that no rigid body has, {worst} most ({found}); taken as "
        "written, since the mass matrix is positive definite"
    )


def _points(
    bodies: Sequence[PlacedBody], joints: Sequence[PlacedJoint]
) -> tuple[Parameters, Parameters, Parameters]:
    """Nominal, lower and upper figures."""
    nominal, lower, upper = (_parameters(bodies, joints, end) for end in ("nominal", "lo", "hi"))
    return nominal, lower, upper


def _parameters(
    bodies: Sequence[PlacedBody], joints: Sequence[PlacedJoint], end: str
) -> Parameters:
    def drive(name: str) -> Array:
        return np.array([getattr(getattr(joint.item, name) or _ZERO, end) for joint in joints])

    six = np.array([[getattr(q, end) for q in body.inertia] for body in bodies]).reshape(-1, 6)
    return Parameters(
        mass=np.array([getattr(body.mass, end) for body in bodies]),
        com=np.array([[getattr(q, end) for q in body.com] for body in bodies]).reshape(-1, 3),
        inertia=six[:, _SQUARE],
        rotor_inertia=drive("rotor_inertia"),
        viscous=drive("viscous"),
        coulomb=drive("coulomb"),
    )


def _exact(bodies: Sequence[PlacedBody], joints: Sequence[PlacedJoint]) -> tuple[str, ...]:
    """Names of parameters without width; a COM or tensor by its entries only where some have."""
    names: list[str] = []
    for body in bodies:
        groups = (("mass", ("",), (body.mass,)), ("com", ("x", "y", "z"), body.com))
        for group, entries, values in (*groups, ("inertia", ENTRIES, body.inertia)):
            points = [q.lo == q.hi for q in values]
            if all(points):
                names.append(f"{body.name}.{group}")
            else:
                kept = zip(entries, points, strict=True)
                names += [f"{body.name}.{group}.{entry}" for entry, point in kept if point]
    for joint in joints:
        for group, name in _DRIVE:
            quantity = getattr(joint.item, name)
            if quantity is not None and quantity.lo == quantity.hi:
                names.append(f"{joint.name}.{group}.{name}")
    return tuple(names)


def _not_modelled(description: Assembly, joints: Sequence[PlacedJoint]) -> tuple[str, ...]:
    """Names of what the description leaves out and the model takes as zero."""
    names: list[str] = []
    for joint in joints:
        names += [f"{joint.name}.{missing}" for missing in _missing(joint.item)]
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
