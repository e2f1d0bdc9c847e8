"""Every module and robot file loads and says what its source says.

`data/module_figures.json` holds the sources' figures a second time, so that a slip of the pen in a
module file fails here.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

from modrobust.formats import BodyItem, JointItem, Module, NestedItem, Quantity, load_module
from modrobust.model import Robot
from support.paths import ROOT
from support.ready_robots import load_builtin

MODULES = sorted(path.stem for path in (ROOT / "modules").glob("*.yaml"))
ROBOTS = sorted(path.stem for path in (ROOT / "assemblies").glob("*.yaml"))
FROM_MODULES = [
    name for name in ROBOTS if "\nurdf:" not in (ROOT / "assemblies" / f"{name}.yaml").read_text()
]
FIGURES_FILE = ROOT / "tests" / "data" / "module_figures.json"
FIGURES: dict[str, Any] = json.loads(FIGURES_FILE.read_text())
REAL = sorted(set(FIGURES) - {"about"})
FAMILIES = ("schunk-", "tum-", "iit-pino-", "iit-concert-", "hebi-")


@cache
def module(name: str) -> Module:
    return load_module(ROOT / "modules" / f"{name}.yaml")


@cache
def robot(name: str) -> Robot:
    return load_builtin(name)


def bodies(name: str) -> list[BodyItem]:
    """Heaviest first."""
    found = [item for item in module(name).items if isinstance(item, BodyItem)]
    return sorted(found, key=lambda body: -body.mass.nominal)


def joints(name: str) -> list[JointItem]:
    return [item for item in module(name).items if isinstance(item, JointItem)]


def tensor(body: BodyItem) -> np.ndarray[Any, Any]:
    """The nominal tensor about the COM."""
    xx, xy, xz, yy, yz, zz = (entry.nominal for entry in body.inertia)
    given = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if body.inertia_about == "com":
        return given
    c = np.array([q.nominal for q in body.com])
    return given - body.mass.nominal * (c @ c * np.eye(3) - np.outer(c, c))


def quantities(item: BodyItem | JointItem) -> Iterator[Quantity]:
    if isinstance(item, BodyItem):
        yield from (item.mass, *item.com, *item.inertia)
    if isinstance(item, JointItem):
        yield from (q for q in (item.rotor_inertia, item.viscous, item.coulomb) if q is not None)


@pytest.mark.parametrize("name", MODULES)
def test_every_module_loads_is_named_like_its_file_and_has_a_source(name: str) -> None:
    loaded = module(name)
    assert loaded.id == name
    assert loaded.source
    short = [text for text in loaded.source if len(text) <= 10]
    assert not short, f"modules/{name}.yaml: source {short} says too little; name the document"
    unused = ", ".join(loaded.unused_tolerances)
    assert not unused, f"modules/{name}.yaml: tolerance {unused} acts on nothing; remove it"


@pytest.mark.parametrize("name", ROBOTS)
def test_every_robot_loads_and_is_named_like_its_file(name: str) -> None:
    assert robot(name).name == name


def test_at_least_thirty_real_modules_from_three_families() -> None:
    real = [name for name in MODULES if module(name).product]
    twice = f"write its figures a second time, into {FIGURES_FILE.relative_to(ROOT)}"
    missing, gone = sorted(set(real) - set(REAL)), sorted(set(REAL) - set(real))
    assert not missing, f"{missing}: a real module without figures to check it by; {twice}"
    assert not gone, f"{gone}: figures without a real module; remove them from {FIGURES_FILE.name}"
    assert len(real) >= 30
    assert sum(any(name.startswith(family) for name in real) for family in FAMILIES) >= 3


def test_what_is_not_a_product_says_so() -> None:
    for name in MODULES:
        if name.startswith(("generic-", "lwa4p-paper-")):
            assert not module(name).product
        if name.startswith("generic-"):
            assert module(name).source == ("generic, not a product",)


@pytest.mark.parametrize("name", ["tum-ext-84", "schunk-link-200"])
def test_modules_with_impossible_or_copied_figures_are_left_out(name: str) -> None:
    assert name not in MODULES


@pytest.mark.parametrize("name", REAL)
def test_masses_coms_and_inertias_are_those_of_the_source(name: str) -> None:
    figures = sorted(FIGURES[name]["bodies"], key=lambda body: -body[0])
    found = bodies(name)
    assert len(found) == len(figures), f"modules/{name}.yaml and {FIGURES_FILE.name} differ"
    for body, (mass, com, inertia) in zip(found, figures, strict=True):
        assert body.mass.nominal == pytest.approx(mass, rel=1e-12)
        assert [c.nominal for c in body.com] == pytest.approx(com, rel=1e-12, abs=1e-15)
        largest = np.linalg.eigvalsh(np.array(inertia))[-1]
        assert tensor(body) == pytest.approx(np.array(inertia), abs=5e-6 * largest)


@pytest.mark.parametrize("name", REAL)
def test_nominal_inertias_are_physical(name: str) -> None:
    for body in bodies(name):
        low, middle, high = np.linalg.eigvalsh(tensor(body))
        assert low > 0
        assert low + middle >= high


@pytest.mark.parametrize("name", [name for name in REAL if "joints" in FIGURES[name]])
def test_limits_and_drives_are_those_of_the_source(name: str) -> None:
    figures = FIGURES[name]["joints"]
    found = joints(name)
    assert len(found) == len(figures), f"modules/{name}.yaml and {FIGURES_FILE.name} differ"
    for joint, figure in zip(found, figures, strict=True):
        assert joint.type == figure["type"]
        position = figure["position"]
        assert joint.position == (None if position is None else pytest.approx(position, rel=1e-9))
        assert joint.velocity == pytest.approx(figure["velocity"], rel=1e-6)
        assert joint.effort == pytest.approx(figure["torque"], rel=1e-12)
        assert joint.gear_ratio == figure["gear_ratio"]
        for key in ("rotor_inertia", "viscous", "coulomb"):
            quantity, published = getattr(joint, key), figure[key]
            if published is None:
                assert quantity is None, key  # placeholders of the sources stay out
                continue
            nominal, least, largest = published
            assert quantity.nominal == pytest.approx(nominal, rel=1e-12)
            if least is not None:
                assert quantity.lo == pytest.approx(least, rel=1e-12)
                assert quantity.hi == pytest.approx(largest, rel=1e-12)


@pytest.mark.parametrize("name", [name for name in REAL if "tip" in FIGURES[name]])
def test_the_out_connector_is_where_the_source_puts_it(name: str) -> None:
    tip = np.eye(4)
    for item in module(name).items:
        if not isinstance(item, JointItem | NestedItem):
            tip = tip @ item.span.rounded()
    assert tip[:3] == pytest.approx(np.array(FIGURES[name]["tip"]), abs=1e-9)


def test_bodies_of_the_bracket_sit_halfway_to_its_output() -> None:
    for name in ("hebi-bracket-x5-heavy-right", "hebi-bracket-x5-light-right"):
        (bracket,) = bodies(name)
        assert bracket.span.rounded()[:3, 3] == pytest.approx([2 * c.nominal for c in bracket.com])


@pytest.mark.parametrize("name", REAL)
def test_every_mass_of_a_real_module_has_bounds(name: str) -> None:
    for body in bodies(name):
        assert body.mass.lo < body.mass.hi, (
            f"modules/{name}.yaml: body {body.name}: its mass has no bound; write ± or tolerance:"
        )
        assert body.mass.lo <= body.mass.nominal <= body.mass.hi
    items: list[BodyItem | JointItem] = [*bodies(name), *joints(name)]
    exact = [item.name for item in items for q in quantities(item) if not q.bounded]
    assert not exact, (
        f"modules/{name}.yaml: {sorted(set(exact))}: a parameter without bound; a real module has "
        "a bound on each, so write ±, [lo, hi] or tolerance:"
    )


def test_masses_that_two_sources_publish_lie_inside_the_bounds() -> None:
    for name, published in {
        "hebi-link-x5-325": (0.329, 0.402),
        "hebi-t8-9": (0.575, 0.65),
        "iit-concert-link-straight-20": (1.0657798, 1.102),
    }.items():
        (body,) = bodies(name)
        assert body.mass.lo <= min(published) < max(published) <= body.mass.hi


@pytest.mark.parametrize(
    ("name", "n", "mass"),
    [
        ("lwa4p", 6, 13.72),
        ("lwa4p-paper", 6, 13.62),
        ("lwa4p-payload", 6, 13.72 + 1.0),  # half of the 0 to 2 kg
        ("pino-arm", 6, 0.76 + 3 * 2.675841 + 3 * 3.16357 + 0.93 + 1.183),
        ("concert-wall", 5, 2 * 4.153935 + 3 * 4.762552 + 1.06578 + 0.892685),
        ("hebi-arm", 5, 2 * 0.48 + 0.5 + 0.215 + 2 * 0.402 + 2 * 0.315 + 0.1 + 0.4),
        ("scara", 4, 6 + 4 + 0.5 + 2.3 + 0.75 + 0.8),
        ("gantry", 4, 2 * 12 + 2.3 + 0.75 + 0.8),
        ("snake12", 12, 6 * (2.675841 + 3.16357)),
    ],
)
def test_joints_and_total_mass_of_each_robot(name: str, n: int, mass: float) -> None:
    described = robot(name).to_dict()
    assert robot(name).n == n
    assert sum(body["mass"]["nominal"] for body in described["bodies"]) == pytest.approx(
        mass, abs=5e-6
    )


def test_the_catalogue_has_the_robots_that_it_promises() -> None:
    kinds = {name: [j["type"][0] for j in robot(name).to_dict()["joints"]] for name in FROM_MODULES}
    assert "".join(kinds["scara"]) == "rrpc"  # the last one is continuous
    assert "".join(kinds["gantry"]) == "pppc"
    assert max(len(types) for types in kinds.values()) == 12
    wall = np.array(robot("concert-wall").to_dict()["base"])
    assert wall[:3, 2] == pytest.approx([1, 0, 0], abs=1e-12)  # z out of the wall
    payload = [b for b in robot("lwa4p-payload").to_dict()["bodies"] if b["name"] == "payload"]
    assert [(b["mass"]["lo"], b["mass"]["hi"]) for b in payload] == [(0.0, 2.0)]
    assert len(kinds) >= 9


def test_the_last_link_of_the_paper_carries_table_two() -> None:
    body = next(b for b in robot("lwa4p-paper").to_dict()["bodies"] if b["name"] == "link6.body")
    assert body["mass"] == {"nominal": 1.4, "lo": 1.4, "hi": pytest.approx(2.8, rel=1e-15)}
    assert body["com"]["lo"] == pytest.approx([-0.005, -0.005, 0.045], rel=1e-15)
    assert body["com"]["hi"] == pytest.approx([0.005, 0.005, 0.1], rel=1e-15)
    assert np.diag(body["inertia"]["lo"]) == pytest.approx([0.0017, 0.0035, 0.00315], rel=1e-15)
    assert np.diag(body["inertia"]["hi"]) == pytest.approx([0.0034, 0.007, 0.0063], rel=1e-15)
    assert np.array(body["inertia"]["hi"])[np.triu_indices(3, 1)] == pytest.approx([0, 0, 0])
