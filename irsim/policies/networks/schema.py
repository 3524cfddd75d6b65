"""The JSON Schema of the documents of networks."""

from __future__ import annotations

import json

from irsim.policies.networks.document import PolicyDocument

__all__ = ["policy_schema_text"]


def policy_schema_text() -> str:
    """The schema as the file has it."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **PolicyDocument.model_json_schema()}
    return json.dumps(schema, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
