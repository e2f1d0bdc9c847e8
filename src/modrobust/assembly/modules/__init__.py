"""Module files put together: the catalogue, connector compatibility, mounting along a chain."""
