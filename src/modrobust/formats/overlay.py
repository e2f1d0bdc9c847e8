"""A URDF with what an assembly file lays over it: selection, locks, overlays, tolerance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from modrobust.formats.nodes import Node, ScalarNode, Where
from modrobust.formats.part_models import JointOverlay, LinkOverlay, ToleranceModel


@dataclass(frozen=True)
class UrdfSource:
    """A URDF and what is laid over it.

    Args:
        file: Path of the file, ``package:NAME/PATH`` for a file of an installed package, or
            ``package://NAME/PATH`` for one in the folder that `packages` gives.
        base_link, tip_link: Ends of the chain to take, None = the root, and all branches.
        lock: Joint name to the position [rad] or [m] that it is frozen at.
        links, joints: Overlays by name.
        drive: Figures of every joint that moves freely, over all others: rotor_inertia, gear_ratio,
            viscous, coulomb.
        tolerance: Bounds for parameters that have none of their own.
        xacro: Arguments of a xacro file by name.
        packages: Folders of packages by name, for ``package://NAME`` and ``$(find NAME)``.
        where: Where the URDF is named.
    """

    file: str
    where: Where
    directory: Path = Path()  # what a relative file is relative to
    base_link: ScalarNode | None = None
    tip_link: ScalarNode | None = None
    lock: Mapping[str, Node] = field(default_factory=dict)
    links: Mapping[str, LinkOverlay] = field(default_factory=dict)
    joints: Mapping[str, JointOverlay] = field(default_factory=dict)
    tolerance: ToleranceModel | None = None
    drive: Mapping[str, Node] = field(default_factory=dict)
    xacro: Mapping[str, str] = field(default_factory=dict)
    packages: Mapping[str, Path] = field(default_factory=dict)
