"""Timor module databases, imported as module files of ours."""

from modrobust.timor.importer import import_timor, write_modules

__all__ = ["import_timor", "write_modules"]
