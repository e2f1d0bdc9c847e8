"""Faults of a URDF in one reading, and which figures an overlay would have to give."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from modrobust.assembly.urdf.overlay import figures_of, overlay_text
from modrobust.assembly.urdf.reader import Link
from modrobust.errors import DescriptionError, SeveralFaultsError
from modrobust.formats.faults import Faults


@dataclass
class UrdfFaults(Faults):
    """Faults, with the links and joints whose figures are open."""

    links: dict[str, set[str]] = field(default_factory=dict)
    joints: list[str] = field(default_factory=list)

    @contextmanager
    def of_joint(self, name: str) -> Iterator[None]:
        """A block that reads joint `name`."""
        try:
            yield
        except DescriptionError as fault:
            self.add(fault)
            limits = f"joint {name}, limits"
            if fault.field == limits or fault.field.startswith(f"{limits}.position"):
                self.joints.append(name)

    @contextmanager
    def of_link(self, link: Link) -> Iterator[None]:
        """A block that reads `link`."""
        try:
            yield
        except DescriptionError as fault:
            self.add_of_link(link, fault)

    def add_of_link(self, link: Link, fault: DescriptionError) -> None:
        """A fault of a link's figures, and of those that the reader of its inertial found."""
        self.add(fault)
        faults = fault.faults if isinstance(fault, SeveralFaultsError) else (fault,)
        rotated = link.inertial is not None and link.inertial.rotated
        own = {key for key, found in link.faults.items() if found in faults}
        figures = own | figures_of(faults, link.name, rotated)
        self.links.setdefault(link.name, set()).update(figures)

    def add_massless(self, link: str, fault: DescriptionError) -> None:
        """A link that moves and has no figures at all."""
        self.add(fault)
        self.links[link] = {"mass", "com", "inertia"}

    def stop(self, overlay: str = "") -> None:
        """See `Faults.stop`; the overlay is that of the figures that are open."""
        super().stop(overlay or overlay_text(self.links, self.joints))
