"""The Puma 560 of Armstrong, Khatib and Burdick 1986 (standard D-H): published, and unphysical.

Link 1 is known by Iyy alone, without mass; link 3 is 9.6 % over the triangle inequality. The
gravity torques and the mass matrix are those that Corke publishes for these figures.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import modrobust as mr
from modrobust.errors import DescriptionError

ROWS = [  # a [m], alpha, d [m]
    ("0", "pi/2", "0"),
    ("0.4318", "0", "0"),
    ("0.0203", "-pi/2", "0.15005"),
    ("0", "pi/2", "0.4318"),
    ("0", "-pi/2", "0"),
    ("0", "0", "0"),
]
BODIES = [  # mass [kg], com [m] and moments [kg m^2] in the frame at the end of the row
    (0, (0, 0, 0), (0, 0.35, 0)),
    (17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539)),
    (4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.086, 0.0125)),
    (0.82, (0, 0.019, 0), (1.8e-3, 1.3e-3, 1.8e-3)),
    (0.34, (0, 0, 0), (0.3e-3, 0.4e-3, 0.3e-3)),
    (0.09, (0, 0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
]
DRIVES = [  # gear ratio, rotor inertia [kg m^2]
    *((62.6111, 200e-6), (107.815, 200e-6), (53.7063, 200e-6)),
    *((76.0364, 33e-6), (71.923, 33e-6), (76.686, 33e-6)),
]
POSE = np.radians([0, 45, 180, 0, 45, 0])


def puma(folder: Path, physical: dict[int, str], tolerance: str = "") -> Path:
    """The arm as one module; `physical` holds what stands in the inertia of a link, from 1 on."""
    lines = ["modrobust: 1", "module: puma560", "name: Puma 560", "source: Armstrong et al. 1986"]
    lines += [tolerance, "connectors: {in: {type: plate}}", "chain:"]
    for k, ((a, alpha, d), (mass, com, (xx, yy, zz)), (gear, rotor)) in enumerate(
        zip(ROWS, BODIES, DRIVES, strict=True), 1
    ):
        lines += [
            f"  - joint: q{k}",
            "    type: revolute",
            f"    drive: {{gear_ratio: {gear}, rotor_inertia: {rotor}}}",
            f"  - body: link{k}",
            f"    span: {{dh: {{convention: standard, a: {a}, alpha: {alpha}, d: {d}}}}}",
            "    expressed_in: end",
            f"    mass: {mass} kg",
            f"    com: [{com[0]}, {com[1]}, {com[2]}]",
            f"    inertia: {{xx: {xx}, yy: {yy}, zz: {zz}{physical.get(k, '')}}}",
        ]
    (folder / "puma560.yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    path = folder / "puma.yaml"
    path.write_text("modrobust: 1\nrobot: puma\nmodules: .\nchain: [puma560]\n", encoding="utf-8")
    return path


AS_WRITTEN = {1: ", physical: as-written", 3: ", physical: as-written"}


def test_published_figures_give_the_published_gravity(tmp_path: Path) -> None:
    arm = mr.load_robot(puma(tmp_path, AS_WRITTEN))
    zero = np.zeros(6)
    gravity = mr.inverse_dynamics(arm, POSE, zero, zero, zero)
    np.testing.assert_allclose(gravity, [0, 31.64, 6.035, 0, 0.0283, 0], rtol=0, atol=5e-4)


def test_published_figures_give_the_published_mass_matrix(tmp_path: Path) -> None:
    arm = mr.load_robot(puma(tmp_path, AS_WRITTEN))
    published = [
        [3.6594, -0.4044, 0.1006, -0.0025, 0.0000, 0.0000],
        [-0.4044, 4.4137, 0.3509, 0.0000, 0.0024, 0.0000],
        [0.1006, 0.3509, 0.9378, 0.0000, 0.0015, 0.0000],
        [-0.0025, 0.0000, 0.0000, 0.1925, 0.0000, 0.0000],
        [0.0000, 0.0024, 0.0015, 0.0000, 0.1713, 0.0000],
        [0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.1941],
    ]
    np.testing.assert_allclose(mr.mass_matrix(arm, POSE), published, rtol=0, atol=6e-5)


def test_what_is_unphysical_is_said_once_and_listed(tmp_path: Path) -> None:
    arm = mr.load_robot(puma(tmp_path, AS_WRITTEN))
    assert [note for note in arm.notes if "no rigid body" in note] == [
        "2 bodies have figures that no rigid body has, puma560.link1 most (an inertia tensor "
        "without mass); taken as written, since the mass matrix is positive definite"
    ]
    first, third = arm.to_dict()["unphysical"]
    assert first == {"body": "puma560.link1", "excess": None}
    assert third["body"] == "puma560.link3"
    assert third["excess"] == pytest.approx(0.086 / (0.066 + 0.0125) - 1, rel=1e-9)


@pytest.mark.parametrize(
    ("asked", "line", "message"),
    [
        (
            3,
            16,
            "body link1, inertia: not 0 for a body of 0 kg; what has no mass has no moment of "
            "inertia; give the mass, or write physical: as-written here if the figures are meant",
        ),
        (
            1,
            34,
            "body link3, inertia: principal moments 0.0125, 0.066, 0.086 kg m^2 break the triangle "
            "inequality; the largest is at most the sum of the other two; check the figures and "
            'the reference point ("about"), or write physical: as-written beside them if they are '
            "meant",
        ),
    ],
)
def test_a_module_that_does_not_say_so_is_refused(
    tmp_path: Path, asked: int, line: int, message: str
) -> None:
    path = puma(tmp_path, {asked: AS_WRITTEN[asked]})
    with pytest.raises(DescriptionError) as caught:
        mr.load_robot(path)
    assert str(caught.value) == f"{tmp_path / 'puma560.yaml'}:{line}: {message}"


@pytest.mark.parametrize("seed", range(10))
def test_sampled_points_keep_the_mass_matrix_positive_definite(tmp_path: Path, seed: int) -> None:
    """Link 1 has bounds of 40 % on all entries of its tensor of rank one."""
    path = puma(tmp_path, AS_WRITTEN, "tolerance: {com: 20 mm, inertia: 40%}")
    arm = mr.load_robot(path)
    rng = np.random.default_rng(seed)
    points = [arm.sample_parameters(rng) for _ in range(20)]
    points += [arm.physical_corner(which, rng)[0] for which in ("lower", "upper", "corner")]
    for point in points:
        assert (arm.lower.packed <= point.packed).all()
        assert (point.packed <= arm.upper.packed).all()
        for tensor in point.inertia:
            assert np.linalg.eigvalsh(tensor)[0] > -1e-14
        for q in rng.uniform(-np.pi, np.pi, (5, 6)):
            M = mr.mass_matrix(arm, q, parameters=point, drives=False)
            assert np.linalg.eigvalsh(M)[0] > -1e-12
            assert np.linalg.eigvalsh(mr.mass_matrix(arm, q, parameters=point))[0] > 0.0


def test_the_loop_tracks_within_its_bound(tmp_path: Path) -> None:
    arm = mr.load_robot(
        puma(tmp_path, AS_WRITTEN, "tolerance: {mass: 5%, com: 5 mm, inertia: 10%}")
    )
    run = mr.simulate(arm, parameters="random", seed=1, duration=0.2)
    assert run.statistics is not None
    assert run.statistics.violations == 0
