"""Joints described by rows of modified D-H (Craig): Rx(alpha) Tx(a) Rz(q) Tz(d)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import modrobust as mr
from modrobust.errors import DescriptionError

Array = NDArray[np.float64]

PANDA = [  # a [m], alpha [rad], d [m] of Franka's published table; then the flange, d = 0.107
    (0.0, 0.0, 0.333),
    (0.0, -np.pi / 2, 0.0),
    (0.0, np.pi / 2, 0.316),
    (0.0825, np.pi / 2, 0.0),
    (-0.0825, -np.pi / 2, 0.384),
    (0.0, np.pi / 2, 0.0),
    (0.088, np.pi / 2, 0.0),
]
FLANGE = 0.107  # [m]
READY = [0.0, -np.pi / 4, 0.0, -3 * np.pi / 4, 0.0, np.pi / 2, np.pi / 4]
MASS = "    mass: 1 kg\n    com: [0, 0, 10 mm]\n    inertia: {xx: 0.01, yy: 0.01, zz: 0.01}\n"


def module(folder: Path, name: str, chain: str) -> None:
    ends = "connectors: {in: {type: plate}, out: {type: plate}}"
    text = f"modrobust: 1\nmodule: {name}\nname: {name}\nsource: made up\n{ends}\nchain:\n{chain}"
    (folder / f"{name}.yaml").write_text(text, encoding="utf-8")


def assembly(folder: Path, *chain: str) -> Path:
    path = folder / "arm.yaml"
    listed = ", ".join(chain)
    path.write_text(f"modrobust: 1\nrobot: arm\nmodules: .\nchain: [{listed}]\n", encoding="utf-8")
    return path


def angle(x: float) -> str:
    return "0" if x == 0.0 else f"{'-' if x < 0 else ''}pi/2"


def row(k: int, a: float, alpha: float, d: float, kind: str = "revolute") -> str:
    dh = f"{{convention: modified, a: {a}, alpha: {angle(alpha)}, d: {d}}}"
    return f"  - joint: q{k}\n    type: {kind}\n    dh: {dh}\n  - body: link{k}\n{MASS}"


def panda(folder: Path) -> mr.Robot:
    chain = "".join(row(k, *figures) for k, figures in enumerate(PANDA, 1))
    flange = f"  - frame: flange\n    span: {{xyz: [0, 0, {FLANGE}]}}\n"
    module(folder, "panda-arm", chain + flange)
    return mr.load_robot(assembly(folder, "panda-arm"))


def turn(axis: int, angle: float) -> Array:
    T = np.eye(4)
    i, k = (axis + 1) % 3, (axis + 2) % 3
    T[i, i] = T[k, k] = np.cos(angle)
    T[k, i], T[i, k] = np.sin(angle), -np.sin(angle)
    return T


def shift(axis: int, by: float) -> Array:
    T = np.eye(4)
    T[axis, 3] = by
    return T


def craig(a: float, alpha: float, d: float, q: float) -> Array:
    return turn(0, alpha) @ shift(0, a) @ turn(2, q) @ shift(2, d)


def test_the_flange_of_the_panda_stands_where_it_is_known_to(tmp_path: Path) -> None:
    arm = panda(tmp_path)
    home = mr.forward_kinematics(arm, np.zeros(7))[-1]
    known = np.array([[1, 0, 0, 0.088], [0, -1, 0, 0], [0, 0, -1, 0.926], [0, 0, 0, 1]])
    np.testing.assert_allclose(home, known, atol=1e-15)
    ready = mr.forward_kinematics(arm, READY)[-1]
    np.testing.assert_allclose(ready[:3, 3], [0.306891, 0, 0.590282], atol=5e-7)


def test_each_link_frame_is_the_product_of_the_rows_before_it(tmp_path: Path) -> None:
    arm = panda(tmp_path)
    rng = np.random.default_rng(0)
    for q in rng.uniform(-3, 3, (20, 7)):
        frames = mr.forward_kinematics(arm, q)
        T = np.eye(4)
        centres = arm.placement @ [0.0, 0.0, 0.01, 1.0]  # of the bodies, in link frames
        for i, (a, alpha, d) in enumerate(PANDA):
            T = T @ craig(a, alpha, d, q[i])
            centre = T @ [0.0, 0.0, 0.01, 1.0]
            np.testing.assert_allclose(frames[i] @ centres[i], centre, atol=1e-14)


def test_a_slide_has_its_row_too(tmp_path: Path) -> None:
    module(tmp_path, "slide", row(1, 0.2, np.pi / 2, 0.1, "prismatic"))
    arm = mr.load_robot(assembly(tmp_path, "slide"))
    found = mr.forward_kinematics(arm, [0.25])[0]
    np.testing.assert_allclose(found, craig(0.2, np.pi / 2, 0.35, 0.0), atol=1e-15)


def test_a_row_may_be_set(tmp_path: Path) -> None:
    module(tmp_path, "one", row(1, 0.2, 0.0, 0.0))
    arm = mr.load_robot(assembly(tmp_path, "{module: one, set: {q1.dh.a: 0.3}}"))
    np.testing.assert_allclose(mr.forward_kinematics(arm, [0.0])[0], shift(0, 0.3), atol=1e-15)


SPAN = "    span: {dh: {convention: modified, a: 0.3}}\n"
JOINT = "  - joint: q\n    type: revolute\n"
REFUSAL = (
    "span.dh: convention modified directly behind joint q; a row of modified D-H is Rx(alpha) "
    "Tx(a) Rz(q) Tz(d), so that its joint stands inside; give the joint dh: {convention: modified, "
    "a: ..., alpha: ..., d: ...} and this span none, or write a constant transform as standard or "
    "xyz and rpy"
)


@pytest.mark.parametrize(
    ("chain", "owner"),
    [
        (f"{JOINT}  - body: link\n{SPAN}{MASS}", "10: body link"),
        (f"{JOINT}  - frame: aside\n{SPAN}", "10: frame aside"),
        (f"{JOINT}  - frame: here\n  - body: link\n{SPAN}{MASS}", "11: body link"),
    ],
)
def test_a_modified_span_directly_behind_a_joint_is_refused(
    tmp_path: Path, chain: str, owner: str
) -> None:
    module(tmp_path, "part", chain)
    with pytest.raises(DescriptionError) as caught:
        mr.load_robot(assembly(tmp_path, "part"))
    assert str(caught.value) == f"{tmp_path / 'part.yaml'}:{owner}, {REFUSAL}"


def test_it_is_refused_where_the_joint_ends_the_module_before(tmp_path: Path) -> None:
    module(tmp_path, "axis", JOINT)
    module(tmp_path, "link", f"  - body: link\n{SPAN}{MASS}")
    with pytest.raises(DescriptionError) as caught:
        mr.load_robot(assembly(tmp_path, "axis", "link"))
    assert str(caught.value) == f"{tmp_path / 'link.yaml'}:8: body link, {REFUSAL}"


def test_a_modified_span_elsewhere_is_a_constant_transform(tmp_path: Path) -> None:
    apart = "  - frame: up\n    span: {xyz: [0, 0, 0.1]}\n"
    module(tmp_path, "part", f"  - frame: foot\n{SPAN}{JOINT}{apart}  - body: link\n{SPAN}{MASS}")
    arm = mr.load_robot(assembly(tmp_path, "part"))
    expected = shift(0, 0.6) @ shift(2, 0.1)
    np.testing.assert_allclose(mr.forward_kinematics(arm, [0.0])[0], expected, atol=1e-15)


@pytest.mark.parametrize(
    ("dh", "message"),
    [
        ("{convention: standard, a: 1}", '"standard"'),
        ("{convention: modified, theta: 1}", "theta"),
        ("{a: 1}", "convention"),
    ],
)
def test_what_a_row_of_a_joint_cannot_be(tmp_path: Path, dh: str, message: str) -> None:
    module(tmp_path, "part", f"{JOINT}    dh: {dh}\n  - body: link\n{MASS}")
    with pytest.raises(DescriptionError, match=message) as caught:
        mr.load_robot(assembly(tmp_path, "part"))
    assert "joint q, dh" in str(caught.value)
