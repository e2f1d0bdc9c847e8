r"""The two points of the box that the law ``sampled`` computes with: its centre and its light end.

.. math::
   \Delta_c:&\quad (m,\; m c,\; I_o) \text{ in the middle of what the box allows, body by body} \\
   \Delta_s:&\quad \underline m,\; c_c,\;
     I_c\,\min(1, \min_k \underline I_{kk}/I_{c,kk}),\; \underline I_m                        & (30)

I_o is the tensor about the origin of the body's frame, in which (m, m c, I_o) enter NE and M
linearly; I and I_c are tensors about the COM.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modrobust import _kernel
from modrobust.checks.types import Array
from modrobust.design.states import configurations
from modrobust.errors import SingularMassMatrixError
from modrobust.kernel import own_environment
from modrobust.model import Parameters, Robot, check_robot
from modrobust.model.definite import pulled_to_definite, seeded_poses
from modrobust.model.physical import inertia_about_com, steiner
from modrobust.model.sampling import physical_pull

_SHARES = np.arange(1, 101) / 100.0  # of the centre, tried in turn
_LEAST = 1e-6  # of M_c: what M_s has at least in every direction


@own_environment()
def central_parameters(robot: Robot) -> Parameters:
    r"""The centre of the box, D_c of (30).

    .. math:: m_c = \tfrac12(\underline m + \overline m),\quad
              m_c c_c = \tfrac12\left(\min m c + \max m c\right),\quad
              I_{o} = \tfrac12\left(\min I_o + \max I_o\right)

    entry by entry, with :math:`I_o = I + m\,(c^Tc\,1 - c c^T)` where the description has I, and
    the J that it has of a body about its frame. Rotor inertia and friction are in the middle of
    their bounds. It is the point from which the box reaches equally far on both sides, as NE and M
    see it; nominal figures of a payload often lie at a corner.

    Args:
        robot: Robot with ``b`` bodies and ``j`` joints.

    Returns:
        The point. Tensors are about what the robot's `inertia_about` says. Where bounds about the
        nominal figures are so uneven that no body has the middle ones, these are pulled straight
        towards nominal until one has, as by `Robot.physical_corner`.

    Raises:
        ValueRangeError: ``robot`` is none.

    Source: our own; (30) of docs/theory/equations.md.
    """
    check_robot(robot)
    lower, upper = robot.lower, robot.upper
    mass = _middle(lower.mass, upper.mass)
    known = (lower.mass == upper.mass) & (lower.com == upper.com).all(axis=1)
    plain = known | (mass == 0.0)
    moved = _middle(*_moment_range(lower, upper)) / np.where(plain, 1.0, mass)[:, None]
    com = np.where(plain[:, None], _middle(lower.com, upper.com), moved)
    given = _middle(lower.inertia, upper.inertia)
    spread = _middle(*_steiner_range(lower, upper)) - steiner(mass, com)
    at_com = given + np.where(known[:, None, None], 0.0, spread)
    middle = {
        name: _middle(getattr(lower, name), getattr(upper, name))
        for name in ("rotor_inertia", "viscous", "coulomb")
    }
    inertia = np.where(robot.framed[:, None, None], given, at_com)
    point = Parameters(mass=mass, com=com, inertia=inertia, **middle)
    point, _ = physical_pull(robot.nominal, point, robot.framed)
    if robot.unphysical:
        poses = seeded_poses(robot.position_limits)
        point = pulled_to_definite(robot.model, robot.nominal, point, poses)
    return point


@own_environment()
def light_parameters(
    robot: Robot, central: Parameters, positions: Array | None = None
) -> Parameters:
    r"""The light end of the box, D_s of (30), whose mass matrix M_s scales the feedback.

    Least masses at the COM of the centre; its tensor about that, times the largest factor up to 1
    that leaves no moment above its least one; least rotor inertias; friction of the centre. For a
    body about its frame the least moments are those of the least J, moved to that COM with the
    least mass.

    Where M_s is not positive definite at one of the positions (a payload that may be absent on a
    joint without rotor), the mixture :math:`(1 - s)\,\Delta_s + s\,\Delta_c` with the least s, in
    per cent, for which it is: M_s has then at least 1e-6 of M_c in every direction.

    Args:
        robot: Robot with ``b`` bodies and ``n`` joints.
        central: The centre, from `central_parameters`.
        positions: Where M_s is looked at, ``(k, n)`` [rad] or [m]; None = seeded ones inside the
            position limits, `modrobust.design.states.configurations`.

    Raises:
        ValueRangeError: ``robot`` is none.
        SingularMassMatrixError: Not even M_c is positive definite at one of the positions.

    Source: our own; (30) of docs/theory/equations.md.
    """
    check_robot(robot)
    lower, framed = robot.lower, robot.framed
    mass = lower.mass
    at_com = inertia_about_com(central.mass, central.com, central.inertia, framed)
    least = inertia_about_com(mass, central.com, lower.inertia, framed)
    whole, part = (np.diagonal(x, axis1=1, axis2=2) for x in (at_com, least))
    ratio = np.where(whole > 0.0, np.maximum(part, 0.0) / np.where(whole > 0.0, whole, 1.0), 1.0)
    scaled = at_com * np.minimum(1.0, ratio.min(axis=1))[:, None, None]
    moved = np.where(framed[:, None, None], steiner(mass, central.com), 0.0)
    light = replace(central, mass=mass, inertia=scaled + moved, rotor_inertia=lower.rotor_inertia)
    if positions is None:
        positions = configurations(robot)
    heavy = _mass_matrices(robot, central, positions)
    try:
        factors = np.asarray(np.linalg.cholesky(heavy), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise SingularMassMatrixError(
            f'robot "{robot.name}": the mass matrix at the centre of the box is not positive '
            "definite; give the joint that nothing resists a body with inertia or a rotor"
        ) from None
    found = _least_share(factors, _mass_matrices(robot, light, positions))
    if found >= _LEAST:
        return light
    # Eigenvalues of M_c^-1 ((1 - s) M_s + s M_c) are (1 - s) xi + s.
    share = float(_SHARES[np.argmax((1.0 - _SHARES) * found + _SHARES >= _LEAST)])
    return _mixed(light, central, share)


def _mixed(light: Parameters, central: Parameters, share: float) -> Parameters:
    """(1 - share) of one and share of the other: linear in (m, m c, I_o), since c is the same."""

    def mix(name: str) -> Array:
        a, b = getattr(light, name), getattr(central, name)
        return np.asarray((1.0 - share) * a + share * b)

    return replace(central, **{name: mix(name) for name in ("mass", "inertia", "rotor_inertia")})


def _least_share(factors: Array, light: Array) -> float:
    """Least eigenvalue of M_c^-1 M_s for Cholesky factors of M_c (k, n, n) and M_s (k, n, n)."""
    half = np.linalg.solve(factors, light)
    whole = np.linalg.solve(factors, np.swapaxes(half, 1, 2))
    return float(np.linalg.eigvalsh(0.5 * (whole + np.swapaxes(whole, 1, 2))).min())


def _mass_matrices(robot: Robot, point: Parameters, positions: Array) -> Array:
    packed = point.packed
    return np.array([_kernel.mass_matrix(robot.model, packed, q, True) for q in positions])


def _moment_range(lower: Parameters, upper: Parameters) -> tuple[Array, Array]:
    """Least and largest m c (b, 3): products of ends, since the mass is not negative."""
    ends = np.array(
        [m[:, None] * c for m in (lower.mass, upper.mass) for c in (lower.com, upper.com)]
    )
    return ends.min(axis=0), ends.max(axis=0)


def _steiner_range(lower: Parameters, upper: Parameters) -> tuple[Array, Array]:
    """Least and largest m (c'c 1 - c c') (b, 3, 3), entry by entry."""
    ends = np.array([lower.com, upper.com])
    largest = (ends**2).max(axis=0)
    least = np.where((ends[0] <= 0.0) & (ends[1] >= 0.0), 0.0, (ends**2).min(axis=0))
    lo, hi = np.zeros_like(lower.inertia), np.zeros_like(lower.inertia)
    for i in range(3):
        one, other = (i + 1) % 3, (i + 2) % 3
        lo[:, i, i] = lower.mass * (least[:, one] + least[:, other])
        hi[:, i, i] = upper.mass * (largest[:, one] + largest[:, other])
        products = np.array(
            [
                -m * ends[a, :, one] * ends[b, :, other]
                for m in (lower.mass, upper.mass)
                for a in (0, 1)
                for b in (0, 1)
            ]
        )
        lo[:, one, other] = lo[:, other, one] = products.min(axis=0)
        hi[:, one, other] = hi[:, other, one] = products.max(axis=0)
    return lo, hi


def _middle(lo: Array, hi: Array) -> Array:
    # Halves first: the sum of two large bounds overflows. Equal ends come back bit by bit.
    return np.asarray(np.where(lo == hi, lo, 0.5 * lo + 0.5 * hi))
