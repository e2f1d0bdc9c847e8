"""Bodies and joints of a URDF with their overlays and tolerances, held against physics.

A link's inertial becomes nodes of the grammar of module files, overlays replace nodes, and the
readers of module files do the rest: the same bounds, the same checks, the same messages.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

from modrobust.formats import JointItem, ListNode, MapNode, Node, Quantity, ScalarNode, Where
from modrobust.formats.bodies import Masses, Six, read_inertia, read_masses
from modrobust.formats.fields import Part, check
from modrobust.formats.joints import read_joint
from modrobust.formats.models import JointModel
from modrobust.formats.part_models import InertiaModel, JointOverlay, LinkOverlay
from modrobust.formats.tolerance import Tolerances
from modrobust.urdf_reader import Inertial, Joint, Link
from modrobust.urdf_values import Number

P = TypeVar("P", bound=Part)

_ZERO = Quantity(0.0, 0.0, 0.0, bounded=False)
_ENTRIES = ("xx", "xy", "xz", "yy", "yz", "zz")


def is_frame(link: Link, overlay: LinkOverlay | None) -> bool:
    """Whether a link is a frame without mass: no inertial, or one of zeros, and no overlay."""
    if overlay is not None and overlay.node.entries:
        return False
    inertial = link.inertial
    return inertial is None or not (
        inertial.mass.value or any(entry.value for entry in inertial.tensor)
    )


def is_point(link: Link, overlay: LinkOverlay | None) -> bool:
    """Whether a link has mass and a tensor of six zeros, and no overlay gives another."""
    overlaid = overlay is not None and overlay.inertia is not None
    inertial = link.inertial
    return not overlaid and inertial is not None and not any(x.value for x in inertial.tensor)


def read_body(
    link: Link, overlay: LinkOverlay | None, tolerances: Tolerances
) -> tuple[Masses, Six, bool, bool]:
    """Mass and COM, tensor, whether its frame is the inertial frame, whether its box needs no note.

    Figures that no rigid body has are taken as written: `Robot.unphysical`.

    The body frame is the link frame where the inertial is not turned against it or the overlay
    gives both COM and tensor, and the inertial frame (with its COM at 0) otherwise.

    Raises:
        DescriptionError: A negative mass or moment, or an overlay that lacks something.
    """
    owner = f"link {link.name}"
    inertial = link.inertial
    given = overlay.node.entries if overlay is not None else {}
    if inertial is None or "about" in getattr(given.get("inertia"), "entries", {}):
        _need_all(link, overlay, owner, inertial is None)
    turned = inertial is not None and inertial.turned
    whole = "com" in given and "inertia" in given and _is_whole(given["inertia"])
    if turned and not whole and ("com" in given or "inertia" in given):
        assert overlay is not None
        raise overlay.where.error(
            f"links.{link.name}",
            "one of com and inertia; the URDF gives this link's inertial in turned axes "
            f"(line {link.inertial.where.line if link.inertial else 0}) and an overlay is in the "
            "axes of the link; give com and all six entries of inertia, or neither",
        )
    in_inertial_frame = turned and not whole
    mass, com, tensor = _nodes(link, given, in_inertial_frame)
    prefix = f"{owner}, "
    masses = read_masses(mass, com, prefix, tolerances, no_mass_is_exact=True)
    if is_point(link, overlay):
        return masses, (_ZERO,) * 6, in_inertial_frame, True
    model = _model(InertiaModel, tensor, owner)
    inertia, physical = read_inertia(model, masses, prefix, tolerances, as_written=True)
    return masses, inertia, in_inertial_frame, physical


def _need_all(link: Link, overlay: LinkOverlay | None, owner: str, no_inertial: bool) -> None:
    given = overlay.node.entries if overlay is not None else {}
    missing = [key for key in ("mass", "com", "inertia") if key not in given]
    if "inertia" in given and not _is_whole(given["inertia"]):
        missing.append("inertia.xx, yy, zz")
    if missing and overlay is not None:
        why = "the URDF gives this link no inertial" if no_inertial else '"about" needs the whole'
        raise overlay.where.error(
            f"links.{link.name}", f"no {', '.join(missing)}; {why}; give mass, com and inertia"
        )


def _is_whole(inertia: Node) -> bool:
    return isinstance(inertia, MapNode) and {"xx", "yy", "zz"} <= set(inertia.entries)


def _nodes(
    link: Link, given: Mapping[str, Node], in_inertial_frame: bool
) -> tuple[Node, Node, MapNode]:
    """Mass, COM and tensor: the overlay's where it gives them, else the URDF's."""
    inertial = link.inertial
    where = link.where if inertial is None else inertial.where
    mass = given.get("mass")
    com = given.get("com")
    tensor: dict[str, Node] = {}
    if inertial is not None:
        mass = mass or inertial.mass.node
        zero = ScalarNode("0", inertial.where)
        lengths = (zero,) * 3 if in_inertial_frame else tuple(x.node for x in inertial.xyz)
        com = com or ListNode(lengths, inertial.where)
        tensor = {key: entry.node for key, entry in zip(_ENTRIES, inertial.tensor, strict=True)}
    overlaid = given.get("inertia")
    if isinstance(overlaid, MapNode):
        # A whole new tensor starts from nothing; single entries replace those of the URDF.
        tensor = dict(overlaid.entries) if _is_whole(overlaid) else tensor | overlaid.entries
        where = overlaid.where
    assert mass is not None
    assert com is not None
    return mass, com, MapNode(tensor, where)


def read_urdf_joint(
    joint: Joint, overlay: JointOverlay | None, tolerances: Tolerances, notes: list[str]
) -> JointItem:
    """Limits, drive and friction of a joint.

    Raises:
        DescriptionError: Limits that are missing, reversed or negative; negative friction.
    """
    owner = f"joint {joint.name}"
    prismatic = joint.type == "prismatic"
    limits = _limits(joint, prismatic, notes)
    drive = _present(gear_ratio=joint.reduction)
    # Exporters write damping="0" for "not known"; 0 with a tolerance in per cent has no width.
    friction = _present(viscous=_nonzero(joint.damping), coulomb=_nonzero(joint.friction))
    parts = {"limits": limits, "drive": drive, "friction": friction}
    entries: dict[str, Node] = {
        "joint": ScalarNode("joint", joint.where),  # names of URDFs are freer than ours
        "type": ScalarNode(joint.type, joint.where),
    }
    given = overlay.node.entries if overlay is not None else {}
    for key, written in parts.items():
        overlaid = given.get(key)
        where, places = joint.where, dict[str, Where]()
        if isinstance(overlaid, MapNode):
            written = written | overlaid.entries
            where, places = overlaid.where, overlaid.key_where
        if written:
            entries[key] = MapNode(written, where, places)
    if joint.type != "continuous":
        _need_limits(joint, entries.get("limits"), prismatic)
    model = _model(JointModel, MapNode(entries, joint.where), owner)
    item = read_joint(model, f"{owner}, ", tolerances)
    return replace(item, name=joint.name)


def _limits(joint: Joint, prismatic: bool, notes: list[str]) -> dict[str, Node]:
    """What <limit> says, as entries of `limits:`; a speed or effort of 0 says nothing."""
    entries: dict[str, Node] = {}
    if joint.type != "continuous" and (joint.lower or joint.upper):
        zero = ScalarNode("0", joint.limit_where or joint.where)  # the default of the format
        lower = joint.lower.node if joint.lower else zero
        upper = joint.upper.node if joint.upper else zero
        lo, hi = (number.value if number else 0.0 for number in (joint.lower, joint.upper))
        if lo == hi:
            raise lower.where.error(
                f"joint {joint.name}, limits",
                f"lower and upper limit are both {lo:g}; such a joint cannot move; correct them, "
                f"or freeze it with --lock {joint.name}={lo:g} (lock: {{{joint.name}: {lo:g}}})",
            )
        entries["position"] = ListNode((lower, upper), lower.where)
    for key, number in (("velocity", joint.velocity), ("effort", joint.effort)):
        if number is None:
            continue
        if number.value == 0.0:
            notes.append(f"joint {joint.name}: {key} limit of 0 taken as not given")
        else:
            name = key if key == "velocity" else ("force" if prismatic else "torque")
            entries[name] = number.node
    return entries


def _need_limits(joint: Joint, limits: Node | None, prismatic: bool) -> None:
    """Refuses a joint without the limits that the format requires."""
    known = limits.entries if isinstance(limits, MapNode) else {}
    effort = "force" if prismatic else "torque"
    missing = [] if "position" in known else ["lower and upper"]
    missing += [] if "velocity" in known or joint.velocity else ["velocity"]
    missing += [] if effort in known or joint.effort else ["effort"]
    if missing:
        place = joint.limit_where or joint.where
        raise place.error(
            f"joint {joint.name}, limits",
            f"no {', '.join(missing)}; a {joint.type} joint has limits of position, velocity and "
            f"effort; add them, or give them in an assembly file (joints: {{{joint.name}: "
            "{limits: ...}})",
        )


def _present(**numbers: Number | None) -> dict[str, Node]:
    return {key: number.node for key, number in numbers.items() if number is not None}


def _nonzero(number: Number | None) -> Number | None:
    return None if number is None or number.value == 0.0 else number


def _model(kind: type[P], node: MapNode, owner: str) -> P:
    def field(location: tuple[int | str, ...]) -> str:
        return ", ".join([owner, ".".join(str(step) for step in location)]).removesuffix(", ")

    return check(kind, node, field)


def inertial_key(inertial: Inertial) -> tuple[float, ...]:
    """Mass and tensor, to find the same figures on several links."""
    return (inertial.mass.value, *(entry.value for entry in inertial.tensor))
