"""Texts of JSON that irsim writes, also with names of files that cannot be decoded: on Linux they may be any bytes."""

from __future__ import annotations

from typing import Any

__all__ = ["encodable"]


def encodable(data: Any) -> Any:
    r"""Plain data whose texts can be encoded: bytes in names that are not UTF-8 are written as ``\udcff``."""
    if isinstance(data, str):
        return data.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(data, dict):
        return {encodable(key): encodable(value) for key, value in data.items()}
    return [encodable(item) for item in data] if isinstance(data, (list, tuple)) else data
