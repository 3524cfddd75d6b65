"""JSON Schema of case files, for editors: generated from the models, with expressions allowed in place of values."""

from __future__ import annotations

import json
from typing import Any

from irsim_evals.cases.model import Case

__all__ = ["case_schema", "schema_text"]

_NAMED = ("number", "integer", "boolean")


def case_schema() -> dict[str, Any]:
    """The schema; a text such as ``$(radius)`` or ``90deg`` may stand for any number or flag."""
    found = Case.model_json_schema(by_alias=True)
    opened: dict[str, Any] = _opened(found)
    opened["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    opened["title"] = "A case of irsim-evals"
    return opened


def schema_text() -> str:
    """The schema as the text of a file."""
    return json.dumps(case_schema(), indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def _opened(value: Any) -> Any:
    if isinstance(value, list):
        return [_opened(item) for item in value]
    if not isinstance(value, dict):
        return value
    made = {key: _opened(item) for key, item in value.items()}
    if made.get("type") in _NAMED:
        made["type"] = [made["type"], "string"]
    return made
