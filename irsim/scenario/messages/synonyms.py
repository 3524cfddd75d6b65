"""Advice on common keys that the language lacks and that need more than a new name, such as ``diameter``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.messages.findings import key_path
from irsim.scenario.model.lookup import at
from irsim.scenario.yaml.formatting import flow

__all__ = ["advice_on_key", "vector_of"]

_HEADINGS = ("theta", "yaw", "heading", "angle", "orientation")
_HEADING_TOLERANCES = tuple(
    f"{what}_{last}"
    for what in ("goal_angle", "goal_heading", "goal_yaw", "goal_theta", "heading", "yaw", "theta", "yaw_goal")
    for last in ("threshold", "tolerance")
)
_SIDES = ("size", "dimensions", "extent")


def advice_on_key(path: Path, data: Any) -> tuple[str | None, str | None]:
    """What to write instead of an unknown key, in words, and the key to rename it to if that may be what was meant.

    Args:
        path: Path of the unknown key.
        data: The whole document.
    """
    key, parent, value = str(path[-1]).lower(), at(data, path[:-1]), at(data, path)
    if not isinstance(parent, Mapping):
        return None, None
    where = key_path(path[:-1])
    if where == "world":
        return (_sides(value, "width", "height"), None) if key in _SIDES else (None, None)
    if where == "entry":
        return _of_entry(key, value, parent), None
    if where in ("entry.shape", "entry.shape.parts"):
        return _of_shape(key, value, parent)
    return None, None


def vector_of(value: Any) -> list[float] | None:
    """The vector that a mapping such as ``{x: 9, y: 5}`` means; None for any other value."""
    if not isinstance(value, Mapping) or not {"x", "y"} <= set(value):
        return None
    heading = [key for key in value if key in _HEADINGS]
    numbers = [value["x"], value["y"], *(value[key] for key in heading[:1])]
    return numbers if len(numbers) == len(value) and is_vector(numbers) else None


def _of_entry(key: str, value: Any, parent: Mapping[Any, Any]) -> str | None:
    if key in ("x", "y") or key in _HEADINGS:
        pose = _pose(key, value, parent)
        return f"it belongs in 'state', which is [x, y, theta]: {pose}"
    if key in _HEADING_TOLERANCES:
        return "see arrive_mode: state: the heading counts, and goal_threshold holds for metres and radians together"
    if key in ("radius", "diameter"):
        return f"it belongs in 'shape': {{name: circle, radius: {_half(value) if key == 'diameter' else _text(value)}}}"
    if key in ("length", "width"):
        sides = (_text(parent.get("length")), _text(parent.get("width")))
        return f"it belongs in 'shape': {{name: rectangle, length: {sides[0]}, width: {sides[1]}}}"
    return None


def _pose(key: str, value: Any, parent: Mapping[Any, Any]) -> str:
    """The state given by the keys of an entry; a missing coordinate stays a letter."""
    known: dict[str, Any] = dict(zip(("x", "y", "theta"), ("x", "y", 0), strict=True))
    written: Any = next((parent[name] for name in ("state", "pose", "position", "start") if name in parent), None)
    if is_vector(written):
        known.update(zip(known, written, strict=False))
    known.update({name: parent[name] for name in ("x", "y") if _is_number(parent.get(name))})
    if key in _HEADINGS and _is_number(value):
        known["theta"] = round(math.radians(value), 4) if abs(value) > 2 * math.pi else value
    return f"state: {flow(list(known.values()))}"


def _of_shape(key: str, value: Any, parent: Mapping[Any, Any]) -> tuple[str | None, str | None]:
    if key == "diameter":
        return f"write half of it as the radius: 'radius: {_half(value)}'", None
    if str(parent.get("name")).lower() != "rectangle":
        return None, None
    if key in _SIDES:
        return _sides(value, "length", "width"), None
    if key in ("height", "depth", "breadth"):
        other = "width" if "length" in parent else "length"
        if other in parent:
            return None, None
        return f"rename it to '{other}': 'length' is along the heading (x where it is 0), 'width' across", other
    return None, None


def _sides(value: Any, first: str, second: str) -> str:
    if isinstance(value, (list, tuple)) and len(value) == 2 and is_vector(value):
        return f"write '{first}: {flow(value[0])}' and '{second}: {flow(value[1])}'"
    return f"write '{first}' and '{second}'"


def _half(value: Any) -> str:
    return flow(value / 2) if _is_number(value) else "..."


def _text(value: Any) -> str:
    return flow(value) if _is_number(value) else "..."


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
