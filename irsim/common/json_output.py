"""JSON of what irsim writes, also where the name of a file is no text, as names on Linux may be any bytes."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel
from pydantic_core import PydanticSerializationError, to_json

__all__ = ["json_bytes"]


def json_bytes(data: Any, **options: Any) -> bytes:
    r"""JSON in UTF-8; bytes in names that are not UTF-8 are written as ``\udcff``.

    Args:
        data: Plain data, or a model.
        **options: Options of ``pydantic_core.to_json``, such as ``indent``.
    """
    try:
        return to_json(data, **options)
    except PydanticSerializationError:
        plain = data.model_dump() if isinstance(data, BaseModel) else data
        return to_json(_encodable(plain), **options)


def _encodable(data: Any) -> Any:
    """Plain data whose texts can be encoded."""
    if isinstance(data, str):
        return data.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(data, dict):
        return {_encodable(key): _encodable(value) for key, value in data.items()}
    return [_encodable(item) for item in data] if isinstance(data, (list, tuple)) else data
