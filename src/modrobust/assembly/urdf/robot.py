"""From a URDF, with what an assembly file or the command line lays over it, to placed parts.

The file passes the strict front end, then our reader with every check, and then yourdfpy reads the
same bytes: what two readers understand differently is refused.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

import numpy as np

from modrobust.assembly.parts import Parts, PlacedBody, PlacedJoint
from modrobust.assembly.urdf.confirm import confirm
from modrobust.assembly.urdf.faults import UrdfFaults
from modrobust.assembly.urdf.files import find_file, load_tree
from modrobust.assembly.urdf.items import (
    inertial_key,
    is_frame,
    is_point,
    read_body,
    read_urdf_joint,
)
from modrobust.assembly.urdf.limits import JointRemarks
from modrobust.assembly.urdf.mimic import within_mimic_limits
from modrobust.assembly.urdf.reader import (
    Inertial,
    Items,
    UrdfDescription,
    read_items,
    read_structure,
)
from modrobust.assembly.urdf.tree import MOVING, Selection, select
from modrobust.assembly.urdf.unmodelled import remark
from modrobust.checks import unknown_name
from modrobust.errors import DescriptionError
from modrobust.formats.overlay import UrdfSource
from modrobust.formats.tolerance import Tolerances
from modrobust.model import ModuleNode

_MANY = 3  # links of a robot do not share one tensor by chance
_WIDE = 1.0  # [m], a radius of gyration beyond which a link of an arm is hardly real


def urdf_parts(source: UrdfSource) -> tuple[str, Parts]:
    """Name and parts of the robot of a URDF.

    Args:
        source: File, selection, locks, overlays, tolerance.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: The file, or what is laid over it, is at fault.
        MissingExtraError: The file is xacro and that package is not installed.
    """
    description = _described(source)
    _check_overlays(description, source)
    chosen = select(description, source.base_link, source.tip_link, source.lock)
    tolerances = Tolerances(source.tolerance)
    notes = [*description.notes, *chosen.notes]
    if not chosen.motions:
        raise description.where.error(
            f"robot {description.name}",
            "no joint that moves; a robot has one; give a URDF of a robot, or lock less",
        )
    faults = UrdfFaults()
    joints = _joints(chosen, source, tolerances, notes, faults)
    bodies = _bodies(description, chosen, source, tolerances, notes, faults)
    faults.stop()
    joints = within_mimic_limits(joints, notes)
    _need_mass(description, chosen, joints, bodies, faults)
    faults.stop()
    moving = [name for name, (joint, _) in chosen.frames.items() if joint >= 0]
    unmodelled = description.unmodelled.listed([joint.name for joint in joints], moving)
    notes += remark(unmodelled)
    notes += _placeholders(description, chosen)
    notes += tolerances.remarks
    if tolerances.unused:
        keys = ", ".join(tolerances.unused)
        notes.append(f"tolerance without a parameter it applies to: {keys}")
    if not any(_bounded(joint, body) for joint in joints for body in bodies):
        notes.insert(
            0,
            "no bounds are given: every figure of the URDF is taken as exact; give a tolerance "
            'such as "mass=5%, com=5 mm, inertia=10%", or an assembly file with bounds',
        )
    ends = {name: (joint, frame.rounded()) for name, (joint, frame) in chosen.frames.items()}
    parts = Parts(
        joints=joints,
        bodies=tuple(bodies),
        ends=ends,
        tip=None if chosen.tip is None else ends[chosen.tip],
        place="link",
        notes=tuple(notes),
        nodes=_nodes(description, chosen, bodies),
        base=chosen.base,
        not_modelled=tuple(".".join(filter(None, found)) for found in unmodelled),
    )
    return description.name, parts


def _bounded(joint: PlacedJoint, body: PlacedBody) -> bool:
    drive = (joint.item.rotor_inertia, joint.item.viscous, joint.item.coulomb)
    every = (*drive, body.mass, *body.com, *body.inertia)
    return any(quantity is not None and quantity.bounded for quantity in every)


def _described(source: UrdfSource) -> UrdfDescription:
    """The links and joints of a URDF or xacro file, read twice.

    Raises:
        FileError: The file cannot be read.
        DescriptionError: The file is at fault.
        SeveralFaultsError: With every figure that is wrong, where it is not known what moves.
        MissingExtraError: The file is xacro and that package is not installed.
    """
    root = load_tree(find_file(source), source)
    faults = UrdfFaults()
    items = read_items(root, faults)
    if not faults.found:
        with faults.caught():
            description = read_structure(root, items)
    if faults.found:
        _check_figures(items, source, faults)
        faults.stop()
    confirm(description, root)
    return description


def _check_figures(items: Items, source: UrdfSource, faults: UrdfFaults) -> None:
    """Adds the faults of joints and of links that may move, where the structure is not known."""
    tolerances = Tolerances(source.tolerance)
    children = {joint.child for joint in items.joints.values()}
    for joint in items.joints.values():
        if joint.type in MOVING and joint.name not in source.lock:
            with faults.of_joint(joint.name):
                read_urdf_joint(joint, source.joints.get(joint.name), tolerances, JointRemarks())
    for name, link in items.links.items():
        overlay = source.links.get(name)
        if name in children and not is_frame(link, overlay):
            with faults.of_link(link):
                read_body(link, overlay, tolerances)


def _check_overlays(description: UrdfDescription, source: UrdfSource) -> None:
    for kind, overlays, known in (
        ("link", source.links, list(description.links)),
        ("joint", source.joints, list(description.joints)),
    ):
        for name, overlay in overlays.items():
            if name not in known:
                raise overlay.where.error(
                    f"{kind}s.{name}",
                    unknown_name(f'no {kind} named "{name[:80]}"', name, known),
                )


def _joints(
    chosen: Selection,
    source: UrdfSource,
    tolerances: Tolerances,
    notes: list[str],
    faults: UrdfFaults,
) -> tuple[PlacedJoint, ...]:
    placed = []
    remarks = JointRemarks()
    for motion in chosen.motions:
        joint = motion.joint
        with faults.of_joint(joint.name):
            overlay = source.joints.get(joint.name)
            option = source.drive if motion.mimic is None else {}  # the drive of its leader
            item = read_urdf_joint(joint, overlay, tolerances, remarks, option)
            before, after = motion.before.rounded(), motion.after.rounded()
            placed.append(PlacedJoint(joint.name, item, motion.parent, before, after, motion.mimic))
    notes += remarks.sentences()
    return tuple(placed)


def _bodies(
    description: UrdfDescription,
    chosen: Selection,
    source: UrdfSource,
    tolerances: Tolerances,
    notes: list[str],
    faults: UrdfFaults,
) -> list[PlacedBody]:
    bodies = []
    for name, (joint, frame) in chosen.frames.items():
        link, overlay = description.links[name], source.links.get(name)
        if is_frame(link, overlay):
            continue
        try:
            masses, inertia, about, own_frame, physical = read_body(link, overlay, tolerances)
        except DescriptionError as problem:
            if joint >= 0 or overlay is not None:
                faults.add_of_link(link, problem)
                continue
            # What does not move cannot make a torque wrong.
            notes.append(
                f"{problem.field or name}: left out, since it does not move: {problem.message}"
            )
            continue
        if joint >= 0 and is_point(link, overlay):
            notes.append(
                f"link {name}: taken as a point mass, since its inertia tensor is all 0; such a "
                "tensor is rarely true, and has no bounds here"
            )
        if not physical:
            notes.append(
                f"link {name}: the bounds of its inertia also hold tensors that no rigid body has"
            )
        placement = frame
        if own_frame:
            assert link.inertial is not None
            placement = frame @ link.inertial.origin
        bodies.append(
            PlacedBody(
                name,
                joint,
                placement.rounded(),
                masses.bounded_mass,
                masses.bounded_com,
                inertia,
                about,
            )
        )
    return bodies


def _need_mass(
    description: UrdfDescription,
    chosen: Selection,
    joints: tuple[PlacedJoint, ...],
    bodies: list[PlacedBody],
    faults: UrdfFaults,
) -> None:
    """Refuses joints without drive behind which nothing has mass: an arm without its figures."""
    loaded = {body.joint for body in bodies}
    if not loaded - {-1} and all(joint.item.rotor_inertia is None for joint in joints):
        raise description.where.error(
            f"robot {description.name}",
            "no link that moves has mass: a file for pictures, not for dynamics; use another "
            "description of this robot, or give mass, com and inertia in an assembly file (links:)",
        )
    pending = list(loaded - {-1})
    while pending:
        joint = joints[pending.pop()]
        carriers = {joint.parent} | ({joint.mimic[0]} if joint.mimic else set())
        pending += carriers - loaded - {-1}
        loaded |= carriers
    for index in range(len(joints) - 1, -1, -1):
        joint = joints[index]
        if index in loaded:
            loaded |= {joint.parent} if joint.mimic is None else {joint.parent, joint.mimic[0]}
        elif joint.mimic is None and joint.item.rotor_inertia is None:
            loaded |= {joint.parent}  # told once, not of every joint before it
            links = [name for name, (owner, _) in chosen.frames.items() if owner == index]
            faults.add_massless(
                links[0],
                joint.item.where.error(
                    f"joint {joint.name}",
                    f"no link behind it has mass ({', '.join(links)}); what moves has mass and "
                    "inertia; complete the <inertial>, give it in an assembly file (links: "
                    f"{{{links[0]}: {{mass: ..., com: ..., inertia: ...}}}}), or freeze the joint "
                    f"(lock: {{{joint.name}: VALUE}})",
                ),
            )


def _placeholders(description: UrdfDescription, chosen: Selection) -> list[str]:
    """Warnings that name links whose figures look made up."""
    groups: dict[tuple[float, ...], list[str]] = defaultdict(list)
    moving: dict[str, Inertial] = {}
    for name, (joint, _) in chosen.frames.items():
        inertial = description.links[name].inertial
        if joint >= 0 and inertial is not None and inertial.mass.value > 0.0:
            moving[name] = inertial
            groups[inertial_key(inertial)[1:]].append(name)
    notes = []
    for tensor, names in groups.items():
        round_one = tensor[0] == tensor[3] == tensor[5] and not any(tensor[k] for k in (1, 2, 4))
        many = len(names) >= _MANY and 2 * len(names) >= len(moving)
        if many or (round_one and len(names) >= _MANY):
            notes.append(
                f"the same inertia tensor on {len(names)} links ({', '.join(names)}): "
                "placeholders? no bound around a made-up figure holds the true one"
            )
    for name, inertial in moving.items():
        trace = sum(inertial.tensor[k].value for k in (0, 3, 5))
        radius = float(np.sqrt(max(trace, 0.0) / 2.0 / inertial.mass.value))
        if radius > _WIDE:
            notes.append(
                f"link {name}: {inertial.mass.value:g} kg with a radius of gyration of "
                f"{radius:.3g} m: a placeholder? no bound around a made-up figure holds the true "
                "one"
            )
    return notes


def _nodes(
    description: UrdfDescription, chosen: Selection, bodies: list[PlacedBody]
) -> tuple[ModuleNode, ...]:
    """The robot as a tree for display: what moves with one joint is one node.

    A chain is a list of nodes; where it branches, each branch hangs on the last one before.
    """
    below: dict[int, list[str]] = defaultdict(list)
    for body in bodies:
        below[body.joint].append(body.name)
    after: dict[int, list[int]] = defaultdict(list)
    for index, motion in enumerate(chosen.motions):
        after[motion.parent].append(index)

    chains: dict[int, list[ModuleNode]] = {}  # from one joint on to the next branching, backwards
    for index in reversed(range(-1, len(chosen.motions))):
        if index < 0:
            node = ModuleNode("base", "urdf", "fixed", (), tuple(below[index]))
        else:
            joint = chosen.motions[index].joint
            node = ModuleNode(joint.child, "urdf", joint.type, (joint.name,), tuple(below[index]))
        branches = [chains.pop(child) for child in after[index]]
        if len(branches) > 1:
            heads = [
                replace(branch[-1], children=(*branch[-2::-1], *branch[-1].children))
                for branch in branches
            ]
            node = replace(node, children=tuple(heads))
        chains[index] = [*(branches[0] if len(branches) == 1 else []), node]
    return tuple(reversed(chains[-1]))
