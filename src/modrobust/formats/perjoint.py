"""Values given per joint: one quantity for all joints, or a mapping by joint name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from modrobust.formats.nodes import Node
from modrobust.formats.quantity import Quantity


@dataclass(frozen=True)
class PerJoint:
    """A per-joint value as written; `resolve` gives one quantity a joint.

    `kind` is "position", "velocity", "effort" or "rate" (1/s, for gains).
    """

    node: Node
    field: str
    kind: str
    bounds: bool = False

    def resolve(
        self, joint_names: Sequence[str], joint_types: Sequence[str]
    ) -> list[Quantity]:
        """One quantity a joint in SI units, in the order of `joint_names`.

        Raises:
            DescriptionError: A joint name is unknown or missing, or a unit does not fit the type
                of a joint ("revolute" or "prismatic").
        """
        raise NotImplementedError
