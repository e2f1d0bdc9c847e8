"""A `Robot` without files: the description as arguments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from modrobust.assembly.load import assemble
from modrobust.formats.given_robot import given_assembly
from modrobust.kernel import own_environment
from modrobust.model import Robot

Description = Mapping[str, object]


@own_environment()
def build_robot(
    robot: str,
    chain: Sequence[str | Description],
    *,
    tolerance: str | Description | None = None,
    modules: str | Path | Sequence[str | Path] | None = None,
    base: Description | None = None,
    gravity: Sequence[float | str] | None = None,
    payload: str | Description | None = None,
    payloads: Mapping[str, str | Description] | None = None,
    disturbance: float | str | Description | None = None,
    controller: str | Description | None = None,
    loop: Description | None = None,
    trajectory: Description | None = None,
    initial: Description | None = None,
    scenarios: Description | None = None,
    source: str | Sequence[str] | None = None,
    notes: str | Sequence[str] | None = None,
) -> Robot:
    r"""A robot described in Python, with the words of the files and checked as they are.

    The arguments are the keys of an assembly file, but that joints and bodies may stand in the
    chain themselves. Where a file has a quantity, give a number in SI units, or a text with a unit,
    a tolerance or bounds, such as ``"2.5 kg ± 5%"``. Bits are those of the same description in a
    file; the name of a joint or body in the chain is its own, without an instance before it.

    .. math:: T_i = \mathrm{before}_i\, J_i(q_i)\, \mathrm{after}_i

    is what the chain comes down to, (14).

    Args:
        robot: Name of the robot.
        chain: From base to tip: ``{"joint": ...}``, ``{"body": ...}``, ``{"frame": ...}`` and
            ``{"module": ...}`` with the keys that an entry of a module file has, or names of
            modules. Lengths in [m], angles in [rad], masses in [kg], inertia in [kg m^2].
        tolerance: Bounds of what the chain's own bodies and joints state none for, such as
            ``"mass=5%,com=5mm"``.
        modules: Directories of modules that the chain names, before the built-in catalogue.
        base: World to base frame: ``xyz`` (3,) [m], ``rpy`` (3,) [rad].
        gravity: In world axes, (3,) [m/s^2]; None = 9.81 m/s^2 along -z.
        payload: A body at the tip, see `load_robot`.
        payloads: Several bodies at the tip by name, in place of one; ``"none"`` is no body.
        disturbance: Bounds of the disturbance of each joint [N m] or [N]: one for all, or by name.
        controller: Settings of the controller: ``K_r`` [1/s] and the other gains.
        loop: The loop as the drive runs it: ``rate`` [Hz], ``delay`` in periods, and so on.
        trajectory: The robot's own motion: ``kind`` and its keys.
        initial: State at the start: ``q`` [rad] or [m], ``dq`` [rad/s] or [m/s].
        scenarios: True parameters of simulations, by name.
        source: Where the figures come from.
        notes: Remarks for people.

    Raises:
        ValueRangeError: A value is no number, text, list or mapping.
        DescriptionError: The description is at fault; the message names argument and entry.
        FileError: A module cannot be read.

    Source: docs/reference/formats.md, whose rules hold; (14) and (15).
    """
    given = {
        "robot": robot,
        "chain": chain,
        "tolerance": tolerance,
        "modules": _paths(modules),
        "base": base,
        "gravity": gravity,
        "payload": payload,
        "payloads": payloads,
        "disturbance": disturbance,
        "controller": controller,
        "loop": loop,
        "trajectory": trajectory,
        "initial": initial,
        "scenarios": scenarios,
        "source": source,
        "notes": notes,
    }
    return assemble(given_assembly(given))


def _paths(given: str | Path | Sequence[str | Path] | None) -> str | list[str] | None:
    if given is None or isinstance(given, str | Path):
        return None if given is None else str(given)
    return [str(path) for path in given]
