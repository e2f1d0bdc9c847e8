r"""Inertia tensors of descriptions: bounded, held against physics; moved to the COM for that.

A tensor is six entries xx, xy, xz, yy, yz, zz [kg m^2]. With c the COM in the frame of the figures,

.. math:: I_{com} = I_{frame} - m (c'c\,1 - c c')

A tensor belongs to a rigid body iff the second moments tr(I)/2 - I are positive semidefinite,
which says that no principal moment exceeds the sum of the other two.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from modrobust.checks.types import Array
from modrobust.formats.exact import Enclosure, nearest
from modrobust.formats.nodes import Where
from modrobust.formats.quantity import Quantity, Written
from modrobust.model.physical import TRIANGLE as _TRIANGLE
from modrobust.model.symmetric import PLACES, eigenvalues, largest_eigenvalue

Tensor = tuple[Fraction, Fraction, Fraction, Fraction, Fraction, Fraction]


def steiner(mass: Fraction, com: Sequence[Fraction]) -> Tensor:
    """``m (c'c 1 - c c')``: what a mass away from the reference point adds to the tensor."""
    square = sum((c * c for c in com), Fraction(0))
    xx, xy, xz, yy, yz, zz = (
        mass * ((square if i == j else 0) - com[i] * com[j]) for i, j in PLACES.values()
    )
    return xx, xy, xz, yy, yz, zz


def moved_to_com(
    entries: Sequence[Written], mass: Written, com: Sequence[Written]
) -> list[Written]:
    """Entries about the frame's origin as entries about the COM, at the nominal values alone."""
    shift = steiner(mass.nominal.middle, [c.nominal.middle for c in com])
    return [
        entry.moved(entry.nominal.middle - part) for entry, part in zip(entries, shift, strict=True)
    ]


def largest_principal_moment(tensor: Sequence[Fraction]) -> Fraction:
    """A rational at most 1e-19 (relative) above the largest principal moment, never below.

    Diagonal tensors: exact. No step depends on the machine.
    """
    return largest_eigenvalue(tensor)


def positive_definite(tensor: Sequence[Fraction]) -> bool:
    """Whether the leading minors are positive, in exact arithmetic."""
    xx, xy, xz, yy, yz, zz = tensor
    minor = xx * yy - xy * xy
    whole = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return xx > 0 and minor > 0 and whole > 0


def check_physical(
    entries: Sequence[Written],
    mass: Written,
    where: Where,
    field: str,
    moved: bool,
    as_written: bool,
) -> bool:
    """Refuse a nominal tensor (about the COM) that no rigid body has; say whether it is physical.

    Args:
        entries: The nominal tensor and its bounds.
        mass: Mass of the body.
        where: Of the tensor, for messages.
        field: Name of the tensor.
        moved: Whether it was moved to the COM.
        as_written: Whether a tensor whose moments are not negative is let pass.

    Raises:
        DescriptionError: A principal moment that is negative beyond rounding; unless `as_written`,
            also the triangle inequality broken, or a tensor without mass.
    """
    note = " after the move to the COM" if moved else ""
    remedy = 'check the figures and the reference point ("about")'
    meant = f"{remedy}, or write physical: as-written beside them if they are meant"
    tensor = [entry.nominal.middle for entry in entries]
    doubles = [entry.double(value, nearest) for entry, value in zip(entries, tensor, strict=True)]
    moments = _moments(doubles)
    rounding = _TRIANGLE * float(max(abs(moments)))  # of figures that are printed
    for i, name in ((0, "xx"), (3, "yy"), (5, "zz")):
        if tensor[i] < -rounding:
            raise entries[i].where.error(
                f"{field}.{name}",
                f"{doubles[i]:.9g} kg m^2{note} is negative; a moment of inertia is at least 0; "
                f"{remedy}",
            )
    listed = ", ".join(f"{moment:.6g}" for moment in moments)
    if moments[0] < -rounding:
        raise where.error(
            field,
            f"principal moments {listed} kg m^2{note}; no principal moment of the nominal tensor "
            f"is negative; {remedy}",
        )
    massless = mass.nominal.middle == 0 and any(tensor)
    if massless and not as_written:
        raise where.error(
            field,
            "not 0 for a body of 0 kg; what has no mass has no moment of inertia; give the mass, "
            "or write physical: as-written here if the figures are meant",
        )
    triangle = moments[2] - moments[1] - moments[0] <= _TRIANGLE * moments[2]
    if not triangle and not as_written:
        raise where.error(
            field,
            f"principal moments {listed} kg m^2{note} break the triangle inequality; the largest "
            f"is at most the sum of the other two; {meant}",
        )
    return bool(triangle) and not massless


def box_is_physical(inertia: Sequence[Quantity], framed: Sequence[Quantity] = ()) -> bool:
    """Whether every tensor within the bounds belongs to some rigid body.

    Those tensors form a convex cone, so the 64 corners of the box decide. Tensors about the frame
    come with mass and COM, `framed`; second moments less m c c' are then concave in c and fall with
    m, so that the corners at the largest mass decide.
    """
    corners = np.array(list(itertools.product(*((entry.lo, entry.hi) for entry in inertia))))
    if framed:
        mass, *com = framed
        away = [_moved_by(mass.hi, c) for c in itertools.product(*((e.lo, e.hi) for e in com))]
        corners = (corners[:, None] - np.array(away)).reshape(-1, 6)
    moments = eigenvalues(_matrices(corners))
    excess = moments[:, 2] - moments[:, 1] - moments[:, 0]
    return bool(np.all(excess <= _TRIANGLE * np.abs(moments[:, 2])))


def box_body(mass: Written, size: Sequence[Written], where: Where, field: str) -> list[Written]:
    """Tensor of a homogeneous box with edges `size` about its centre: xx = m (b^2 + c^2) / 12.

    Every entry grows with mass and edges, so the bounds are the values at the bounds.
    """
    masses = (mass.nominal, *mass.ends())
    edges = [(edge.nominal, *edge.ends()) for edge in size]
    bounded = mass.bounded or any(edge.bounded for edge in size)
    zero = Enclosure(Fraction(0), Fraction(0))
    entries = []
    for i, j in PLACES.values():
        if i != j:
            entries.append(Written(zero, None, None, None, where, field))
            continue
        nominal, lo, hi = (
            masses[k].middle
            * sum(edge[k].middle ** 2 for n, edge in enumerate(edges) if n != i)
            / 12
            for k in range(3)
        )
        exact = Written(Enclosure(nominal, nominal), None, None, None, where, field)
        if bounded:
            exact = exact.between(lo, hi)
        entries.append(exact)
    return entries


def _moved_by(mass: float, com: Sequence[float]) -> list[float]:
    """`steiner` in doubles."""
    x, y, z = com
    return [
        mass * (y * y + z * z),
        -mass * (x * y),
        -mass * (x * z),
        mass * (x * x + z * z),
        -mass * (y * z),
        mass * (x * x + y * y),
    ]


def _moments(entries: Sequence[float]) -> Array:
    """Principal moments in ascending order."""
    moments: Array = eigenvalues(_matrices(np.array([entries])))[0]
    return moments


def _matrices(rows: Array) -> Array:
    """Six entries a row as symmetric matrices, shape ``(k, 3, 3)``."""
    return rows[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
