"""Names of mounted instances."""

from __future__ import annotations

from collections.abc import Iterable


def instance_names_of(mounted: Iterable[tuple[str, str | None]]) -> list[str]:
    """Instance names of (module id, `as`): `as` or the id, with -2, -3 on repeats.

    A suffix that another instance already has as its name is passed over.
    """
    wanted = [as_name or module for module, as_name in mounted]
    taken: set[str] = set()
    names = []
    for name in wanted:
        free, count = name, 1
        while free in taken or (count > 1 and free in wanted):
            count += 1
            free = f"{name}-{count}"
        taken.add(free)
        names.append(free)
    return names
