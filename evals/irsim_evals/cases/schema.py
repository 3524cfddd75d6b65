"""The JSON Schema of case files: what the model accepts, with expressions in place of values."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from irsim.common.json_output import schema_of_file
from irsim_evals.cases.model import Case
from irsim_evals.grader.predicates._base import registered, stands_at_start

__all__ = ["case_schema", "schema_text"]

_EXPRESSION = r"\$\(.+\)"
_QUANTITY = rf"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[^\s\d$]*\s*$|^\s*=|{_EXPRESSION}"


def case_schema() -> dict[str, Any]:
    """The schema; an expression such as ``$(radius)`` may stand for a value, a text such as ``90deg`` for a number."""
    schema = _opened(Case.model_json_schema(by_alias=True))
    parts = schema["$defs"]
    parts["Parameter"]["oneOf"] = _one_of(("choose", "between"))
    parts["Match"]["anyOf"][0]["anyOf"] = _one_of(
        name for name in parts["Match"]["anyOf"][0]["properties"] if name != "tol"
    )
    predicates = {name: one.__name__ for name, one in registered().items()}
    said = parts["Assertion"]["properties"]
    for name in predicates:
        said[name] = {key: value for key, value in said[name].items() if key != "default"}
        said[name]["anyOf"] = [one for one in said[name]["anyOf"] if one.get("type") != "null"]
    of_start = [name for name, one in registered().items() if stands_at_start(one)]
    of_episodes = [name for name, one in registered().items() if one.subject == "episode"]
    for place, names in ((schema, of_start), (parts["EpisodePlan"], of_episodes)):
        place["properties"]["assert"]["anyOf"][0]["items"] = {
            "$ref": "#/$defs/Assertion", "oneOf": _one_of(sorted(names)),
        }  # fmt: skip
    of_world = [name for name, one in registered().items() if one.subject in ("scene", "seeds")]
    parts["AnyOf"] = {"type": "array", "description": parts["AnyOf"]["description"]}
    several = {"type": "object", "additionalProperties": False, "minProperties": 1}
    for listed, names in ((parts["EveryScenario"]["properties"]["that"], of_world), (parts["AnyOf"], [*predicates])):
        listed["items"] = {**several, "properties": {name: said[name] for name in names}}
    return schema_of_file({**schema, "title": "A case of irsim-evals"})


def schema_text() -> str:
    """The schema as the text of a file."""
    return json.dumps(case_schema(), indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def _one_of(names: Iterable[str]) -> list[dict[str, Any]]:
    return [{"required": [name]} for name in names]


def _opened(value: Any) -> Any:
    """A part of the schema in which an expression may stand for every value that is not a text anyway."""
    if isinstance(value, list):
        return [_opened(item) for item in value]
    if not isinstance(value, dict):
        return value
    made = {key: value_ if key in ("default", "enum", "const") else _opened(value_) for key, value_ in value.items()}
    for key in ("properties", "$defs"):
        if key in value:
            made[key] = {name: _value(one) if key == "properties" else _opened(one) for name, one in value[key].items()}
    for key in ("items", "additionalProperties"):
        if isinstance(value.get(key), dict):
            made[key] = _value(value[key])
    if "prefixItems" in value:
        made["prefixItems"] = [_value(one) for one in value["prefixItems"]]
    return made


def _value(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of a value of a key or of an item of a list."""
    opened: dict[str, Any] = _opened(schema)
    about: dict[str, Any] = {key: opened.pop(key) for key in ("title", "description", "default") if key in opened}
    options: list[dict[str, Any]] = opened.get("anyOf") or [opened]
    if not any(one.get("type") == "string" and len(one) == 1 for one in options):
        number = any(one.get("type") == "number" for one in options)
        options = [*options, {"type": "string", "pattern": _QUANTITY if number else _EXPRESSION}]
    return {**about, "anyOf": options} if len(options) > 1 else {**about, **options[0]}
