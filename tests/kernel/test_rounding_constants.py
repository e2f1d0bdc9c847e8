"""The constants of the rounding bound, added up from the table in docs/theory/rounding.md."""

from __future__ import annotations

import math
import re

import pytest

from support.paths import ROOT

PAGE = (ROOT / "docs" / "theory" / "rounding.md").read_text()
HEADER = (ROOT / "src" / "modrobust" / "kernel" / "mr_rounding.h").read_text()


def counted() -> dict[str, int]:
    """Errors of the operations, from the table of the page."""
    table = PAGE.split("| operation | error | why |")[1].split("\n\n")[0]
    return {
        name: int(error) for name, error in re.findall(r"^\| ([a-z ]+) \| (\d+) \|", table, re.M)
    }


def stated() -> dict[str, float]:
    """The constants of the kernel."""
    found = re.findall(r"^#define MR_(\w+) (?:\(1\.0 \+ )?([\dxp.-]+)", HEADER, re.M)
    return {name: float.fromhex(x) if "x" in x else float(x) for name, x in found}


def derived() -> dict[str, int]:
    """The steps of the proof, in its order."""
    e = counted()
    add, scale, dot, rotate, cross = (e[n] for n in ("add", "scale", "dot", "rotate", "cross"))
    axis, fixed = e["constant axis"], e["constant rotation"]
    placement = fixed + rotate
    # 1
    rotation = e["sine"] + e["turn"] + 2 * fixed + e["multiply"]
    lever = placement + e["constant lever"] + axis + scale + add + e["mimic angle"]
    turned = rotation + rotate
    # 2
    rate = axis + scale + e["mimic rate"]
    velocity = turned + add + 2 * rate
    # 3: on dW, on 2 W Wa, on 2 S Wa
    carried = velocity + turned + cross + rate
    on_product = 2 * add + 2 * rate + 2 * velocity
    spin = max(turned + 2 * add + 2 * rate, -(-on_product // 2), -(-carried // 2))
    # 4
    sums = 7 * add
    acceleration = max(2 * cross + e["constant lever"] + turned + sums, 2 * cross + lever + 2 * add)
    motion = acceleration + 2 * add + placement + add
    # 5
    body = motion + scale + cross + 2 * add + placement + add
    share = scale + 1  # of a mimic joint, and its multiplier as written
    nominal = body + lever + cross + dot + axis + add + share
    # 6
    pose = rotation + e["multiply"]
    position = pose + 2 * add
    v_joint = 2 * pose + 2 * position + pose  # s, and the arm in body axes
    at = rotate + lever
    arm = at + (at + 2 * add) + add
    turn = fixed + e["multiply"]
    v = (arm + turn + rotate) + (turn + rotate) + cross + add
    rest = sum(e[name] for name in ("value", "monotonic", "face", "off centre", "mass"))
    return {
        "CONSTANT_ROTATION": fixed,
        "CONSTANT_LEVER": e["constant lever"],
        "CONSTANT_AXIS": axis,
        "NO_DEFECT": 2 * fixed,
        "ROTATION": rotation,
        "LEVER": lever,
        "MOTION_JOINT": spin,
        "MOTION_ONCE": motion,
        "BOX_ROTATION": rotate + 2 * add,
        "BOX_MOMENT": cross + add,
        "BOX_AXIS": dot + add,
        "NOMINAL_JOINT": spin + turned + 2 * add,
        "NOMINAL_ONCE": nominal,
        "CHANGE_JOINT": v_joint + spin,
        "CHANGE_ONCE": v + motion + dot + rest + share,
    }


def derived_about_frame() -> dict[str, int]:
    """Of a tensor about the body's frame: what is counted once in (16f) and (18f)."""
    e = counted()
    add, scale, dot, rotate, cross = (e[n] for n in ("add", "scale", "dot", "rotate", "cross"))
    placement = e["constant rotation"] + rotate
    moved = scale + add + scale + add  # a square, its sum, the mass, off the tensor
    tensor = placement + 2 * dot + cross + 4 * add + placement + moved
    # v and e of (18), told apart again from the whole
    rest = sum(e[name] for name in ("value", "monotonic", "face", "off centre", "mass"))
    share = scale + 1
    motion = derived()["MOTION_ONCE"]
    v = derived()["CHANGE_ONCE"] - motion - dot - rest - share
    origin = motion - add
    h = max(v + placement + 12 + rotate, origin + cross) + add
    f0 = max(v + origin + dot, h + 2 * add + dot) + add
    return {"moved": moved, "tensor": tensor, "v": v, "origin": origin, "h": h, "f0": f0}


def test_a_tensor_about_the_frame_costs_no_more_than_one_about_the_com() -> None:
    once, e = derived_about_frame(), counted()
    body = derived()["MOTION_ONCE"] + e["scale"] + e["cross"] + 2 * e["add"] + 8 + e["add"]
    assert once["tensor"] <= body
    assert once["f0"] <= once["v"] + derived()["MOTION_ONCE"] + e["dot"]
    parabola = 3 * (4 + 4 + 2) + 4
    assert parabola < sum(e[name] for name in ("value", "monotonic", "face", "off centre"))
    for text in (
        f"most {once['moved']} of",
        f"= 39D + {once['tensor']}$, far below $39D + {body}$",
        f"$183D + {once['v']} + {once['origin']} + {e['dot']}$",
        f"$183D + {once['h']}$",
        f"$f_0$ has $183D + {once['f0']}$",
    ):
        assert text in PAGE, text


@pytest.mark.parametrize("name", derived())
def test_the_kernels_constant_is_what_the_proof_adds_up_to(name: str) -> None:
    assert stated()[name] == derived()[name]


def test_the_page_states_the_same_rates() -> None:
    for joint, once in (("NOMINAL_JOINT", "NOMINAL_ONCE"), ("CHANGE_JOINT", "CHANGE_ONCE")):
        assert f"({derived()[joint]}D + {derived()[once]} + b + 2j)" in PAGE
    body = derived()["MOTION_ONCE"] + stated()["BOX_BODY"]
    assert f"$e = u({derived()['MOTION_JOINT']}D + {body:.0f})$" in PAGE
    radius = {name: stated()[f"RADIUS_{name}"] for name in ("JOINT", "ONCE", "SUM")}
    assert "$u({JOINT:.0f}D + {ONCE:.0f} + {SUM:.0f}(b + j))$".format(**radius) in PAGE
    turn, moment, axis = (derived()[f"BOX_{name}"] for name in ("ROTATION", "MOMENT", "AXIS"))
    for part in (f"$19u + {turn}u$", f"$15u + {moment}u$", f"$u + {axis}u$"):
        assert part in PAGE
    assert f"({stated()['DRIVE']:.0f} + j - n)" in PAGE
    assert stated()["DEFECTS"] == 8
    assert "added to all rates eight times" in PAGE
    assert f"\\varphi/{1 / stated()['MIMIC_ANGLE']:.0f}$" in PAGE
    for name in ("SECOND_ORDER", "RATE_MAX", "UNDERFLOW", "HUGE"):
        assert f"$2^{{{math.log2(stated()[name]):.0f}}}$" in PAGE, name


def test_the_angles_of_mimic_joints_are_within_the_growth_of_the_rates() -> None:
    rates = derived()
    for uses, kind in ((3, "NOMINAL"), (7, "CHANGE")):
        least = rates[f"{kind}_JOINT"] + rates[f"{kind}_ONCE"]
        assert f"{least} " in PAGE or f"{least})" in PAGE
        assert uses * math.sqrt(2) <= least * stated()["MIMIC_ANGLE"]


def test_a_changed_count_changes_a_constant(monkeypatch: pytest.MonkeyPatch) -> None:
    original, base = counted(), derived()
    for name in original:
        halved = {**original, name: original[name] // 2}
        monkeypatch.setitem(globals(), "counted", lambda halved=halved: halved)
        assert derived() != base, name
