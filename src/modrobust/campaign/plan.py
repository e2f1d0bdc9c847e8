r"""Which runs a campaign is made of: a list in which run k depends on nothing but its number.

Run k takes the kinds of true parameters in turn, k modulo their number; disturbance, noise and
motion are those of a list of all their combinations, which is shuffled anew for each kind of
parameters and each time that it has been gone through. Its seed is

.. math:: s_k = 10^6 s + k

with the campaign's own s. Whatever the number of runs, the first ones stay the same.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from modrobust.checks import as_integer, unknown_name
from modrobust.checks.types import Array
from modrobust.errors import ShapeError, ValueRangeError
from modrobust.model import DISTURBANCES, NOISES, LoopSettings, Robot
from modrobust.simulation.run import PARAMETER_CHOICES

MAX_RUNS = 10**6
PARAMETERS = ("lower", "upper", "corner", "random")
MOTIONS = ("own", "short", "long")
INITIAL_ERROR = 0.005  # [rad] or [m], norm


@dataclass(frozen=True)
class Plan:
    """What the runs of a campaign differ in.

    Args:
        seed: Seeds everything that is drawn.
        parameters: Kinds of true parameters, taken in turn, see `modrobust.simulate`.
        disturbances: Kinds of the disturbance in [d], see `LoopSettings`.
        noises: Kinds of the noise, where the loop has any.
        motions: ``"own"``, the description's; ``"short"`` and ``"long"``, drawn rest to rest in
            1 s and in 10 s, see `modrobust.campaign.motions`.
        initial_error: Norm of the error at the start, its direction drawn [rad] or [m]; or its
            size on each joint, n of them, the signs drawn.
    """

    seed: int = 0
    parameters: tuple[str, ...] = PARAMETERS
    disturbances: tuple[str, ...] = DISTURBANCES
    noises: tuple[str, ...] = NOISES
    motions: tuple[str, ...] = MOTIONS
    initial_error: float | tuple[float, ...] = INITIAL_ERROR

    def run(self, index: int) -> Run:
        """The run of that number, from 0."""
        kinds = len(self.parameters)
        kind, turn = index % kinds, index // kinds
        mixed = list(itertools.product(self.disturbances, self.noises, self.motions))
        rounds, place = divmod(turn, len(mixed))
        order = np.random.default_rng([self.seed, kind, rounds]).permutation(len(mixed))
        disturbance, noise, motion = mixed[order[place]]
        seed = self.seed * MAX_RUNS + index
        return Run(index, seed, self.parameters[kind], disturbance, noise, motion)


@dataclass(frozen=True)
class Run:
    """One run of a campaign; the loop, the law and its gains are common to all.

    Args:
        index: Its number, from 0.
        seed: Of its true parameters, noise, disturbance, motion and start.
        parameters: Kind of true parameters.
        disturbance: Kind of the disturbance.
        noise: Kind of the noise; "none" where the loop has none.
        motion: Kind of the motion.
    """

    index: int
    seed: int
    parameters: str
    disturbance: str
    noise: str
    motion: str

    def loop(self, common: LoopSettings) -> LoopSettings:
        """The common loop with the disturbance and noise of this run."""
        noise = common.noise if self.noise == "none" else self.noise
        return replace(common, disturbance=self.disturbance, noise=noise)


def checked_plan(
    robot: Robot,
    loop: LoopSettings,
    seed: int,
    parameters: Sequence[str],
    disturbances: Sequence[str],
    noises: Sequence[str],
    motions: Sequence[str],
    initial_error: float | Sequence[float] | Array,
) -> Plan:
    """The plan of these choices for a robot and its loop.

    Raises:
        ValueRangeError: A kind is unknown or none is given, a number is out of its range.
        ShapeError: ``initial_error`` does not have one entry a joint.
    """
    return Plan(
        seed=as_integer("seed", seed, 0),
        parameters=_kinds("parameters", parameters, PARAMETER_CHOICES),
        disturbances=_kinds("disturbances", disturbances, DISTURBANCES),
        noises=_kinds("noises", noises, NOISES) if loop.noisy else ("none",),
        motions=_kinds("motions", motions, MOTIONS),
        initial_error=_initial_error(robot, initial_error),
    )


def _kinds(name: str, given: Sequence[str], known: tuple[str, ...]) -> tuple[str, ...]:
    wanted = (given,) if isinstance(given, str) else tuple(given)
    if not wanted:
        raise ValueRangeError(f"{name}: none given; give one or more of {', '.join(known)}")
    for kind in wanted:
        if kind not in known:
            raise ValueRangeError(unknown_name(f'{name}: no kind "{kind}"', kind, known))
    return wanted


def _initial_error(
    robot: Robot, given: float | Sequence[float] | Array
) -> float | tuple[float, ...]:
    sizes = np.asarray(given, dtype=np.float64)
    if sizes.ndim and sizes.shape != (robot.n,):
        raise ShapeError(
            f"initial_error: expected a norm or shape ({robot.n},), got {sizes.shape}; robot "
            f'"{robot.name}" has {robot.n} joints'
        )
    for size in sizes.ravel():
        if not (math.isfinite(size) and size >= 0.0):
            raise ValueRangeError(f"initial_error: {size:g}; must be finite and not negative")
    return tuple(sizes.tolist()) if sizes.ndim else float(sizes)
