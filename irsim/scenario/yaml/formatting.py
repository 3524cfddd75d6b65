"""Values as one would write them in YAML, for messages."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

__all__ = ["flow", "number", "shown"]

_LONGEST = 60


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


def shown(value: Any, longest: int = _LONGEST) -> str:
    """A value as it may have been written, text in quotes, cut to a readable length."""
    text = f"'{value[:longest]}'" if isinstance(value, str) else flow(_shortened(value))
    return text if len(text) <= longest else text[: longest - 1] + "…"


def _shortened(value: Any) -> Any:
    """Enough of a large value to fill the line."""
    if isinstance(value, Mapping):
        return dict(list(value.items())[:_LONGEST])
    return list(value[:_LONGEST]) if isinstance(value, (list, tuple)) else value
