"""Checks of a robot's arrays: shapes, tree, rigid transforms, order of bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from modrobust.checks import shape_error, unknown_name
from modrobust.checks.types import Array, Flags, Ints
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model.parameters import Parameters
from modrobust.model.parts import MimicJoints
from modrobust.model.physical import ABOUT_COM, ABOUT_FRAME

_KINDS = ("revolute", "continuous", "prismatic")
_RIGID = 1e-9  # how far a rotation matrix may be from orthonormal; URDF angles have few digits


def check_lengths(arrays: Mapping[str, tuple[Array | Ints, tuple[int, ...]]], owner: str) -> None:
    """Refuses an array whose shape is not the one beside it; infinite limits are allowed."""
    for name, (array, shape) in arrays.items():
        if array.shape != shape:
            raise shape_error(name, shape, array.shape, owner)
        if np.isnan(array).any() or (np.isinf(array).any() and not name.endswith("_limits")):
            raise ValueRangeError(f"{name}: every entry must be finite")


def check_tree(
    joint_types: Sequence[str], parents: Ints, body_joints: Ints, mimic: MimicJoints, n: int
) -> None:
    """Refuses unknown joint types and indices that lead nowhere; parents come before children."""
    j = len(joint_types)
    for i, kind in enumerate(joint_types):
        if kind not in _KINDS:
            raise ValueRangeError(unknown_name(f'joint_types[{i}] is "{kind}"', kind, _KINDS))
    for name, index, first, last, rule in (
        ("parents", parents, -1, np.arange(j) - 1, "a joint before its child, or -1, the base"),
        ("body_joints", body_joints, -1, j - 1, "a joint, or -1, the base"),
        ("mimic.leaders", mimic.leaders, 0, n - 1, "a joint that moves freely"),
        ("mimic.joints", mimic.joints, 0, j - 1, "a joint"),
    ):
        for k in np.flatnonzero((index < first) | (index > last))[:1]:
            raise ValueRangeError(f"{name}[{k}] is {index[k]}; it must be {rule}")
    for k in np.flatnonzero(np.diff(mimic.joints) <= 0)[:1]:
        raise ValueRangeError(
            f"mimic.joints[{k + 1}] is {mimic.joints[k + 1]} after {mimic.joints[k]}; "
            "the indices ascend, each joint once"
        )


def check_endless(names: Sequence[str], joint_types: Sequence[str], limits: Array) -> None:
    """Refuses position limits (n, 2) of a continuous joint, whose error wraps across them."""
    for name, kind, (lo, hi) in zip(names, joint_types, limits, strict=False):
        if kind == "continuous" and (np.isfinite(lo) or np.isfinite(hi)):
            raise ValueRangeError(
                f'position_limits: joint "{name}" is continuous and has [{lo:g}, {hi:g}]; a '
                "continuous joint has none; make it revolute, or leave them out"
            )


def check_abouts(abouts: Sequence[str], b: int, owner: str) -> None:
    """Refuses reference points of tensors that are not one for each body, or unknown."""
    if len(abouts) != b:
        raise ShapeError(f"inertia_about: expected {b} entries, got {len(abouts)}; {owner}")
    for k, about in enumerate(abouts):
        if about not in (ABOUT_COM, ABOUT_FRAME):
            found = f'inertia_about[{k}] is "{about}"'
            raise ValueRangeError(unknown_name(found, about, (ABOUT_COM, ABOUT_FRAME)))


def check_rigid(name: str, transforms: Array) -> None:
    """Refuses a 4x4 that is not a rigid transform, to 1e-9."""
    T = transforms.reshape(-1, 4, 4)
    R = T[:, :3, :3]
    rigid = is_rotation(R, _RIGID) & (T[:, 3] == [0, 0, 0, 1]).all(axis=1)
    for k in np.flatnonzero(~rigid)[:1]:
        raise ValueRangeError(
            f"{name}[{k}] is not a rigid transform; its rotation must be orthonormal and "
            "right-handed, its last row 0 0 0 1"
        )


def is_rotation(R: Array, tolerance: float) -> Flags:
    """Which of the matrices ``(..., 3, 3)`` are right-handed with R R' - 1 within a tolerance.

    Entry by entry: what BLAS answers at the edge depends on the processor.
    """
    x, y, z = (R[..., i, :] for i in range(3))
    unit = [np.abs(_dot(row, row) - 1.0) for row in (x, y, z)]
    across = [np.abs(_dot(one, other)) for one, other in ((x, y), (y, z), (z, x))]
    normal = np.stack(
        [x[..., i] * y[..., j] - x[..., j] * y[..., i] for i, j in ((1, 2), (2, 0), (0, 1))], -1
    )
    right: Flags = (np.max([*unit, *across], axis=0) <= tolerance) & (_dot(normal, z) > 0.0)
    return right


def _dot(x: Array, y: Array) -> Array:
    a, b, c = (x[..., k] * y[..., k] for k in range(3))
    result: Array = a + b + c
    return result


def check_box(name: str, lo: Array, nominal: Array, hi: Array, *, signed: bool) -> None:
    """Refuses bounds that do not hold the nominal value, or are negative unless `signed`."""
    if not lo.shape == nominal.shape == hi.shape:
        raise ShapeError(
            f"{name}: bounds of shape {lo.shape} and {hi.shape}; nominal has {nominal.shape}"
        )
    for where in map(tuple, np.argwhere(~((lo <= nominal) & (nominal <= hi)))[:1]):
        index = "".join(f"[{k}]" for k in where)
        raise ValueRangeError(
            f"{name}{index}: nominal {nominal[where]} is outside its bounds "
            f"[{lo[where]}, {hi[where]}]; widen them or correct it"
        )
    if not signed and (lo < 0.0).any():
        raise ValueRangeError(f"{name}: the lower bound {lo.min()} is negative")


def check_payloads(
    payloads: Mapping[str, tuple[Parameters, Parameters, Parameters]],
    lower: Parameters,
    upper: Parameters,
) -> None:
    """Refuses figures of a payload that are not in order, or not inside the robot's own box."""
    for name, (nominal, lo, hi) in payloads.items():
        for outer, inner, end in ((lo, nominal, hi), (lower, lo, upper), (lower, hi, upper)):
            if not outer.packed.shape == inner.packed.shape == end.packed.shape:
                raise ShapeError(
                    f'payloads: "{name}" has {len(inner.mass)} bodies and {len(inner.viscous)} '
                    f"joints, the robot {len(lower.mass)} and {len(lower.viscous)}"
                )
            if not ((outer.packed <= inner.packed) & (inner.packed <= end.packed)).all():
                raise ValueRangeError(
                    f'payloads: figures of "{name}" are not in order or not inside the bounds of '
                    "the robot; widen these to hold every payload"
                )
