"""Bodies and joints of a URDF with their overlays and tolerances, held against physics.

A link's inertial becomes nodes of the grammar of module files, overlays replace nodes, and the
readers of module files do the rest: the same bounds, the same checks, the same messages.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

from modrobust.assembly.urdf.joints import Joint
from modrobust.assembly.urdf.limits import JointRemarks, read_limits
from modrobust.assembly.urdf.reader import Inertial, Link
from modrobust.assembly.urdf.transmissions import Transmission
from modrobust.assembly.urdf.values import UrdfNumber
from modrobust.errors import DescriptionError
from modrobust.formats import JointItem, ListNode, MapNode, Node, Quantity, ScalarNode, Where
from modrobust.formats.bodies import Masses, Six, read_inertia, read_masses
from modrobust.formats.faults import Faults
from modrobust.formats.fields import Part, check
from modrobust.formats.joints import read_joint
from modrobust.formats.models import JointModel
from modrobust.formats.part_models import InertiaModel, JointOverlay, LinkOverlay
from modrobust.formats.tolerance import Tolerances
from modrobust.model.symmetric import ENTRIES

P = TypeVar("P", bound=Part)

_DRIVE_PARTS = {"drive": ("rotor_inertia", "gear_ratio"), "friction": ("viscous", "coulomb")}
_ZERO = Quantity(0.0, 0.0, 0.0, bounded=False)


def is_frame(link: Link, overlay: LinkOverlay | None) -> bool:
    """Whether a link is a frame without mass: no inertial, or one of zeros, and no overlay."""
    if link.faults or (overlay is not None and overlay.node.entries):
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
) -> tuple[Masses, Six, str, bool, bool]:
    """Mass and COM, tensor, what it is about, and two flags.

    The first flag: the body's frame is the inertial frame. The second: its box needs no note.
    Figures that no rigid body has are taken as written: `Robot.unphysical`.

    The body frame is the link frame where the inertial is not rotated against it or the overlay
    gives both COM and tensor, and the inertial frame (with its COM at 0) otherwise.

    Raises:
        DescriptionError: A negative mass or moment, or an overlay that lacks something.
    """
    owner = f"link {link.name}"
    inertial = link.inertial
    given = overlay.node.entries if overlay is not None else {}
    if inertial is None or "about" in getattr(given.get("inertia"), "entries", {}):
        _need_all(link, overlay, owner, inertial is None)
    faults = Faults()
    faults.add(*_unmended(link, given))
    rotated = inertial is not None and inertial.rotated
    whole = "com" in given and "inertia" in given and _is_whole(given["inertia"])
    if rotated and not whole and ("com" in given or "inertia" in given):
        assert overlay is not None
        raise overlay.where.error(
            f"links.{link.name}",
            "one of com and inertia; the URDF gives this link's inertial in rotated axes "
            f"(line {link.inertial.where.line if link.inertial else 0}) and an overlay is in the "
            "axes of the link; give com and all six entries of inertia, or neither",
        )
    in_inertial_frame = rotated and not whole
    mass, com, tensor = _nodes(link, given, in_inertial_frame)
    prefix = f"{owner}, "
    masses = _some_masses(mass)
    if "mass" not in link.faults or "mass" in given:
        with faults.caught():
            masses = read_masses(mass, com, prefix, tolerances, no_mass_is_exact=True)
    if is_point(link, overlay):
        faults.stop()
        return masses, (_ZERO,) * 6, "com", in_inertial_frame, True
    about = "about" in getattr(given.get("inertia"), "entries", {})
    if faults.found and about:  # the tensor is moved with a mass that is not known
        faults.stop()
    model = _model(InertiaModel, tensor, owner)
    with faults.caught():
        inertia, physical = read_inertia(model, masses, prefix, tolerances, as_written=True)
    faults.stop()
    return masses, inertia, model.about or "com", in_inertial_frame, physical


def _some_masses(mass: Node) -> Masses:
    """A body of 1 kg at its frame, with which a tensor is checked where the mass is at fault."""
    one, zero = ScalarNode("1", mass.where), ScalarNode("0", mass.where)
    return read_masses(one, ListNode((zero,) * 3, mass.where), "", Tolerances(None))


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


def _unmended(link: Link, given: Mapping[str, Node]) -> list[DescriptionError]:
    """What is wrong in the URDF and stands, because the overlay does not give that figure."""
    whole = "inertia" in given and _is_whole(given["inertia"])
    # Where the origin is not known, neither are the axes of the tensor.
    mended = {"mass": "mass" in given, "inertia": whole, "com": "com" in given and whole}
    return [fault for key, fault in link.faults.items() if not mended[key]]


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
        tensor = {key: entry.node for key, entry in zip(ENTRIES, inertial.tensor, strict=True)}
    overlaid = given.get("inertia")
    if isinstance(overlaid, MapNode):
        # A whole new tensor starts from nothing; single entries replace those of the URDF.
        tensor = dict(overlaid.entries) if _is_whole(overlaid) else tensor | overlaid.entries
        where = overlaid.where
    assert mass is not None
    assert com is not None
    return mass, com, MapNode(tensor, where)


def read_urdf_joint(
    joint: Joint,
    overlay: JointOverlay | None,
    tolerances: Tolerances,
    remarks: JointRemarks,
    option: Mapping[str, Node] | None = None,
) -> JointItem:
    """Limits, drive and friction of a joint; `option` counts more than URDF and overlay.

    Raises:
        DescriptionError: Limits that are reversed, equal or negative; negative friction or inertia.
    """
    owner = f"joint {joint.name}"
    given = overlay.node.entries if overlay is not None else {}
    limits = read_limits(joint, _entries(given.get("limits")), remarks)
    over = {
        part: {key: node for key, node in (option or {}).items() if key in keys}
        for part, keys in _DRIVE_PARTS.items()
    }
    giver = "it is given for all joints" if over["drive"] else "an assembly file gives its drive"
    drive = _drive(joint, {**_entries(given.get("drive")), **over["drive"]}, remarks, giver)
    # Exporters write damping="0" for "not known"; 0 with a tolerance in per cent has no width.
    friction = _present(viscous=_nonzero(joint.damping), coulomb=_nonzero(joint.friction))
    parts = {"limits": limits, "drive": drive, "friction": friction}
    entries: dict[str, Node] = {
        "joint": ScalarNode("joint", joint.where),  # names of URDFs are freer than ours
        "type": ScalarNode(joint.type, joint.where),
    }
    for key, written in parts.items():
        overlaid = given.get(key)
        where, places = joint.where, dict[str, Where]()
        if isinstance(overlaid, MapNode):
            written = written | overlaid.entries
            where, places = overlaid.where, overlaid.key_where
        written = {**written, **over.get(key, {})}
        if written:
            entries[key] = MapNode(written, where, places)
    model = _model(JointModel, MapNode(entries, joint.where), owner)
    item = read_joint(model, f"{owner}, ", tolerances)
    return replace(item, name=joint.name)


def _entries(node: Node | None) -> Mapping[str, Node]:
    return node.entries if isinstance(node, MapNode) else {}


def _drive(
    joint: Joint, overlaid: Mapping[str, Node], remarks: JointRemarks, giver: str
) -> dict[str, Node]:
    """The drive: that of a transmission, or an armature, which is a rotor behind a gear of 1."""
    drive = joint.drive or Transmission(None, None)
    written = _present(gear_ratio=drive.reduction, rotor_inertia=_nonzero(drive.rotor_inertia))
    armature = _nonzero(joint.armature)
    owner = f"joint {joint.name}"
    if armature is None:
        return written
    said = f"armature of {armature.value:g}"
    if overlaid:
        remarks.notes.append(f"{owner}: {said} left out, since {giver}")
        return written
    if "rotor_inertia" in written:
        raise armature.node.where.error(
            f"{owner}, drive",
            f"{said} beside the rotor inertia of a transmission; both are the inertia of the "
            "motor, on either side of the gear; remove one of them, or give the drive in an "
            f"assembly file (joints: {{{joint.name}: {{drive: ...}}}})",
        )
    instead = ""
    if drive.reduction is not None and drive.reduction.value != 1.0:
        instead = ", not the transmission's, since it is on the joint's side"
    remarks.add(f"armature read as a rotor_inertia with a gear_ratio of 1{instead}", joint.name)
    return {"gear_ratio": ScalarNode("1", armature.node.where), "rotor_inertia": armature.node}


def _present(**numbers: UrdfNumber | None) -> dict[str, Node]:
    return {key: number.node for key, number in numbers.items() if number is not None}


def _nonzero(number: UrdfNumber | None) -> UrdfNumber | None:
    return None if number is None or number.value == 0.0 else number


def _model(kind: type[P], node: MapNode, owner: str) -> P:
    def field(location: tuple[int | str, ...]) -> str:
        return ", ".join([owner, ".".join(str(step) for step in location)]).removesuffix(", ")

    return check(kind, node, field)


def inertial_key(inertial: Inertial) -> tuple[float, ...]:
    """Mass and tensor, to find the same figures on several links."""
    return (inertial.mass.value, *(entry.value for entry in inertial.tensor))
