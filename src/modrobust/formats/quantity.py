"""Quantities: ``NUMBER [UNIT] [± NUMBER (UNIT|%)]``, ``[lo, hi]``, ``{nominal, lo, hi}``."""

from __future__ import annotations

from dataclasses import dataclass

from modrobust.formats.nodes import Node


@dataclass(frozen=True)
class Quantity:
    """A number in SI units with hard closed bounds.

    A value without a written bound has ``lo == nominal == hi`` and ``bounded`` False. Written
    bounds are rounded outward: ``lo`` and ``hi`` contain the decimals that were written.
    """

    nominal: float
    lo: float
    hi: float
    bounded: bool


def parse_quantity(
    text: str | Node, dimension: str, *, field: str = "", bounds: bool = True
) -> Quantity:
    """The quantity that a text or a node of a description says, in SI units.

    Args:
        text: The text, or the node (which then brings file and line for messages).
        dimension: A name such as "length", "angle", "mass", "time"; see `units.DIMENSIONS`.
        field: Name of the field or option for messages.
        bounds: Whether the value may carry bounds.
    """
    raise NotImplementedError
