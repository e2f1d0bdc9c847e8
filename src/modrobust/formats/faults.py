"""All faults of a description in one reading: collected where they are found, raised at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TypeVar

from modrobust.errors import DescriptionError, SeveralFaultsError

T = TypeVar("T")


@dataclass
class Faults:
    """What was found so far.

    Who reads a list reads each entry inside `caught`, so that one at fault does not hide the
    others, and then calls `stop`.
    """

    found: list[DescriptionError] = field(default_factory=list)

    def add(self, *faults: DescriptionError) -> None:
        """One or several more."""
        for fault in faults:
            self.found += fault.faults if isinstance(fault, SeveralFaultsError) else (fault,)

    @contextmanager
    def caught(self) -> Iterator[None]:
        """A block whose refusal is kept, and told by `stop`."""
        try:
            yield
        except DescriptionError as fault:
            self.add(fault)

    def attempt(self, read: Callable[[], T], instead: T) -> T:
        """What `read` gives; `instead` where it refuses, which is kept."""
        with self.caught():
            return read()
        return instead

    def stop(self, overlay: str = "") -> None:
        """Ends the reading where anything was found.

        Args:
            overlay: Lines that follow several faults, see `SeveralFaultsError`.

        Raises:
            DescriptionError: The one fault that there is, unchanged.
            SeveralFaultsError: There are several: by file, and there by line.
        """
        unique = list({str(fault): fault for fault in self.found}.values())
        if len(unique) == 1:
            raise unique[0] from None
        if unique:
            files = [fault.file for fault in unique]
            unique.sort(key=lambda fault: (files.index(fault.file), fault.line or 0))
            raise SeveralFaultsError(unique, overlay) from None
