"""Rows of modified D-H belong to joints: a span written behind its joint is another arm."""

from __future__ import annotations

from modrobust.formats.items import BodyItem, FrameItem, Item, JointItem
from modrobust.model.geometry import IDENTITY


class BehindJoint:
    """Follows a chain and knows the joint that nothing but frames of no extent has come after."""

    def __init__(self) -> None:
        self._joint: str | None = None

    def check(self, item: Item) -> None:
        """Takes the next entry of the chain.

        Raises:
            DescriptionError: A span of modified D-H stands directly behind a joint.
        """
        if isinstance(item, JointItem):
            self._joint = item.name
        elif isinstance(item, BodyItem | FrameItem):
            if self._joint is not None and item.modified is not None:
                kind = "body" if isinstance(item, BodyItem) else "frame"
                raise item.modified.error(
                    f"{kind} {item.name}, span.dh",
                    f"convention modified directly behind joint {self._joint}; a row of modified "
                    "D-H is Rx(alpha) Tx(a) Rz(q) Tz(d), so that its joint stands inside; give "
                    "the joint dh: {convention: modified, a: ..., alpha: ..., d: ...} and this "
                    "span none, or write a constant transform as standard or xyz and rpy",
                )
            if item.span != IDENTITY:
                self._joint = None
        else:
            self._joint = None  # a module: its own entries are looked at when it is mounted

    def passed(self) -> None:
        """Something of extent stands here."""
        self._joint = None
