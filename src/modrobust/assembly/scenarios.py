"""Named scenarios of an assembly file: points of the parameter box, nominal where not set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from modrobust.assembly.modules.mounting import JointStep
from modrobust.checks import did_you_mean
from modrobust.checks.types import Array
from modrobust.formats import ListNode, Node, parse_quantity
from modrobust.model import Parameters
from modrobust.model.symmetric import PLACES

Index = int | tuple[int, ...]

_FIELDS = ("mass", "com", "inertia", "rotor_inertia", "viscous", "coulomb")


@dataclass(frozen=True)
class _Target:
    """Where a path leads: an array of `Parameters`, an index, and what the number measures."""

    array: str
    index: Index
    dimension: str


def scenario_parameters(
    scenarios: Mapping[str, Mapping[str, Node]],
    body_names: Sequence[str],
    joints: Sequence[JointStep],
    nominal: Parameters,
    lower: Parameters,
    upper: Parameters,
) -> dict[str, Parameters]:
    """The parameters of each scenario.

    Raises:
        DescriptionError: A path names no parameter, a value is no point of the right dimension, or
            it lies outside the bounds of the description.
    """
    targets = _targets(body_names, joints)
    result = {}
    for name, settings in scenarios.items():
        arrays = {field: np.array(getattr(nominal, field)) for field in _FIELDS}
        for path, node in settings.items():
            field = f"scenarios.{name}.set.{path}"
            if path not in targets:
                raise node.where.error(
                    field,
                    f"no parameter of that name; {did_you_mean(path, targets)}"
                    "a path is instance.body.mass, .com or .inertia.xx, or instance.joint."
                    "friction.viscous, .friction.coulomb or .drive.rotor_inertia",
                )
            _set(arrays, targets[path], node, field, lower, upper)
        result[name] = Parameters(**arrays)
    return result


def _targets(body_names: Sequence[str], joints: Sequence[JointStep]) -> dict[str, _Target]:
    found = {}
    for k, name in enumerate(body_names):
        found[f"{name}.mass"] = _Target("mass", k, "mass")
        found[f"{name}.com"] = _Target("com", k, "length")
        for entry, (i, j) in PLACES.items():
            found[f"{name}.inertia.{entry}"] = _Target("inertia", (k, i, j), "inertia")
    for k, step in enumerate(joints):
        prismatic = step.item.type == "prismatic"
        viscous = "viscous friction" if prismatic else "angular viscous friction"
        coulomb = "force" if prismatic else "torque"
        if step.item.rotor_inertia is not None:
            found[f"{step.name}.drive.rotor_inertia"] = _Target("rotor_inertia", k, "inertia")
        if step.item.viscous is not None:
            found[f"{step.name}.friction.viscous"] = _Target("viscous", k, viscous)
        if step.item.coulomb is not None:
            found[f"{step.name}.friction.coulomb"] = _Target("coulomb", k, coulomb)
    return found


def _set(
    arrays: dict[str, Array],
    target: _Target,
    node: Node,
    field: str,
    lower: Parameters,
    upper: Parameters,
) -> None:
    """Writes the value of a node into its array after holding it against the bounds."""
    array, index = target.array, target.index
    lo, hi = (
        np.atleast_1d(getattr(lower, array)[index]),
        np.atleast_1d(getattr(upper, array)[index]),
    )
    if len(lo) == 3 and not (isinstance(node, ListNode) and len(node.items) == 3):
        raise node.where.error(
            field, "not a list of 3 lengths; a centre of mass is [x, y, z]; give three"
        )
    nodes = node.items if len(lo) == 3 and isinstance(node, ListNode) else (node,)
    values = [
        parse_quantity(entry, target.dimension, field=field, bounds=False).nominal
        for entry in nodes
    ]
    for value, low, high in zip(values, lo, hi, strict=True):
        if not low <= value <= high:
            raise node.where.error(
                field,
                f"{value:g} lies outside the bounds [{low:g}, {high:g}] of the description; a "
                "scenario is a robot that the bounds cover; widen them or change the value",
            )
    arrays[array][index] = values if len(lo) == 3 else values[0]
    if isinstance(index, tuple):
        k, i, j = index
        arrays[array][k, j, i] = values[0]
