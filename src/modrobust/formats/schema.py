"""JSON Schema (draft 2020-12) of the description files, for editors."""

from __future__ import annotations

from typing import Any

from modrobust.formats.fields import Part
from modrobust.formats.models import AssemblyModel, ModuleModel

_MODELS: dict[str, type[Part]] = {"module": ModuleModel, "assembly": AssemblyModel}


def json_schema(kind: str) -> dict[str, Any]:
    """The schema of "module" or "assembly" files.

    It checks structure only: units, bounds and physics are checked when a file is loaded.

    Raises:
        KeyError: Another kind.
    """
    schema = _MODELS[kind].model_json_schema(by_alias=True)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **_tidy(schema),
        "title": f"modrobust {kind} file",
    }


def _tidy(schema: Any) -> Any:
    """Without the titles and null defaults that pydantic adds: an absent key is not null."""
    if isinstance(schema, list):
        return [_tidy(part) for part in schema if part != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    result = {}
    for key, value in schema.items():
        if (key == "title" and isinstance(value, str)) or (key == "default" and value is None):
            continue
        result[key] = _tidy(value)
    return result
