"""What a URDF says that makes torque and has no field here: it is named, never passed over.

Other tools write such figures as attributes of ``<dynamics>``, as elements of their own inside a
joint or a transmission, and in the blocks that are meant for them (``<gazebo>``, ``<mujoco>``,
``drake:``). A figure of 0 says nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from modrobust.assembly.urdf.values import refuse_foreign
from modrobust.assembly.urdf.xml import Element

# Words as `_word` makes them: without prefix, small, letters and digits only.
_DYNAMICS = {
    "rotorinertia", "motorinertia", "reflectedinertia", "gearinertia", "inertia", "gearratio",
    "stiffness", "springstiffness", "springconstant", "springk", "springcoefficient", "k", "d",
    "kp", "kd", "springdamping", "implicitspringdamper", "mucoulomb", "muviscous", "coulomb",
    "viscous", "coulombfriction", "frictioncoulomb", "viscousfriction", "frictionviscous",
    "staticfriction", "frictionstatic", "dynamicfriction", "kineticfriction", "stiction",
    "breakawayfriction", "stribeck", "stribeckfriction", "frictionloss", "frictiontorque",
    "viscousdamping", "velocitydamping", "drag", "backlash", "gravcomp",
}  # fmt: skip
# They belong to a stiffness, and make no torque without one.
_COMPANIONS = {
    "springreference", "springref", "reference", "springmount", "restangle", "restposition",
    "equilibrium", "stribeckvelocity",
}  # fmt: skip
# In blocks of other tools, where kp, k or inertia may speak of contacts and controllers.
_ANYWHERE = {
    "armature", "rotorinertia", "motorinertia", "reflectedinertia", "gearinertia", "massmotor",
    "stiffness", "springstiffness", "springconstant", "springk", "mucoulomb", "muviscous",
    "coulombfriction", "viscousfriction", "frictionloss", "stiction", "dampingfactor",
    "velocitydecay", "gravcomp",
}  # fmt: skip
# They are contacts and looks, whatever words stand in them.
_NOT_MOTION = {
    "visual", "collision", "material", "sensor", "surface", "contact", "geometry", "plugin",
    "proximityproperties", "controllergains",
}  # fmt: skip
_OF_THE_ROBOT = {
    "linearbushingrpy", "linearspringdamper", "ballconstraint", "tendonconstraint", "loopjoint",
    "forceelement", "spring", "tendon", "equality",
}  # fmt: skip
_COUPLINGS = ("passive_joint", "gap_joint", "compensator")
# MuJoCo's compiler changes masses and tensors with these; false and -1 are how they are off.
_COMPILER = ("settotalmass", "boundmass", "boundinertia", "balanceinertia", "inertiafromgeom")
_OFF = {"", "0", "false", "-1", "auto", "none"}

# Of the limits of other tools: none says anything about the motion that is computed here.
LIMIT_PASSED = (
    "command_effort", "current", "gear_velocity", "soft_lower_limit", "soft_upper_limit",
    "soft_lower", "soft_upper", "k_position", "k_velocity", "stiffness", "dissipation",
    "max_jerk", "power", "temperature", "voltage",
)  # fmt: skip


@dataclass
class Unmodelled:
    """Names of what makes torque, by joint, by link, and of the whole robot."""

    joints: dict[str, list[str]] = field(default_factory=dict)
    links: dict[str, list[str]] = field(default_factory=dict)
    robot: list[str] = field(default_factory=list)

    def of_joint(self, name: str, words: Iterable[str]) -> None:
        """More of a joint."""
        self.joints.setdefault(name, []).extend(words)

    def listed(self, joints: Sequence[str], links: Sequence[str]) -> list[tuple[str, str]]:
        """Owner and word of what acts in a robot of these moving joints and links."""
        found = [(name, word) for name in joints for word in self.joints.get(name, ())]
        found += [(name, word) for name in links for word in self.links.get(name, ())]
        found += [("", word) for word in self.robot]
        return list(dict.fromkeys(found))


def remark(found: Sequence[tuple[str, str]]) -> list[str]:
    """One sentence on everything that `Unmodelled.listed` found; none where that is nothing."""
    by_word: dict[str, list[str]] = {}
    for owner, word in found:
        by_word.setdefault(word, []).extend([owner] if owner else [])
    by_owners: dict[tuple[str, ...], list[str]] = {}
    for word, owners in by_word.items():
        by_owners.setdefault(tuple(owners), []).append(word)
    said = [
        f"{', '.join(words)} ({', '.join(owners)})" if owners else ", ".join(words)
        for owners, words in by_owners.items()
    ]
    if not said:
        return []
    return [
        f"not modelled, though the file gives it and it makes torque: {'; '.join(said)}; no bound "
        "holds it; give what it can make as a disturbance, or as drive or friction (joints:), in "
        "an assembly file"
    ]


def in_dynamics(dynamics: Element, owner: str) -> list[str]:
    """Words of ``<dynamics>`` that have no field; what nobody understands there is refused."""
    given = [key for key in dynamics.attributes if _word(key) in _DYNAMICS and key not in _READ]
    passed = [key for key in dynamics.attributes if _word(key) in _COMPANIONS]
    refuse_foreign(dynamics, owner, _READ, [*given, *passed])
    return [key for key in given if _says_something(dynamics.attributes[key])]


_CORE = ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic", "calibration",
         "safety_controller", "joint_properties")  # fmt: skip
_READ = ("damping", "friction", "armature")


def in_joint(joint: Element) -> list[str]:
    """Words of a joint's attributes, and of its elements that are not of the format."""
    words = [
        key for key, value in joint.attributes.items()
        if _word(key) in _ANYWHERE and _word(key) != "armature" and _says_something(value)
    ]  # fmt: skip
    for child in joint.children:
        if child.tag not in _CORE:
            words += _inside(child)
    for child in joint.all("joint_properties"):
        words += [
            f"joint_properties {key}"
            for key in ("damping", "friction")
            if _says_something(child.attributes.get(key, "0"))
        ]
    return words


def in_actuator(element: Element) -> list[str]:
    """Words of a transmission's parts that have no field, but for Drake's, which are read."""
    return [
        word
        for child in element.children
        if child.tag not in ("joint", "actuator", "drake:rotor_inertia", "drake:gear_ratio")
        for word in _inside(child)
    ]


def around(root: Element, found: Unmodelled) -> None:
    """What stands beside links and joints: blocks for simulators, springs, couplings."""
    joints = {child.attributes.get("name", "") for child in root.all("joint")}
    for child in root.children:
        word = _word(child.tag)
        if word in _OF_THE_ROBOT or (word == "joint" and ":" in child.tag):
            found.robot.append(f"<{child.tag[:60]}> (line {child.where.line})")
        elif child.tag == "gazebo":
            reference = child.attributes.get("reference", "")
            if reference in joints:
                words = _inside(child, "damping", "friction")
                found.of_joint(reference, (f"gazebo {word}" for word in words))
            elif reference:
                words = [f"gazebo {word}" for word in (*_inside(child), *_weightless(child))]
                found.links.setdefault(reference, []).extend(words)
        elif child.tag == "mujoco":
            found.robot += _mujoco(child)
        elif child.tag == "transmission":
            name = child.attributes.get("name", "")[:60]
            found.robot += [
                f"<{part.tag}> of transmission {name}"
                for part in child.children
                if part.tag in _COUPLINGS
            ]
    for link in root.all("link"):
        if words := _weightless(link):
            found.links.setdefault(link.attributes.get("name", ""), []).extend(words)


def _mujoco(block: Element) -> Iterator[str]:
    for part in block.children:
        if part.tag == "compiler":
            for key in _COMPILER:
                if part.attributes.get(key, "").strip().lower() not in _OFF:
                    yield f"mujoco compiler {key}"
        elif part.tag == "option":
            yield from (
                f"mujoco option {key}" for key in ("gravity", "wind") if key in part.attributes
            )
        else:
            yield from (f"mujoco {word}" for word in _inside(part, "damping"))


def _weightless(element: Element) -> list[str]:
    """Gravity that is taken off a link in one simulator; here it acts on every link."""
    return [
        f"{child.tag} {value}"
        for child in element.children
        if (value := (child.text or child.attributes.get("value", "")).strip().lower())
        and (child.tag, value)
        in {
            ("turnGravityOff", "true"), ("turnGravityOff", "1"),
            ("gravity", "false"), ("gravity", "0"),
        }
    ]  # fmt: skip


def _inside(element: Element, *more: str) -> list[str]:
    """Words anywhere in an element, itself included, whose figures are not 0."""
    known = _ANYWHERE.union(more)
    words = []
    pending = [element]
    while pending:
        part = pending.pop()
        word = _word(part.tag)
        if word in _NOT_MOTION:
            continue
        pending += part.children
        figures = [part.text, *part.attributes.values()]
        if word in known and any(_says_something(text) for text in figures if text):
            words.append(part.tag)
        words += [
            f"{part.tag} {key}"
            for key, value in part.attributes.items()
            if _word(key) in known and _says_something(value)
        ]
    return words


def _word(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.rpartition(":")[2].lower())


def _says_something(text: str) -> bool:
    """Whether a figure, or one of several, is not 0."""
    for part in text.split():
        try:
            if float(part) != 0.0:
                return True
        except ValueError:
            return True
    return False
