"""Drives of a URDF: reductions of its transmissions, and the rotor inertias that Drake's give."""

from __future__ import annotations

from dataclasses import dataclass, replace

from modrobust.assembly.urdf.unmodelled import Unmodelled, in_actuator
from modrobust.assembly.urdf.values import MAX_NAME, UrdfNumber, read_name, read_number, required
from modrobust.assembly.urdf.xml import Element
from modrobust.errors import DescriptionError
from modrobust.formats import ScalarNode

_GEAR, _ROTOR = "drake:gear_ratio", "drake:rotor_inertia"


@dataclass(frozen=True)
class Transmission:
    """What drives a joint: motor over joint, and the rotor's inertia on the motor's side.

    None where it is not written. A reduction acts once something gives a rotor inertia.
    """

    reduction: UrdfNumber | None
    rotor_inertia: UrdfNumber | None


def read_transmissions(
    root: Element, notes: list[str], unmodelled: Unmodelled
) -> dict[str, Transmission]:
    """Transmissions by joint name, of those from one motor to one joint.

    Args:
        root: The robot.
        notes: Takes a remark for each that is left out.
        unmodelled: Takes what makes torque and is not read.

    Raises:
        DescriptionError: A reduction of 0, or a figure of Drake's that is no number.
    """
    found: dict[str, Transmission] = {}
    for element in root.all("transmission"):
        owner = f"transmission {element.attributes.get('name', '')[:MAX_NAME]}".strip()
        joints = list(element.all("joint"))
        places = [element, *element.all("actuator"), *joints]
        written = {
            tag: [part for place in places for part in place.all(tag)]
            for tag in ("mechanicalReduction", _GEAR, _ROTOR)
        }
        names = [joint.attributes.get("name", "") for joint in joints]
        for name in names:
            unmodelled.of_joint(name, (word for part in places for word in in_actuator(part)))
        if not joints or not any(written.values()):
            continue
        if len(joints) > 1 or any(len(parts) > 1 for parts in written.values()):
            reductions = len(written["mechanicalReduction"]) + len(written[_GEAR])
            notes.append(
                f"{owner}: {len(joints)} joints and {reductions} reductions; only transmissions "
                "from one motor to one joint are used; its reduction is left out"
            )
            for name in names:
                unmodelled.of_joint(name, [_ROTOR] * bool(written[_ROTOR]))
            continue
        name = read_name(joints[0])
        drive = _drive(written, owner, notes)
        if name in found:
            notes.append(f"{owner}: joint {name} has a transmission already; left out")
            unmodelled.of_joint(name, [_ROTOR] * (drive.rotor_inertia is not None))
            continue
        found[name] = drive
    return found


def _drive(written: dict[str, list[Element]], owner: str, notes: list[str]) -> Transmission:
    """The drive; Drake's own gear ratio, 1 where none is written, belongs to its rotor inertia."""
    plain = Transmission(_mechanical(written["mechanicalReduction"], owner, notes), None)
    rotor = gear = None
    for part in written[_ROTOR]:
        rotor = required(part, "value", f"{owner}, {_ROTOR}")
    for part in written[_GEAR]:
        gear = _above_zero(required(part, "value", f"{owner}, {_GEAR}"), part, owner, _GEAR)
    if rotor is None or rotor.value == 0.0:
        return plain if gear is None else replace(plain, reduction=gear)
    if gear is None:
        gear = UrdfNumber(ScalarNode("1", rotor.node.where), 1.0)
    reduction = plain.reduction
    if reduction is not None and reduction.value != gear.value:
        notes.append(
            f"{owner}: its mechanicalReduction of {reduction.value:g} left out; {_ROTOR} acts "
            f"through {_GEAR}, which is {gear.value:g}"
            f"{'' if written[_GEAR] else ' where it is not written'}"
        )
    return Transmission(gear, rotor)


def _mechanical(given: list[Element], owner: str, notes: list[str]) -> UrdfNumber | None:
    if not given:
        return None
    try:
        number = read_number(given[0], "mechanicalReduction", given[0].text, owner)
    except DescriptionError as problem:
        # Placeholders such as "reduction" stand in real files; without a rotor inertia the number
        # acts on nothing.
        notes.append(f"{problem.field}: left out: {problem.message}")
        return None
    return _above_zero(number, given[0], owner, "mechanicalReduction")


def _above_zero(number: UrdfNumber, element: Element, owner: str, key: str) -> UrdfNumber:
    """The number without its sign: that is the direction of the motor; inertia has the square."""
    if number.value == 0.0:
        raise element.where.error(owner, f"{key} is 0; motor over joint is not 0; write that ratio")
    node = ScalarNode(number.node.text.lstrip("+-"), element.where)
    return UrdfNumber(node, abs(number.value))
