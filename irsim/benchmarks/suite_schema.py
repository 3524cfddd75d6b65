"""The JSON Schema of suite files, for editors."""

from __future__ import annotations

import json

from irsim.benchmarks.suite import Suite

__all__ = ["suite_schema_text"]


def suite_schema_text() -> str:
    """The schema as the file has it."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **Suite.model_json_schema()}
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"
