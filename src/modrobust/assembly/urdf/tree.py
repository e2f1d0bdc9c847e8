r"""The part of a URDF's tree that becomes the robot: base, tip, locked joints, frames.

A joint of a URDF turns about an axis of its own frame. With A the rotation that takes z to that
axis, its motion is

.. math:: T(q) = O\, A\, J_z(q)\, A', \qquad before = O A, \quad after = A'

so that link frames are those of the URDF and the kernel's joints are about z exactly. Fixed and
locked joints become constant transforms; what hangs behind them moves with the link above, each
link a body of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from modrobust.assembly.urdf.joints import Joint
from modrobust.assembly.urdf.reader import UrdfDescription
from modrobust.checks import unknown_name
from modrobust.formats import Node, ScalarNode
from modrobust.formats.quantity import parse_angle, parse_exact
from modrobust.model.geometry import IDENTITY, Transform, rotation_z, translation

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, eq=False)
class Motion:
    """A joint of the robot: index of its parent (-1 = base), ``before`` and ``after``.

    mimic: index of the leader, multiplier, offset; None for a joint that is free.
    """

    joint: Joint
    parent: int
    before: Transform
    after: Transform
    mimic: tuple[int, float, float] | None = None


@dataclass(frozen=True)
class Selection:
    """The joints, parents first, and every link's frame in what it moves with.

    Free joints stand before mimic joints, as far as none of these carries them.

    Args:
        frames: Link name to index of the joint it moves with (-1 = base) and frame.
        tip: The link at the end, None where several branches end.
        base: The root's frame to that of the link that the robot stands on.
    """

    motions: tuple[Motion, ...]
    frames: dict[str, tuple[int, Transform]]
    tip: str | None
    notes: tuple[str, ...]
    base: Transform = IDENTITY


def select(
    description: UrdfDescription,
    base: ScalarNode | None,
    tip: ScalarNode | None,
    lock: Mapping[str, Node],
) -> Selection:
    """The chosen part of a description.

    Args:
        description: Links and joints.
        base: Link that the robot stands on, None = the root.
        tip: Link where the chain ends, None = every branch.
        lock: Joint name to position.

    Raises:
        DescriptionError: A name that does not exist, a tip that is not behind the base, a lock
            outside the limits, or a joint that cannot move here: floating, planar, or one that
            mimics a joint which is not there.
    """
    first = _link(description, base, "base_link") or description.root
    last = _link(description, tip, "tip_link")
    path = None if last is None else _path(description, first, last, tip)
    walk = _Walk(description, _locked(description, lock), path, last)
    walk.run(first)
    motions, frames = _free_first(description, walk.motions, walk.frames)
    if last is not None and motions:
        _fold_tip(motions, frames, last)
    if last is None:
        ends = [name for name in frames if not description.child_joints.get(name)]
        last = ends[0] if len(ends) == 1 else None
    upright = walk.upright(first)
    return Selection(tuple(motions), frames, last, tuple(walk.notes), upright)


def _link(description: UrdfDescription, node: ScalarNode | None, field: str) -> str | None:
    if node is None:
        return None
    if node.text not in description.links:
        raise node.where.error(
            field, unknown_name(f'no link named "{node.text[:80]}"', node.text, description.links)
        )
    return node.text


def _path(
    description: UrdfDescription, first: str, last: str, tip: ScalarNode | None
) -> frozenset[str]:
    """Names of the links from base to tip."""
    links = [last]
    while links[-1] != first:
        joint = description.parent_joint.get(links[-1])
        if joint is None:
            assert tip is not None
            raise tip.where.error(
                "tip_link",
                f'link "{last}" is not behind the base link "{first}"; a chain runs from the base '
                "away from the root; choose another base or tip",
            )
        links.append(joint.parent)
    return frozenset(links)


def _locked(description: UrdfDescription, lock: Mapping[str, Node]) -> dict[str, Fraction]:
    """Positions of the locked joints, those that mimic a locked one included."""
    found: dict[str, Fraction] = {}
    for name, node in lock.items():
        field = f"lock.{name}"
        joint = description.joints.get(name)
        if joint is None:
            known = [joint.name for joint in description.joints.values() if joint.type in MOVING]
            raise node.where.error(
                field, unknown_name(f'no joint named "{name[:80]}"', name, known)
            )
        if joint.type not in MOVING:
            raise node.where.error(
                field,
                f"a {joint.type} joint (line {joint.where.line}); only revolute, continuous and "
                "prismatic joints can be locked; remove this entry",
            )
        prismatic = joint.type == "prismatic"
        exact = parse_exact(node, "length", field) if prismatic else parse_angle(node, field)
        value = float(exact)  # as the limits, so that a joint can be locked at one of them
        lo = joint.lower.value if joint.lower else None
        hi = joint.upper.value if joint.upper else None
        outside = (lo is not None and value < lo) or (hi is not None and value > hi)
        if joint.type != "continuous" and outside:
            raise node.where.error(
                field,
                f"{value:g} lies outside the joint's limits [{lo or 0.0:g}, {hi or 0.0:g}] "
                f"(line {joint.where.line}); lock it at a position that it can have",
            )
        found[name] = exact
    progress = True
    while progress:  # mimic joints of mimic joints
        progress = False
        for joint in description.joints.values():
            mimic = joint.mimic
            if mimic is None or joint.name in found or joint.type not in MOVING:
                continue
            if not mimic.multiplier or mimic.leader in found:
                leader = found[mimic.leader] if mimic.multiplier else 0
                found[joint.name] = mimic.multiplier * leader + mimic.offset
                progress = True
    return found


@dataclass
class _Walk:
    """The walk from the base to the ends, depth first, branches in the order of the file."""

    description: UrdfDescription
    locked: dict[str, Fraction]
    path: frozenset[str] | None
    last: str | None
    motions: list[Motion] = field(default_factory=list)
    frames: dict[str, tuple[int, Transform]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def run(self, first: str) -> None:
        self.frames[first] = (-1, IDENTITY)
        pending = self._children(first)
        while pending:
            joint = pending.pop()
            rigid = joint.type == "fixed" or joint.name in self.locked
            aside = self.path is not None and joint.child not in self.path
            if aside and (not rigid or joint.parent == self.last):
                self._left_out(joint)
                continue
            index, frame = self.frames[joint.parent]
            if rigid:
                held = self.locked.get(joint.name, Fraction(0))
                moved = frame @ joint.origin @ self._frozen(joint, held)
                self.frames[joint.child] = (index, moved)
            else:
                self._refuse(joint)
                before = frame @ joint.origin @ joint.axis
                self.motions.append(Motion(joint, index, before, joint.axis.inverse()))
                self.frames[joint.child] = (len(self.motions) - 1, IDENTITY)
            pending += self._children(joint.child)

    def upright(self, first: str) -> Transform:
        """The root's frame to that of the base link, what moves between them standing still."""
        way: list[Joint] = []
        link = first
        while (joint := self.description.parent_joint.get(link)) is not None:
            way.insert(0, joint)
            link = joint.parent
        frame, held = IDENTITY, []
        for joint in way:
            frame = frame @ joint.origin @ self._frozen(joint, self._still(joint))
            if joint.type != "fixed":
                held.append(self._held(joint))
        if held:
            self.notes.append(
                f"upright is the root {link} of the URDF; between it and the base {first} moves "
                f"what is held still here: {', '.join(held)}; where it stands elsewhere, gravity "
                "has another direction: lock it there (lock:), or turn the root (base: {rpy})"
            )
        return frame

    def _held(self, joint: Joint) -> str:
        """Where a joint before the base stands."""
        if joint.type not in MOVING:
            return f"{joint.type} joint {joint.name} at its origin"
        unit = "m" if joint.type == "prismatic" else "rad"
        value = max(min(self._still(joint), Fraction(10**300)), Fraction(-(10**300)))
        return f"joint {joint.name} at {float(value):g} {unit}"

    def _still(self, joint: Joint) -> Fraction:
        """Position of a joint before the base: where it is locked, else 0, as it mimics that."""
        if joint.name in self.locked or joint.mimic is None:
            return self.locked.get(joint.name, Fraction(0))
        leader = self._still(self.description.joints[joint.mimic.leader])
        return joint.mimic.multiplier * leader + joint.mimic.offset

    def _children(self, link: str) -> list[Joint]:
        return self.description.child_joints.get(link, [])[::-1]

    def _frozen(self, joint: Joint, value: Fraction) -> Transform:
        """The motion of a joint that stands at `value`; none where it is fixed or floats."""
        if not value or joint.type not in MOVING:
            return IDENTITY
        motion = translation((0, 0, value)) if joint.type == "prismatic" else rotation_z(value)
        return joint.axis @ motion @ joint.axis.inverse()

    def _refuse(self, joint: Joint) -> None:
        """Refuses a joint whose motion the model does not have."""
        owner = f"joint {joint.name}"
        if joint.type not in MOVING:
            raise joint.where.error(
                owner,
                f"a {joint.type} joint; joints are revolute, continuous, prismatic or fixed; a "
                f"robot with a base that moves freely is none here; take the part behind it "
                f"with base_link: {joint.child}",
            )

    def _left_out(self, joint: Joint) -> None:
        """Notes what the choice of the tip leaves out, with its mass."""
        names, mass = [], 0.0
        pending = [joint.child]
        while pending:
            name = pending.pop()
            pending += [below.child for below in self._children(name)]
            inertial = self.description.links[name].inertial
            if inertial is not None and inertial.mass.value != 0.0:
                names.append(name)
                mass += inertial.mass.value
        if names:
            self.notes.append(
                f"left out behind joint {joint.name}, since the chain ends at {self.last}: "
                f"{', '.join(names)} ({mass:.6g} kg)"
            )


def _free_first(
    description: UrdfDescription, motions: list[Motion], frames: dict[str, tuple[int, Transform]]
) -> tuple[list[Motion], dict[str, tuple[int, Transform]]]:
    """Motions and frames with the free joints first and mimic joints behind them.

    A free joint that a mimic joint carries stands behind it, since parents come first.

    Raises:
        DescriptionError: A leader does not move here.
    """
    behind: set[int] = set()  # mimic joints, and all that they carry
    for i, motion in enumerate(motions):
        if motion.joint.mimic is not None or motion.parent in behind:
            behind.add(i)
    order = [*(i for i in range(len(motions)) if i not in behind), *sorted(behind)]
    index = {old: new for new, old in enumerate(order)} | {-1: -1}
    at = {
        motion.joint.name: index[i]
        for i, motion in enumerate(motions)
        if motion.joint.mimic is None
    }
    ordered = []
    for old in order:
        motion = motions[old]
        joint = motion.joint
        mimic = None if joint.mimic is None else _leader(description, joint, at)
        ordered.append(Motion(joint, index[motion.parent], motion.before, motion.after, mimic))
    return ordered, {name: (index[i], frame) for name, (i, frame) in frames.items()}


def _leader(
    description: UrdfDescription, joint: Joint, at: Mapping[str, int]
) -> tuple[int, float, float]:
    """Index of the free joint at the end of a chain of mimics, multiplier and offset to it.

    Args:
        description: The URDF with all its joints.
        joint: The joint that mimics.
        at: Name of each free joint to its index.
    """
    multiplier, offset, last = Fraction(1), Fraction(0), joint
    while last.mimic is not None:
        offset += multiplier * last.mimic.offset
        multiplier *= last.mimic.multiplier
        last = description.joints[last.mimic.leader]
    if last.name not in at:
        assert joint.mimic is not None
        raise joint.mimic.where.error(
            f"joint {joint.name}, mimic",
            f'mimics joint "{last.name}", which does not move here (fixed, or not chosen); a '
            f"joint mimics one that moves; freeze it (lock: {{{joint.name}: VALUE}})",
        )
    try:
        return at[last.name], float(multiplier), float(offset)
    except OverflowError:
        assert joint.mimic is not None
        raise joint.mimic.where.error(
            f"joint {joint.name}, mimic",
            "out of range with the joints that it mimics; check the multipliers and offsets",
        ) from None


def _fold_tip(motions: list[Motion], frames: dict[str, tuple[int, Transform]], tip: str) -> None:
    """Makes the tip the frame of the last link: its ``after`` then runs to the tip."""
    index, frame = frames[tip]
    if index < 0 or frame == IDENTITY:
        return
    back = frame.inverse()
    motion = motions[index]
    motions[index] = replace(motion, after=motion.after @ frame)
    for name, (owner, placed) in frames.items():
        if owner == index:
            frames[name] = (index, IDENTITY if name == tip else back @ placed)
