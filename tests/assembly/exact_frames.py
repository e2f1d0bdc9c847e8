"""The transforms of a description in balls of 300 bits, from its text; nothing of modrobust's.

An oracle for `before`, `after`, `placement` and `base`: numbers, spans, the chain and the tree of a
URDF are read here once more, as docs/reference/formats.md and docs/reference/urdf.md describe them.
"""

from __future__ import annotations

import math
import re
from collections.abc import Container
from fractions import Fraction
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import flint
from ruamel.yaml import YAML

BITS = 300
PI = Fraction("3.14159265358979323846264338327950288419716939937510")
RIGHT = {float(k * PI / 2): k for k in range(-16, 17)}
UNITS: dict[str, int | Fraction] = {"": 1, "m": 1, "rad": 1}
UNITS |= {"mm": Fraction(1, 1000), "cm": Fraction(1, 100)}
NUMBER = re.compile(r"([+-]?)\s*(.*?[\dpi])\s*(m|mm|cm|rad|deg|°)?")
FRAMES = ("before", "after", "placement", "base")

Frames = dict[str, dict[str, flint.arb_mat]]  # "before", "after", "placement", "base" by name


def ball(value: Fraction | int) -> flint.arb:
    value = Fraction(value)
    return flint.arb(flint.fmpq(value.numerator, value.denominator))


def number(text: str) -> tuple[Fraction, int]:
    """A length [m] or an angle [rad] as the grammar means it: r, k of r pi^k."""
    match = NUMBER.fullmatch(text.strip())
    assert match, text
    sign, product, unit = match.groups(default="")
    rational, powers = Fraction(-1 if sign == "-" else 1), 0
    for operator, factor in re.findall(r"([*/]?)\s*([^*/\s]+)", product):
        if factor == "pi":
            powers += -1 if operator == "/" else 1
        else:
            rational *= 1 / Fraction(factor) if operator == "/" else Fraction(factor)
    return (rational / 180, 1) if unit in ("deg", "°") else (rational * UNITS[unit], powers)


def length(text: str) -> flint.arb:
    rational, powers = number(text)
    assert powers == 0, text
    return ball(rational)


def angle(text: str) -> flint.arb:
    """An angle; where a decimal's nearest double is that of a right angle, the right angle."""
    rational, powers = number(text)
    if powers == 0 and float(rational) in RIGHT:
        rational, powers = Fraction(RIGHT[float(rational)], 2), 1
    return ball(rational) * flint.arb.pi() ** powers


def turn(axis: str, by: flint.arb) -> flint.arb_mat:
    c, s = by.cos(), by.sin()
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    rows = [[flint.arb(int(r == q)) for q in range(4)] for r in range(4)]
    rows[j][j], rows[j][k], rows[k][j], rows[k][k] = c, -s, s, c
    return flint.arb_mat(rows)


def shift(x: Any = 0, y: Any = 0, z: Any = 0) -> flint.arb_mat:
    rows = [[flint.arb(int(r == q)) for q in range(4)] for r in range(4)]
    for row, length in zip(rows, (x, y, z), strict=False):
        row[3] = flint.arb(length)
    return flint.arb_mat(rows)


ONE = shift()


def inverse(T: flint.arb_mat) -> flint.arb_mat:
    back = [[T[j, i] for j in range(3)] for i in range(3)]
    moved = [-sum((back[i][j] * T[j, 3] for j in range(3)), flint.arb(0)) for i in range(3)]
    zero, one = flint.arb(0), flint.arb(1)
    return flint.arb_mat(
        [[*row, p] for row, p in zip(back, moved, strict=True)] + [[zero, zero, zero, one]]
    )


def pose(xyz: list[flint.arb], rpy: list[flint.arb]) -> flint.arb_mat:
    return shift(*xyz) * turn("z", rpy[2]) * turn("y", rpy[1]) * turn("x", rpy[0])


def span(written: dict[str, Any] | None) -> flint.arb_mat:
    if not written:
        return ONE
    zero = ["0", "0", "0"]
    if "dh" in written or "giusti2015" in written:
        letters = written.get("dh") or written["giusti2015"]

        def v(key: str) -> flint.arb:
            read_as = angle if key in ("alpha", "theta", "delta_in", "delta_out") else length
            return read_as(letters.get(key, "0"))

        if letters["convention"] == "standard":
            return turn("z", v("theta")) * shift(v("a"), 0, v("d")) * turn("x", v("alpha"))
        if letters["convention"] == "modified":
            return (
                turn("x", v("alpha")) * shift(v("a")) * turn("z", v("theta")) * shift(0, 0, v("d"))
            )
        if letters["convention"] == "giusti":
            near = shift(0, 0, -v("p")) * turn("z", -v("delta_in"))
        else:
            near = turn("z", v("delta_in")) * shift(0, 0, v("p"))
        far = shift(0, 0, v("n")) * turn("z", v("delta_out"))
        return near * shift(v("a")) * turn("x", v("alpha")) * far
    xyz, rpy = written.get("xyz", zero), written.get("rpy", zero)
    return pose([length(text) for text in xyz], [angle(text) for text in rpy])


def read(path: Path) -> dict[str, Any]:
    """A description with every scalar as text."""
    loaded: dict[str, Any] = YAML(typ="base", pure=True).load(path.read_text(encoding="utf-8"))
    return loaded


AHEAD = {"a", "alpha"}


def chain_frames(path: Path, *builtin: Path) -> Frames:
    """Frames of an assembly of modules; `builtin` are further directories of modules."""
    robot = read(path)
    folders = [path.parent / robot["modules"]] if "modules" in robot else []
    steps: list[tuple[str, str, flint.arb_mat | None]] = []
    _mount(robot["chain"], "", [*folders, *builtin], steps)
    frames: Frames = {key: {} for key in FRAMES}
    frames["base"]["base"] = span(robot.get("base"))
    links: list[list[flint.arb_mat]] = [[]]
    joints: list[str] = []
    bodies: list[tuple[str, int, int]] = []
    for kind, name, transform in steps:
        if kind == "joint":
            joints.append(name)
            links.append([])
            continue
        if kind in ("start", "end"):
            bodies.append((name, len(joints), len(links[-1]) + (kind == "end")))
        assert transform is not None
        links[-1].append(transform)
    for i, name in enumerate(joints):
        frames["before"][name] = _product(links[0]) if i == 0 else ONE
        frames["after"][name] = _product(links[i + 1])
    for name, link, position in bodies:
        spans = links[link]
        frames["placement"][name] = (
            inverse(_product(spans[position:])) if link else _product(spans[:position])
        )
    return frames


def _mount(
    chain: list[Any],
    prefix: str,
    folders: list[Path],
    steps: list[tuple[str, str, flint.arb_mat | None]],
) -> None:
    used: set[str] = set()
    for item in chain:
        entry: dict[str, Any] = {"module": item} if isinstance(item, str) else item
        if "module" not in entry:
            kind = next(key for key in ("joint", "body", "frame") if key in entry)
            name = prefix + entry[kind]
            transform = None if kind == "joint" else span(entry.get("span"))
            if kind == "body":
                kind = entry.get("expressed_in", "start")
            row = entry.get("dh") if kind == "joint" else None
            if row:  # modified: what stands before the joint, then what stands behind it
                ahead = {"dh": {"convention": "modified"} | {k: row[k] for k in AHEAD & set(row)}}
                steps.append(("frame", "", span(ahead)))
            steps.append((kind, name, transform))
            if row:
                steps.append(("frame", "", shift(0, 0, length(row.get("d", "0")))))
            continue
        name, count = entry.get("as", entry["module"]), 1
        while name in used:
            count += 1
            name = f"{entry['module']}-{count}"
        used.add(name)
        if "mount" in entry:
            steps.append(("frame", "", turn("z", angle(entry["mount"]))))
        files = [folder / f"{entry['module']}.yaml" for folder in folders]
        module = read(next(file for file in files if file.is_file()))
        for path, value in entry.get("set", {}).items():
            _set(module["chain"], path.split("."), value)
        _mount(module["chain"], f"{prefix}{name}.", folders, steps)


def _set(chain: list[Any], path: list[str], value: Any) -> None:
    for index, entry in enumerate(chain):
        if path[0] in (entry.get("body"), entry.get("frame")):
            if value == "none":
                chain[index] = {"frame": path[0], "span": entry.get("span")}
                continue
            for key in path[1:-1]:
                entry = entry.setdefault(key, {})
            entry[path[-1]] = value
        elif path[0] in (entry.get("as"), entry.get("module")):
            entry.setdefault("set", {})[".".join(path[1:])] = value


def _product(spans: list[flint.arb_mat]) -> flint.arb_mat:
    product = ONE
    for transform in spans:
        product = product * transform
    return product


def three(element: ElementTree.Element | None, key: str, default: str = "0 0 0") -> list[str]:
    return (default if element is None else element.get(key, default)).split()


def origin(element: ElementTree.Element | None) -> flint.arb_mat:
    xyz, rpy = three(element, "xyz"), three(element, "rpy")
    return pose([length(text) for text in xyz], [angle(text) for text in rpy])


def to_axis(element: ElementTree.Element) -> flint.arb_mat:
    """The rotation of z to the axis, by the formula of Duff et al. 2017."""
    x, y, z = (length(text) for text in three(element.find("axis"), "xyz", "1 0 0"))
    norm = (x * x + y * y + z * z).sqrt()
    x, y, z = x / norm, y / norm, z / norm
    sign = -1 if z < 0 else 1
    a = -1 / (sign + z)
    zero, one = flint.arb(0), flint.arb(1)
    return flint.arb_mat(
        [
            [1 + sign * x * x * a, x * y * a, x, zero],
            [sign * x * y * a, sign + y * y * a, y, zero],
            [-sign * x, -y, z, zero],
            [zero, zero, zero, one],
        ]
    )


def urdf_frames(
    urdf: Path, lock: dict[str, str] | None = None, tip: str = "", overlaid: Container[str] = ()
) -> Frames:
    """Frames of a URDF from its root; bodies in `overlaid` are left out."""
    tree = ElementTree.parse(urdf).getroot()
    joints = tree.findall("joint")
    children = {joint.find("child").get("link") for joint in joints}  # type: ignore[union-attr]
    links = {link.get("name"): link for link in tree.findall("link")}
    (root,) = set(links) - children
    frames: Frames = {key: {} for key in FRAMES}
    frames["base"]["base"] = ONE
    at: dict[str, tuple[str, flint.arb_mat]] = {str(root): ("", ONE)}
    while len(at) < len(links):
        for joint in joints:
            parent, child = (joint.find(end).get("link") for end in ("parent", "child"))  # type: ignore[union-attr]
            if parent not in at or child in at:
                continue
            owner, frame = at[parent]
            name, here = str(joint.get("name")), frame * origin(joint.find("origin"))
            value = _position(joint, lock or {}, joints)
            if value is None:
                A = to_axis(joint)
                frames["before"][name], frames["after"][name] = here * A, inverse(A)
                at[str(child)] = (name, ONE)
                continue
            if joint.get("type") != "fixed":
                A = to_axis(joint)
                slides = joint.get("type") == "prismatic"
                motion = shift(0, 0, value) if slides else turn("z", value)
                here = here * A * motion * inverse(A)
            at[str(child)] = (owner, here)
    moved: dict[str, flint.arb_mat] = {}
    if tip:
        owner, frame = at[tip]
        frames["after"][owner] = frames["after"][owner] * frame
        moved[owner] = inverse(frame)
    for name, (owner, frame) in at.items():
        inertial = links[name].find("inertial")
        if inertial is None or name in overlaid:
            continue
        placed = moved.get(owner, ONE) * frame
        turned = inertial.find("origin")
        if turned is not None and any(map(float, turned.get("rpy", "0").split())):
            placed = placed * origin(turned)
        frames["placement"][name] = placed
    return frames


def _position(
    joint: ElementTree.Element, lock: dict[str, str], joints: list[ElementTree.Element]
) -> flint.arb | None:
    """Where a joint stands still, None where it moves."""
    if joint.get("type") == "fixed":
        return flint.arb(0)
    if joint.get("name") in lock:
        read_as = length if joint.get("type") == "prismatic" else angle
        return read_as(lock[str(joint.get("name"))])
    mimic = joint.find("mimic")
    if mimic is None:
        return None
    (leader,) = (other for other in joints if other.get("name") == mimic.get("joint"))
    leading = _position(leader, lock, joints)
    if leading is None:
        return None
    return length(mimic.get("multiplier", "1")) * leading + length(mimic.get("offset", "0"))


def largest_excess(frames: Frames, robot: Any) -> float:
    """By how much an entry of a robot is off more than half an ulp, at most; < 2^-70 is right."""
    names = robot.all_joint_names
    worst = 0.0
    for field, owners in (("before", names), ("after", names), ("placement", robot.body_names)):
        for owner, computed in zip(owners, getattr(robot, field), strict=True):
            if owner in frames[field]:
                worst = max(worst, excess(computed, frames[field][owner]))
    return max(worst, excess(robot.base, frames["base"]["base"]))


def excess(computed: Any, exact: flint.arb_mat) -> float:
    worst = 0.0
    for i in range(4):
        for j in range(4):
            double = float(computed[i, j])
            off = abs(flint.arb(double) - exact[i, j]).upper() - flint.arb(math.ulp(double)) / 2
            worst = max(worst, float(off.upper()))
    return worst
