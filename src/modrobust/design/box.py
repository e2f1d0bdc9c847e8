r"""Points of a robot's box in (m, h, I_o), h = m c, where a linear function is as large as can be.

.. math:: \max_{\Delta} \; \sum_b \alpha_b m_b + g_b^T h_b + \langle W_b, I_{o,b} \rangle
          + \sum_j w_j I_{m,j}

over bodies that there can be. What is found is a point of the box, so a lower estimate of that
largest value: vertices are pulled straight towards nominal until they are physical.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from modrobust.checks.types import Array, Flags, Ints
from modrobust.design.twists import Weights, moving
from modrobust.model import Parameters, Robot
from modrobust.model.physical import inertia_about_com, steiner

_VERTICES = np.array(list(product((0, 1), repeat=3)))
_SWEEPS = 2  # over the coordinates of a COM
_FLAT = 1e-9  # of the trace: how far bodies on the border of what is physical count as inside
_NOTHING = 1e-30  # [kg m^2]


@dataclass(frozen=True)
class Lifted:
    """Points in the coordinates in which NE and M are linear; x of them."""

    mass: Array
    """``(x, b)`` [kg], b moving bodies."""
    moment: Array
    """m c, ``(x, b, 3)`` [kg m]."""
    inertia: Array
    """About the origin of the body's frame, ``(x, b, 3, 3)`` [kg m^2]."""
    rotor: Array
    """``(x, j)`` [kg m^2]."""


def lifted(robot: Robot, points: list[Parameters]) -> Lifted:
    """Points of the robot's parameters as they enter NE and M."""
    which = moving(robot)
    mass = np.array([p.mass[which] for p in points])
    com = np.array([p.com[which] for p in points])
    given = np.array([p.inertia[which] for p in points])
    framed = robot.framed[which][:, None, None]
    inertia = np.where(framed, given, given + steiner(mass, com))
    rotor = np.array([p.rotor_inertia for p in points])
    return Lifted(mass, mass[..., None] * com, inertia, rotor)


class Box:
    """The box of a robot, made ready for the search; nominal, lower and upper as arrays.

    Args:
        robot: Its bounds are the box.
    """

    def __init__(self, robot: Robot) -> None:
        which = moving(robot)
        self.framed: Flags = robot.framed[which]
        points = robot.lower, robot.nominal, robot.upper
        self.mass, self.com, self.inertia = (
            np.array([getattr(p, name)[which] for p in points])
            for name in ("mass", "com", "inertia")
        )
        self.rotor = np.array([p.rotor_inertia for p in points])
        width = (self.mass[2] > self.mass[0]) | (self.com[2] > self.com[0]).any(axis=1)
        width |= (self.inertia[2] > self.inertia[0]).any(axis=(1, 2))
        plain, framed = np.flatnonzero(width & ~self.framed), np.flatnonzero(width & self.framed)
        self._plain: Ints = plain.astype(np.int32)
        self._frames: Ints = framed.astype(np.int32)
        self._nominal = lifted(robot, [robot.nominal])
        at_com = inertia_about_com(self.mass[1], self.com[1], self.inertia[1], self.framed)
        self._scales = self._scaling()
        self._sigma = _second_moments(at_com[plain])
        self._root = _inverse_root(self._sigma)
        nominal = self._nominal
        self._pseudo = _pseudo_inertia(
            nominal.mass[0][framed], nominal.moment[0][framed], nominal.inertia[0][framed]
        )
        self._pseudo_root = _inverse_root(self._pseudo)

    def extreme(self, weights: Weights, sign: float) -> Lifted:
        """For each row of weights a physical point at which sign times the function is large.

        Args:
            weights: The function, one row a point.
            sign: 1.0 for the largest value, -1.0 for the least.
        """
        rows = len(weights.mass)
        nominal = self._nominal
        mass = np.repeat(nominal.mass, rows, axis=0)
        moment = np.repeat(nominal.moment, rows, axis=0)
        inertia = np.repeat(nominal.inertia, rows, axis=0)
        for which, search in ((self._plain, self._about_com), (self._frames, self._about_frame)):
            if len(which):
                a, g, W = (sign * x[:, which] for x in _bodies(weights))
                mass[:, which], moment[:, which], inertia[:, which] = search(a, g, W)
        rotor = np.where(sign * weights.rotor > 0.0, self.rotor[2], self.rotor[0])
        return Lifted(mass, moment, inertia, rotor)

    def _about_com(self, a: Array, g: Array, W: Array) -> tuple[Array, Array, Array]:
        which = self._plain
        mass, com, tensor = self.mass[:, which], self.com[:, which], self.inertia[:, which]
        # Of the COM: m (a + g'c + c'A c).
        A = _trace(W)[..., None, None] * np.eye(3) - W
        c = _largest_quadratic(g, A, com[0], com[2])
        per_mass = a + (g * c).sum(-1) + np.einsum("xbi,xbij,xbj->xb", c, A, c)
        m = np.where(per_mass > 0.0, mass[2], mass[0])
        chosen, best = None, np.full(a.shape, -np.inf)
        for tried in self._tensors(W, which, tensor):
            H = self._root @ (self._sigma - _second_moments(tried))
            way = _way(H @ np.swapaxes(self._root, -1, -2))[..., None, None]
            inside = tensor[1] + way * (tried - tensor[1])
            value = _inner(W, inside)
            better = (value > best)[..., None, None]
            chosen = inside if chosen is None else np.where(better, inside, chosen)
            best = np.maximum(best, value)
        assert chosen is not None
        return m, m[..., None] * c, chosen + steiner(m, c)

    def _about_frame(self, a: Array, g: Array, W: Array) -> tuple[Array, Array, Array]:
        which = self._frames
        mass, com, tensor = self.mass[:, which], self.com[:, which], self.inertia[:, which]
        start = (mass[1], mass[1][..., None] * com[1], tensor[1])
        towards = np.where(g > 0.0, com[2], com[0])
        found, best = None, np.full(a.shape, -np.inf)
        for end, c, tried in product(
            (0, 2),
            (towards, np.broadcast_to(com[1], towards.shape)),
            self._tensors(W, which, tensor),
        ):
            m = np.broadcast_to(mass[end], a.shape)
            candidate = self._pulled(start, (m, m[..., None] * c, tried))
            value = a * candidate[0] + (g * candidate[1]).sum(-1) + _inner(W, candidate[2])
            better = value > best
            best = np.where(better, value, best)
            if found is None:
                found = candidate
                continue
            found = (
                np.where(better, candidate[0], found[0]),
                np.where(better[..., None], candidate[1], found[1]),
                np.where(better[..., None, None], candidate[2], found[2]),
            )
        assert found is not None
        return found

    def _tensors(self, W: Array, which: Ints, tensor: Array) -> list[Array]:
        """Tensors of the box (x, b, 3, 3) with a large <W, I>, to be pulled until physical.

        The vertex; that of the moments alone; the nominal one made larger or smaller as a whole.
        """
        vertex = np.where(W > 0.0, tensor[2], tensor[0])
        moments = np.where(np.eye(3, dtype=bool), vertex, tensor[1])
        larger = _inner(W, tensor[1]) > 0.0
        scale = np.where(larger, self._scales[1, which], self._scales[0, which])
        return [vertex, moments, scale[..., None, None] * tensor[1]]

    def _pulled(
        self, start: tuple[Array, Array, Array], end: tuple[Array, Array, Array]
    ) -> tuple[Array, Array, Array]:
        """As far on the straight way from start to end as bodies are physical."""
        root = self._pseudo_root
        H = root @ (self._pseudo - _pseudo_inertia(*end)) @ np.swapaxes(root, -1, -2)
        way = _way(H)
        return (
            start[0] + way * (end[0] - start[0]),
            start[1] + way[..., None] * (end[1] - start[1]),
            start[2] + way[..., None, None] * (end[2] - start[2]),
        )

    def _scaling(self) -> Array:
        """Least and largest factor (2, b) on a nominal tensor that leave it in the box."""
        low, middle, high = (x.reshape(len(x), -1) for x in self.inertia)
        some = middle != 0.0
        divisor = np.where(some, middle, 1.0)
        one, other = (np.where(some, x / divisor, 1.0) for x in (low, high))
        ends = np.minimum(one, other), np.maximum(one, other)
        least = np.where(some, ends[0], 0.0).max(axis=1)
        most = np.where(some, ends[1], np.inf).min(axis=1)
        return np.stack([least, np.where(np.isfinite(most), most, 1.0)])


def _bodies(weights: Weights) -> tuple[Array, Array, Array]:
    return weights.mass, weights.moment, weights.inertia


def _largest_quadratic(g: Array, A: Array, lo: Array, hi: Array) -> Array:
    """COMs (x, b, 3) of the box with a large g'c + c'A c: the best vertex, then each coordinate."""
    vertices = np.where(_VERTICES[:, None] == 1, hi, lo)  # (8, b, 3)
    value = np.einsum("xbi,vbi->xvb", g, vertices)
    value = value + np.einsum("vbi,xbij,vbj->xvb", vertices, A, vertices)
    best = np.argmax(value, axis=1)  # (x, b)
    c: Array = vertices[best, np.arange(lo.shape[0])]
    for _ in range(_SWEEPS):
        for i in range(3):
            others = g[..., i] + 2.0 * ((A[..., i, :] * c).sum(-1) - A[..., i, i] * c[..., i])
            square = A[..., i, i]
            bent = square < 0.0
            still = -others / np.where(bent, 2.0 * square, 1.0)
            tried = np.stack(
                [
                    np.broadcast_to(lo[:, i], others.shape),
                    np.broadcast_to(hi[:, i], others.shape),
                    np.where(bent, np.clip(still, lo[:, i], hi[:, i]), c[..., i]),
                ]
            )
            gain = others * tried + square * tried * tried
            c[..., i] = np.take_along_axis(tried, np.argmax(gain, axis=0)[None], axis=0)[0]
    return c


def _way(H: Array) -> Array:
    """The largest s in [0, 1] with 1 - s H positive semidefinite."""
    largest = np.linalg.eigvalsh(0.5 * (H + np.swapaxes(H, -1, -2)))[..., -1]
    return np.asarray(np.where(largest > 1.0, 1.0 / np.maximum(largest, 1.0), 1.0))


def _second_moments(inertia: Array) -> Array:
    """tr(I)/2 1 - I: positive semidefinite for a body (..., 3, 3) [kg m^2]."""
    return np.asarray(0.5 * _trace(inertia)[..., None, None] * np.eye(3) - inertia)


def _pseudo_inertia(mass: Array, moment: Array, inertia: Array) -> Array:
    """[[second moments, h], [h', m]]: positive semidefinite for a body (..., 4, 4)."""
    P = np.zeros((*mass.shape, 4, 4))
    P[..., :3, :3] = _second_moments(inertia)
    P[..., :3, 3] = P[..., 3, :3] = moment
    P[..., 3, 3] = mass
    return P


def _inverse_root(matrices: Array) -> Array:
    """L^-1 with L L' the matrices (..., k, k), raised a little where they are on the border."""
    if not matrices.size:
        return matrices
    trace = np.trace(matrices, axis1=-2, axis2=-1)
    least = np.linalg.eigvalsh(matrices)[..., 0]
    raised = np.maximum(-least, 0.0) * (1.0 + _FLAT) + _FLAT * np.abs(trace) + _NOTHING
    size = matrices.shape[-1]
    factor = np.linalg.cholesky(matrices + raised[..., None, None] * np.eye(size))
    return np.asarray(np.linalg.inv(factor))


def _inner(W: Array, tensor: Array) -> Array:
    return np.asarray((W * tensor).sum(axis=(-2, -1)))


def _trace(tensors: Array) -> Array:
    return np.asarray(np.trace(tensors, axis1=-2, axis2=-1))
