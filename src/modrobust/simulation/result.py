"""What a simulated run leaves: arrays over time, figures over all ticks, a verdict, a file."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from modrobust import _kernel
from modrobust.checks import files, replacing
from modrobust.checks.types import Array
from modrobust.control import RobustController
from modrobust.errors import ModrobustError
from modrobust.kernel import own_environment
from modrobust.model import ControllerSettings, LoopSettings, Parameters, Robot
from modrobust.simulation.divergence import Divergence, find_divergence
from modrobust.simulation.metrics import (
    CHATTERING_LIMIT,
    MOST_AT_LIMIT,
    chattering,
    plain,
    ratio,
    time_statistics,
)
from modrobust.simulation.remarks import remarks

_LOG_FILE = (".npz", "a log")

LOGGED = (
    *(
        "t",
        "q",
        "dq",
        "q_des",
        "dq_des",
        "ddq_des",
        "tau",
        "nominal",
        "w",
        "phi_lo",
        "phi_hi",
        "rho",
    ),
    *("width_hull", "width_ianea", "total_variation"),
)


@dataclass(frozen=True, eq=False)
class LoopStatistics:
    """Figures over all ticks of the loop, not only the logged ones."""

    ticks: int
    time: float  # [s], of the last tick's end
    status: int
    violations: int
    violation_max: float
    error_last: float
    last_outside: float  # [s], last tick with an error of epsilon or more, -1 if never
    error_max_after: float
    tau_max: Array
    rho_sum: float
    rho_max: float
    limited: int  # ticks at which a torque limit cut the command
    ticks_at_limit: Array  # of each joint

    @classmethod
    def of(cls, loop: _kernel.Loop) -> LoopStatistics:
        """The loop's figures as they are now."""
        return cls(
            ticks=loop.ticks,
            time=loop.time,
            status=loop.status,
            violations=loop.violations,
            violation_max=loop.violation_max,
            error_last=loop.error_last,
            last_outside=loop.last_outside,
            error_max_after=loop.error_max_after,
            tau_max=np.array(loop.tau_max),
            rho_sum=loop.rho_sum,
            rho_max=loop.rho_max,
            limited=loop.limited,
            ticks_at_limit=np.array(loop.ticks_at_limit),
        )


@dataclass(frozen=True, eq=False)
class SimulationResult:
    """A run of the closed loop, logged about every millisecond; n joints, m logged ticks.

    The loop is (23) under the command (3); figures are those of Section V of the paper.

    Source: Section V of [GA17].
    """

    robot: Robot
    settings: dict[str, Any]
    controller: ControllerSettings
    loop: LoopSettings
    parameters: Parameters
    """True parameters of the plant."""
    statistics: LoopStatistics | None
    """Figures over all ticks; None when the run was interrupted before its first chunk."""
    interrupted: bool
    t: Array
    """Instants of the m logged ticks, ``(m,)`` [s]."""
    q: Array
    """Positions, ``(m, n)`` [rad]."""
    dq: Array
    """Velocities, ``(m, n)`` [rad/s]."""
    q_des: Array
    """Desired positions, ``(m, n)`` [rad]."""
    dq_des: Array
    """Desired velocities, ``(m, n)`` [rad/s]."""
    ddq_des: Array
    """Desired accelerations, ``(m, n)`` [rad/s^2]."""
    tau: Array
    """Torques, u of (3) or (32), as the drive has cut them, ``(m, n)`` [N m]."""
    nominal: Array
    """Nominal part of the torques, u_0, ``(m, n)`` [N m]."""
    w: Array
    """Perturbation that the true parameters make, (6), ``(m, n)`` [N m]."""
    phi_lo: Array
    """Lower bound of w by the run's own ``bound``, (12), ``(m, n)`` [N m]."""
    phi_hi: Array
    """Upper bound of w, (12), ``(m, n)`` [N m]."""
    rho: Array
    """Worst case of each joint, (8), ``(m, n)`` [N m]."""
    width_hull: Array
    """Width of [Phi] by the exact hull, ``(m, n)`` [N m]."""
    width_ianea: Array
    """Width of [Phi] by Algorithm 1, ``(m, n)`` [N m]."""
    total_variation: Array
    """Sum of the torque's changes over all ticks so far, ``(m, n)`` [N m]."""

    @property
    @own_environment()
    def error(self) -> Array:
        """Norm of the tracking error of (4) at the logged ticks, ``(m,)`` [rad] or [m].

        Source: Section V of [GA17].
        """
        return np.asarray(np.linalg.norm(self.robot.tracking_error(self.q, self.q_des), axis=1))

    @property
    def diverged(self) -> bool:
        """Whether the loop left the range in which it can be computed."""
        return self.statistics is not None and self.statistics.status != _kernel.STATUS_OK

    @cached_property
    @own_environment()
    def divergence(self) -> Divergence | None:
        """Why the loop diverged, see `modrobust.simulation.divergence`; None where it did not."""
        if not self.diverged:
            return None
        return find_divergence(
            self.robot,
            self.parameters,
            self.controller,
            1.0 / self.loop.rate,
            self.t,
            self.q,
            self.dq,
            self.error,
            self.rho,
        )

    @property
    @own_environment()
    def epsilon_entered_at(self) -> float | None:
        """First instant from which the error stayed below epsilon to the end [s], or None."""
        s = self.statistics
        if s is None or s.ticks == 0 or self.diverged or s.error_last >= self.controller.epsilon:
            return None
        return 0.0 if s.last_outside < 0.0 else s.last_outside + 1.0 / self.loop.rate

    @property
    @own_environment()
    def cut_short(self) -> bool:
        """Whether the motion takes longer than the run was to: epsilon is not judged then."""
        whole = self.settings.get("motion_time")
        return whole is not None and self.settings["duration"] < whole * (1.0 - 1e-12)

    @cached_property
    def command_seconds(self) -> Array:
        """Time of each command (3) in C, ``(m,)`` [s], from a replay of the logged inputs.

        A fresh controller gets the inputs logged at 1 ms, as in Section V of the paper, once to
        warm up and once to be timed. Empty where a diverged run cannot be replayed.

        Source: Section V of [GA17].
        """
        if len(self.t) == 0:
            return np.zeros(0)
        robot = replace(
            self.robot, loop=self.loop
        )  # given as such, a slow rate would be told twice
        controller = RobustController(robot, **vars(self.controller))
        inputs = (self.q, self.dq, self.q_des, self.dq_des, self.ddq_des)
        try:
            controller.time_commands(self.t[:1000], *(x[:1000] for x in inputs))
            return controller.time_commands(self.t, *inputs)
        except ModrobustError:  # a diverged run can end in states that cannot be replayed
            return np.zeros(0)

    @property
    @own_environment()
    def reasons(self) -> list[str]:
        """Why the run's answer is bad, one sentence each; empty when it is good."""
        s = self.statistics
        wanted = self.settings["duration"]
        reasons = []
        if self.interrupted:
            reached = 0.0 if s is None else min(s.time, wanted)
            reasons.append(f"interrupted at {reached:.6g} s of {wanted:.6g} s")
        if s is None:
            return reasons
        if self.divergence is not None:
            reasons.append(
                f"the loop diverged at {s.time:.6g} s: {self.divergence.cause}; what helps: "
                f"{self.divergence.remedy}"
            )
        if s.violations:
            reasons.append(f"the bound was violated at {s.violations} of {s.ticks} ticks")
        if self.diverged:
            return reasons  # what else is wrong follows from it
        if self.epsilon_entered_at is None and not self.cut_short:
            reasons.append(
                f"the tracking error did not stay below epsilon = {self.controller.epsilon:g}: "
                f"{s.error_last:.3g} at the end"
            )
        for j, limit in enumerate(self.robot.effort_limits):
            if s.tau_max[j] > limit:
                unit = "N m" if self.robot.free_turns[j] else "N"
                reasons.append(
                    f'joint "{self.robot.joint_names[j]}" needed {s.tau_max[j]:.4g} {unit}, '
                    f"beyond its limit of {limit:.4g} {unit}"
                )
        if s.limited > MOST_AT_LIMIT * s.ticks:
            reasons.append(f"{self._limits_named}: more than {MOST_AT_LIMIT:.0%} of the time")
        return reasons

    @property
    def _limits_named(self) -> str:
        """At how many ticks torque limits cut the command, and which joints they are of."""
        s = self.statistics
        assert s is not None
        named = [
            f'"{name}" at {int(count)}'
            for name, count in zip(self.robot.joint_names, s.ticks_at_limit, strict=True)
            if count
        ]
        which = f" (joint {', '.join(named)})" if named else ""
        return f"torque limits cut the command at {s.limited} of {s.ticks} ticks{which}"

    @cached_property
    @own_environment()
    def chattering(self) -> Array | None:
        r"""How much each torque moves over what its samples at 10 Hz do, ``(n,)`` [1].

        .. math:: \sum_k |\tau_k - \tau_{k-1}| \Big/ \sum_j |\tau(t_j) - \tau(t_{j-1})|

        over the last 5 s: over all ticks above, every 0.1 s below. None where a run is shorter.

        Source: our own; `modrobust.simulation.metrics.chattering` has the cases without motion.
        """
        return chattering(self.t, self.tau, self.total_variation)

    @property
    @own_environment()
    def remarks(self) -> list[str]:
        """What the verdict does not judge, one sentence each; empty of a run that diverged.

        Of the motion, torques that chatter, and positions and velocities beyond their limits, which
        the controller does not know; of the logged ticks. What a run that diverged did follows
        from that.
        """
        if self.diverged:
            return []
        duration = self.settings["duration"]
        settings = self.robot, self.controller, self.loop, duration
        logged = self.t, self.q, self.dq, self.tau
        of_run = remarks(*settings, *logged, self.chattering)
        said = list(self.settings.get("motion_remarks", ()))
        if self.statistics is not None and self.statistics.limited > 0:
            said.append(f"{self._limits_named}: nothing is guaranteed while they do")
        if self.settings.get("rate_warning"):
            said.append(self.settings["rate_warning"])
        return [*said, *of_run]

    @property
    def ok(self) -> bool:
        """No violation, no divergence, epsilon entered permanently, torques within their limits.

        Of a run that was `cut_short` epsilon is not judged.
        """
        return not self.reasons

    @own_environment()
    def summary(self) -> dict[str, Any]:
        """The run in figures, plain Python ready for JSON; null where there is no number."""
        s = self.statistics
        mean = (
            (lambda x: x.mean(axis=0)) if len(self.t) else (lambda x: np.full(x.shape[1:], np.nan))
        )
        width_hull, width_ianea = mean(self.width_hull), mean(self.width_ianea)
        figures = {
            "violations": 0 if s is None else s.violations,
            "violation_max": None if s is None else s.violation_max,
            "diverged": self.diverged,
            "divergence": None if self.divergence is None else self.divergence.to_dict(),
            "epsilon_entered_at": self.epsilon_entered_at,
            "cut_short": self.cut_short,
            "error_final": None if s is None else s.error_last,
            "error_max_after_entry": (
                None if s is None or self.epsilon_entered_at is None else s.error_max_after
            ),
            "tau_max": None if s is None else s.tau_max,
            "tau_limit": self.robot.effort_limits,
            "rho_mean": None if s is None or s.ticks == 0 else s.rho_sum / s.ticks,
            "rho_max": None if s is None else s.rho_max,
            "width_hull": width_hull,
            "width_ianea": width_ianea,
            "ianea_over_hull": ratio(width_ianea, width_hull),
            "chattering": self.chattering,
            "chattering_limit": None if self.loop.noisy else CHATTERING_LIMIT,
            "limited": 0 if s is None else s.limited,
            "ticks_at_limit": None if s is None else s.ticks_at_limit,
            "command_time": time_statistics(self.command_seconds),
            "ticks": 0 if s is None else s.ticks,
            "time": 0.0 if s is None else min(s.time, self.settings["duration"]),
            "interrupted": self.interrupted,
            "uncertain": self.robot.uncertain,
            "ok": self.ok,
            "reasons": self.reasons,
            "remarks": self.remarks,
            "joints": list(self.robot.joint_names),
            "settings": self.settings,
        }
        result: dict[str, Any] = plain(figures)
        return result

    def save(self, path: str | Path) -> None:
        """Write all arrays, the settings and the summary to an ``.npz`` file, whole or not at all.

        Keys: every logged array; ``true_parameters``, packed; ``settings`` and ``summary``, JSON.

        Raises:
            FileError: The file cannot be written; one that was there is as it was.
        """
        with replacing(path, *_LOG_FILE) as part:
            np.savez_compressed(
                part,
                **{name: getattr(self, name) for name in LOGGED},
                true_parameters=self.parameters.packed,
                settings=np.array(json.dumps(self.settings)),
                summary=np.array(json.dumps(self.summary())),
            )


def check_writable(path: str | Path) -> None:
    """Refuse a place where `SimulationResult.save` could not write, before a run starts.

    Raises:
        FileError: The suffix is not ``.npz``, or the place is a directory, missing or read-only.
    """
    files.check_writable(path, *_LOG_FILE)
