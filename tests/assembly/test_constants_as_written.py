"""Constants of a robot are those that its files write, rounded once: held against 300 bits."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence
from pathlib import Path

import flint
import numpy as np
import pytest

import modrobust as mr
from assembly.exact_frames import BITS, chain_frames, largest_excess, read, urdf_frames
from modrobust.assembly.modules.catalogue import builtin_robots, data_directory
from modrobust.assembly.urdf.files import find_file
from modrobust.errors import DescriptionError
from modrobust.formats.nodes import Where
from modrobust.formats.overlay import UrdfSource
from support.ready_robots import load_builtin
from support.urdf_texts import INERTIA, LIMIT, joint, link, robot, written

OFF = 2.0**-70  # beyond half an ulp of each entry
MODULES = data_directory("modules")
ROBOTS = {name: read(path) for name, path in builtin_robots().items()}
SPANS = (
    "{xyz: [<l>, <l>, <l>], rpy: [<a>, <a>, <a>]}",
    "{xyz: [<l>, 0, <l>]}",
    "{rpy: [<a>, 0, <a>]}",
    "{dh: {convention: standard, a: <l>, alpha: <a>, d: <l>, theta: <a>}}",
    "{dh: {convention: modified, a: <l>, alpha: <a>, d: <l>, theta: <a>}}",
    "{giusti2015: {convention: giusti, p: <l>, delta_in: <a>, a: <l>, alpha: <a>, n: <l>, "
    "delta_out: <a>}}",
    "{giusti2015: {convention: iit, p: <l>, delta_in: <a>, a: <l>, alpha: <a>, n: <l>, "
    "delta_out: <a>}}",
)
CONSTANT = [span for span in SPANS if "modified" not in span]
ROW = "{convention: modified, a: <l>, alpha: <a>, d: <l>}"


@pytest.fixture(autouse=True)
def _precise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flint.ctx, "prec", BITS)


class Texts:
    """Random numbers as people write them."""

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)

    def length(self) -> str:
        value = self.rng.choice((1e-30, 1e-3, 0.1, 1.0, 50.0)) * self.rng.uniform(-1.0, 1.0)
        return self.rng.choice(
            (f"{1000 * value:.4g} mm", f"{value:.3f}", f"{value!r} m", f"{100 * value:.1f} cm", "0")
        )

    def angle(self) -> str:
        return self.rng.choice(
            (
                f"{self.rng.uniform(-400, 400):.2f} deg", f"{self.rng.uniform(-4, 4)!r}", "pi/2",
                "-pi/2", f"{self.rng.randint(-20, 20) * 90} deg", "2*pi/3", "1.5707963267948966",
                "1.57079632679", "30 deg", "-pi/7", f"{self.rng.uniform(-1e5, 1e5):.3f} rad",
            )
        )  # fmt: skip

    def span(self, kinds: Sequence[str] = SPANS) -> str:
        text = self.rng.choice(kinds)
        while "<" in text:
            text = text.replace("<l>", self.length(), 1).replace("<a>", self.angle(), 1)
        return text

    def chain(self, entries: int, names: str) -> list[str]:
        lines: list[str] = []
        kinds: Sequence[str] = CONSTANT  # behind a joint, and perhaps at the start
        for k in range(entries):
            kind = self.rng.choice(("joint", "body", "frame", "frame"))
            if kind == "joint":
                lines += [f"  - joint: {names}{k}", "    type: revolute"]
                lines += ["    drive: {gear_ratio: 1, rotor_inertia: 1}"]
                if self.rng.random() < 0.4:
                    lines += [f"    dh: {self.span((ROW,))}"]
                kinds = CONSTANT
                continue
            span = self.span(kinds)
            lines += [f"  - {kind}: {names}{k}", f"    span: {span}"]
            if re.search("[1-9]|pi", span.partition(": ")[2]):  # not nothing
                kinds = SPANS
            if kind == "body":
                lines += [f"    expressed_in: {self.rng.choice(('start', 'end'))}", "    mass: 1"]
                lines += ["    com: [0, 0, 0.1]", "    inertia: {xx: 1, yy: 1, zz: 1}"]
        return lines


def module(folder: Path, name: str, lines: list[str]) -> None:
    head = ["modrobust: 1", f"module: {name}", f"name: {name}", "source: a test"]
    head += ["connectors: {in: {type: t}, out: {type: t}}", "chain:"]
    (folder / f"{name}.yaml").write_text("\n".join([*head, *lines]) + "\n", encoding="utf-8")


@pytest.mark.parametrize("name", [name for name, robot in ROBOTS.items() if "chain" in robot])
def test_transforms_of_a_robot_of_the_catalogue_are_those_of_its_texts(name: str) -> None:
    frames = chain_frames(builtin_robots()[name], MODULES)
    assert largest_excess(frames, mr.load_robot(name)) < OFF


@pytest.mark.parametrize("seed", range(30))
def test_transforms_of_random_modules_are_those_of_their_texts(tmp_path: Path, seed: int) -> None:
    texts = Texts(seed)
    module(tmp_path, "inner", texts.chain(6, "i"))
    nested = [f"  - {{module: inner, mount: {texts.angle()}}}", "  - module: inner"]
    module(tmp_path, "outer", [*texts.chain(8, "a"), *nested, *texts.chain(8, "b")])
    last = [
        "  - joint: last",
        "    type: prismatic",
        "    drive: {gear_ratio: 1, rotor_inertia: 1}",
    ]
    module(tmp_path, "end", [*texts.chain(60 if seed == 0 else 3, "e"), *last, "  - frame: tip"])
    lines = ["modrobust: 1", "robot: r", "modules: .", f"base: {texts.span(SPANS[:3])}", "chain:"]
    lines += ["  - outer", f"  - {{module: outer, mount: {texts.angle()}}}", "  - end"]
    path = tmp_path / "r.yaml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert largest_excess(chain_frames(path), mr.load_robot(path)) < OFF


@pytest.mark.parametrize("name", [name for name, robot in ROBOTS.items() if "urdf" in robot])
def test_transforms_of_a_urdf_of_the_catalogue_are_those_of_its_text(name: str) -> None:
    arm = load_builtin(name)
    said = ROBOTS[name]
    urdf = find_file(UrdfSource(said["urdf"], Where(name, 1)))
    frames = urdf_frames(urdf, said.get("lock"), overlaid=said.get("links", {}))
    assert set(arm.joint_names) <= set(frames["before"])
    assert largest_excess(frames, arm) < OFF


@pytest.mark.parametrize("seed", range(20))
def test_transforms_of_a_random_urdf_are_those_of_its_text(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)

    def origin() -> str:
        angles = ("0", "1.5707963267948966", "-3.14159265359", "1.57", f"{rng.uniform(-7, 7)!r}")
        xyz = " ".join(f"{rng.uniform(-2, 2):.{rng.randint(1, 17)}f}" for _ in range(3))
        return f'<origin xyz="{xyz}" rpy="{" ".join(rng.choice(angles) for _ in range(3))}"/>'

    def moving() -> str:
        axis = rng.choice(("1 0 0", "0 -1 0", "0 0 2", "1 2 3", "-0.577 0.577 -0.577"))
        axis = rng.choice((axis, " ".join(f"{rng.uniform(-1, 1):.6f}" for _ in range(3))))
        return f'{origin()}<axis xyz="{axis}"/>{LIMIT}'

    parts = [link("l0")]
    for k in range(1, 13):
        kind = rng.choice(("revolute", "prismatic", "fixed")) if k > 1 else "revolute"
        inside = origin() if kind == "fixed" else moving()
        if k == 12:
            kind, inside = "revolute", moving() + '<mimic joint="j1" multiplier="0.3"/>'
        parent = k - 1 if k < 6 else rng.randrange(k if k < 12 else 2)
        inertial = f'<inertial>{origin()}<mass value="2"/>{INERTIA}</inertial>'
        parts += [link(f"l{k}", inertial), joint(f"j{k}", f"l{parent}", f"l{k}", kind, inside)]
    path = written(tmp_path, robot(*parts))
    arm = mr.load_robot(path)
    assert largest_excess(urdf_frames(path), arm) < OFF
    locked = {name: "0.3" for name in arm.joint_names if name != "j1" and rng.random() < 0.4}
    part = mr.load_robot(path, lock=locked)
    assert largest_excess(urdf_frames(path, locked), part) < OFF
    tip = part.body_names[list(part.body_joints).index(0)]
    chain = mr.load_robot(path, lock=locked, tip=tip)
    assert largest_excess(urdf_frames(path, locked, tip), chain) < OFF


def test_a_chain_of_mimics_is_multiplied_out_before_it_is_rounded(tmp_path: Path) -> None:
    third = '<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>' + LIMIT
    path = written(
        tmp_path,
        robot(
            *(link(f"l{k}") for k in range(4)),
            joint("a", "l0", "l1"),
            joint(
                "b", "l0", "l2", inside=third + '<mimic joint="a" multiplier="0.1" offset=".7"/>'
            ),
            joint(
                "c", "l0", "l3", inside=third + '<mimic joint="b" multiplier="0.3" offset="0.1"/>'
            ),
        ),
    )
    mimic = mr.load_robot(path).mimic
    assert mimic.multiplier.tolist() == [0.1, 0.03]  # in doubles 0.1 * 0.3 is another
    assert mimic.offset.tolist() == [0.7, 0.31]


def test_a_factor_beyond_the_doubles_is_refused(tmp_path: Path) -> None:
    inside = '<origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>' + LIMIT
    follow = inside + '<mimic joint="j{}" multiplier="1e99"/>'
    arms = [joint(f"j{k}", "l0", f"l{k}", inside=follow.format(k - 1)) for k in range(2, 6)]
    links = [link(f"l{k}") for k in range(6)]
    path = written(tmp_path, robot(*links, joint("j1", "l0", "l1", inside=inside), *arms))
    with pytest.raises(DescriptionError, match="joint j5, mimic: out of range with the joints"):
        mr.load_robot(path)


def test_rotations_are_orthonormal_to_rounding_after_many_spans(tmp_path: Path) -> None:
    lines = [
        line for k in range(300) for line in (f"  - frame: f{k}", "    span: {rpy: [1, 2, 3]}")
    ]
    drive = [
        "  - joint: axis",
        "    type: revolute",
        "    drive: {gear_ratio: 1, rotor_inertia: 1}",
    ]
    module(tmp_path, "long", [*drive, *lines])
    path = tmp_path / "r.yaml"
    path.write_text("modrobust: 1\nrobot: r\nmodules: .\nchain: [long]\n", encoding="utf-8")
    turned = mr.load_robot(path).after[0, :3, :3]
    assert np.abs(turned @ turned.T - np.eye(3)).max() < 4e-16
