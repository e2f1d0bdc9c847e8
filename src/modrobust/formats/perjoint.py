"""Values given per joint: one quantity for all joints, or a mapping by joint name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from modrobust.checks import unknown_name
from modrobust.formats.nodes import ListNode, MapNode, Node, shown
from modrobust.formats.quantity import Quantity, parse_quantity

# What a kind measures for (revolute, prismatic) joints.
_DIMENSIONS = {
    "position": ("angle", "length"),
    "velocity": ("angular speed", "speed"),
    "effort": ("torque", "force"),
    "rate": ("rate", "rate"),
}


@dataclass(frozen=True)
class PerJoint:
    """A per-joint value as written; `resolve` gives one quantity a joint.

    `kind` is "position", "velocity", "effort" or "rate" (1/s, for gains); a value with
    `positive` must be above 0, one that is a `size` not below, one without `bounds` takes none.
    """

    node: Node
    field: str
    kind: str
    bounds: bool = False
    positive: bool = False
    size: bool = False

    def __post_init__(self) -> None:
        """Refuse at once what fits no kind of joint."""
        for name, node in self._values().items():
            self._parse(node, name, _DIMENSIONS[self.kind])

    def resolve(self, joint_names: Sequence[str], joint_types: Sequence[str]) -> list[Quantity]:
        """One quantity a joint in SI units, in the order of `joint_names`.

        Raises:
            DescriptionError: A joint name is unknown or missing, or a unit does not fit the type
                of a joint ("revolute" or "prismatic").
        """
        values = self._values()
        named = "" not in values
        if named:
            self._check_names(values, joint_names)
        result = []
        for joint, type_ in zip(joint_names, joint_types, strict=True):
            dimension = _DIMENSIONS[self.kind][type_ == "prismatic"]
            name = joint if named else ""
            suffix = "" if named else f" (joint {joint})"
            result.append(self._parse(values[name], name, (dimension,), suffix))
        return result

    def _values(self) -> dict[str, Node]:
        """Nodes by joint name; the name is empty for one value for all joints."""
        node = self.node
        if isinstance(node, MapNode) and not {"nominal", "lo", "hi"} & set(node):
            if not node.entries:
                raise node.where.error(
                    self.field, "nothing; a mapping names every joint; write joint: value"
                )
            return dict(node.entries)
        if isinstance(node, ListNode) and not (self.bounds and len(node.items) == 2):
            raise node.where.error(
                self.field,
                f"a list of {len(node.items)}; a value per joint is one quantity for all joints "
                "or a mapping by joint name, never a list; write joint: value for each joint",
            )
        return {"": node}

    def _parse(
        self, node: Node, name: str, dimensions: tuple[str, ...], suffix: str = ""
    ) -> Quantity:
        field = f"{self.field}.{name}" if name else f"{self.field}{suffix}"
        quantity = parse_quantity(
            node, dimensions[0], field=field, bounds=self.bounds, alternatives=dimensions[1:]
        )
        if self.positive and quantity.nominal <= 0:
            raise node.where.error(
                field,
                f"{quantity.nominal:g} is not positive; it must be above 0; write "
                "a positive number",
            )
        if self.size and quantity.nominal < 0:
            raise node.where.error(
                field, f"{quantity.nominal:g} is negative; it is at least 0; write 0 or more"
            )
        return quantity

    def _check_names(self, values: dict[str, Node], joint_names: Sequence[str]) -> None:
        for name in values:
            if name not in joint_names:
                raise values[name].where.error(
                    self.field,
                    unknown_name(f"no joint named {shown(name)}", name, joint_names),
                )
        for name in joint_names:
            if name not in values:
                raise self.node.where.error(
                    self.field,
                    f'no value for joint "{name}"; a mapping names every joint; add {name}',
                )
