"""Formats values as YAML text, for messages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

__all__ = ["flow", "number", "quote_value"]

_MAX_CHARACTERS = 60
"""Length of a value in a message."""


def flow(value: Any) -> str:
    """A value as one line of YAML: ``{name: circle, center: [0, 1.5]}``."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(flow(item) for item in value) + "]"
    if value is None:
        return "null"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return number(value)
    return str(value)


def number(value: float) -> str:
    """A number without needless digits, never in a form that YAML 1.1 reads as text."""
    if isinstance(value, int):
        return str(value)
    if not math.isfinite(value):
        return ".nan" if math.isnan(value) else "-.inf" if value < 0 else ".inf"
    if abs(value) < 1e15 and value == int(value):
        return str(int(value))
    text = f"{value:.10g}"
    return text if "e" not in text or "." in text else text.replace("e", ".0e")


def quote_value(value: Any, longest: int = _MAX_CHARACTERS) -> str:
    """A value as in YAML, text in single quotes, cut to ``longest`` characters."""
    text = f"'{value[:longest]}'" if isinstance(value, str) else flow(_shorten(value))
    return text if len(text) <= longest else text[: longest - 1] + "…"


def _shorten(value: Any) -> Any:
    """The first elements of a large value: more would not fit into a message."""
    if isinstance(value, Mapping):
        return dict(list(value.items())[:_MAX_CHARACTERS])
    return list(value[:_MAX_CHARACTERS]) if isinstance(value, (list, tuple)) else value
