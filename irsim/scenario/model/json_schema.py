"""The language as JSON Schema 2020-12, generated from the models and registries: for editors, agents and validators."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any

from irsim.common.data_files import published_schema
from irsim.common.json_output import schema_of_file
from irsim.options.base import SCHEMA_PARTS, SchemaParts
from irsim.scenario.model.scenario import Scenario

__all__ = ["INEXPRESSIBLE", "check", "json_schema", "schema_text"]


INEXPRESSIBLE: dict[str, str] = {
    "yaml-syntax": "the text is not valid YAML, so there is no data to validate",
    "empty-document": "the document has no data",
    "multiple-documents": "a schema sees one document",
    "duplicate-key": "the parsed mapping has the key once",
    "bad-key": "JSON has only text as keys",
    "unsupported-tag": "tags are gone once the text is parsed",
    "recursive-alias": "JSON has no references",
    "alias-expansion": "JSON has no references",
    "too-deep": "depth cannot be counted",
    "too-many-events": "size cannot be counted",
    "file-too-large": "size cannot be counted",
    "yaml-sexagesimal": "the parsed value is an ordinary number",
    "hash-comment": "the parsed value is empty",
    "yaml-octal": "the parsed value is an ordinary number",
    "not-a-number": "JSON has no NaN, and bounds do not exclude it",
    "wrong-length (control vectors)": "the length of vel_min, vel_max, acce and velocity depends on the kinematics",
    "range-order": "a schema cannot compare two numbers of the document",
    "limits-order": "a schema cannot compare two numbers of the document",
    "angle-range": "a schema cannot compare two numbers of the document",
    "bad-social-group": "the members of a group come from several entries",
    "duplicate-name": "uniqueness across entries, and over the objects of one entry",
    "unknown-object": "names of objects made by the document",
    "role-mismatch": "one entry model serves both sections",
    "too-many-objects": "a sum over the document",
    "placement-crowded": "arithmetic over the document",
    "too-large": "places of one object come from several keys",
    "invalid-polygon": "geometry",
    "too-few-vertices": "closing and repeated corners do not count",
    "not-yet-simulated": "it is part of the language, but this version does not simulate it",
    "behavior-for-other-drive": "depends on what user code has registered",
    "wrong-type (whole floats)": "to a schema 36.0 is an integer",
}
"""Rules that the models or checks enforce and the schema does not, with the reason; by diagnostic code."""


def json_schema(*, user_code: bool = True) -> dict[str, Any]:
    """The schema of scenario files, with all features, built in or of installed plug-ins.

    Args:
        user_code: Include the features that user code has registered in this process.
    """
    definitions = _definitions(user_code)
    definitions["Wrapped"] = {
        "description": "A file shared with another simulator: only the part under 'irsim' is read.",
        "type": "object",
        "required": ["irsim"],
        "properties": {
            "irsim": {
                "description": "The scenario, as if it were the whole document.",
                "type": "object",
                "if": True,
                "then": {"$ref": "#/$defs/Scenario"},
            }
        },
    }
    rules = "; ".join(f"{name}: {why}" for name, why in INEXPRESSIBLE.items())
    schema = {
        "$id": published_schema(),
        "title": "irsim scenario",
        "description": "A scenario of the robot-navigation simulator irsim: a world with robots and obstacles in it.",
        "$comment": f"Written by 'irsim schema'. It does not express: {rules}.",
        "anyOf": [{"$ref": "#/$defs/Scenario"}, {"$ref": "#/$defs/Wrapped"}],
        "$defs": {name: definitions[name] for name in sorted(definitions)},
    }
    return schema_of_file(schema)


def _definitions(user_code: bool) -> dict[str, Any]:
    """The schemas of all models: the scenario itself and all features that it can name."""
    makers: dict[str, Callable[[], dict[str, Any]]] = {"Scenario": Scenario.model_json_schema}
    definitions: dict[str, Any] = {}
    collecting = SCHEMA_PARTS.set(SchemaParts(makers, user_code))
    try:
        while waiting := [name for name in makers if name not in definitions]:
            for name in waiting:
                schema = makers[name]()
                definitions.update(schema.pop("$defs", {}))
                definitions[name] = schema
    finally:
        SCHEMA_PARTS.reset(collecting)
    return {name: _with_references(schema) for name, schema in definitions.items()}


def _with_references(node: Any) -> Any:
    """The node with the names of shared parts replaced by references."""
    if isinstance(node, list):
        return [_with_references(item) for item in node]
    if not isinstance(node, dict):
        return node
    return {
        "$ref" if key == "x-shared" else key: f"#/$defs/{value}" if key == "x-shared" else _with_references(value)
        for key, value in node.items()
    }


build_schema = json_schema


def schema_text() -> str:
    """The text of ``schema/scenario.schema.json``."""
    return json.dumps(json_schema(user_code=False), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def check(path: str | os.PathLike[str]) -> bool:
    """Whether the file at ``path`` is up to date with the models."""
    try:
        with open(path, encoding="utf-8") as file:
            return file.read() == schema_text()
    except OSError:
        return False
