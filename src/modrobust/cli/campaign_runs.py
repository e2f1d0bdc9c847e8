"""The command that does a run of a campaign once more."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from modrobust.campaign.job import Job

_SIGN = "sign="  # of the noise, as --noise has it


@dataclass(frozen=True)
class Repeated:
    """Says how a run is done again by its number: by ``simulate`` where that can say it.

    Args:
        file: As the user named it.
        job: Of the campaign.
        shared: Options that both commands have; None = not given.
        own: Those of ``campaign`` alone.
    """

    file: str
    job: Job
    shared: Mapping[str, object]
    own: Mapping[str, object]

    def __call__(self, index: int) -> str:
        """The command of that run."""
        of_run = self._simulate(index)
        if of_run is not None:
            return of_run
        given = {**self.shared, **self.own, "only": index}
        return _typed("campaign", self.file, given)

    def _simulate(self, index: int) -> str | None:
        """By ``simulate``; None where it has no options for the run."""
        job, run = self.job, self.job.plan.run(index)
        noise = self._noise(run.noise)
        start = job.plan.initial_error
        sayable = run.motion == "own" and job.plain and isinstance(start, float)
        if not sayable or noise is False or self.own["epsilon"] is not None:
            return None
        given = {
            **self.shared,
            "noise": noise,
            "disturbance": run.disturbance,
            "parameters": run.parameters,
            "seed": run.seed,
            "initial-error": self.own["initial-error"] or repr(start),
        }
        return _typed("simulate", self.file, given)

    def _noise(self, kind: str) -> object:
        """The text of --noise, None for none, False where only a file could say it."""
        given = self.shared["noise"]
        if kind in ("none", self.job.loop.noise):
            return given
        if not isinstance(given, str) or _SIGN in given.replace(" ", ""):
            return False
        return f"{given}, {_SIGN}{kind}"


def _typed(command: str, file: str, options: Mapping[str, object]) -> str:
    """A command line; options of None are left out."""
    said = ["modrobust", command, file]
    for name, value in options.items():
        if value is None:
            continue
        if isinstance(value, bool):
            said.append(f"--{name}" if value else f"--no-{name}")
            continue
        for item in value if isinstance(value, list) else [value]:
            said += [f"--{name}", str(item)]
    return shlex.join(said)
