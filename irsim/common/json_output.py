"""JSON that irsim writes: texts with names of files that cannot be decoded (on Linux any bytes), and schemas."""

from __future__ import annotations

from typing import Any

__all__ = ["encodable", "schema_of_file"]


def encodable(data: Any) -> Any:
    r"""Plain data whose texts can be encoded: bytes in names that are not UTF-8 are written as ``\udcff``."""
    if isinstance(data, str):
        return data.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(data, dict):
        return {encodable(key): encodable(value) for key, value in data.items()}
    return [encodable(item) for item in data] if isinstance(data, (list, tuple)) else data


def schema_of_file(schema: dict[str, Any]) -> dict[str, Any]:
    """A JSON Schema as the whole of a file: with the version of JSON Schema that all schemas of irsim follow."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
