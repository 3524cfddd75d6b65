"""Reads one object from keyword arguments, as scripts add it to a running world."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from irsim.diagnostics.diagnostic import Diagnostic
from irsim.scenario.model.scenario import WorldModel
from irsim.scenario.read import or_raise, read
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["read_object"]

_ORIGIN = [0.0, 0.0, 0.0]


def read_object(
    role: Literal["robot", "obstacle"], keys: Mapping[str, Any], world: WorldModel, object_id: int
) -> tuple[ObjectRecord, list[Diagnostic]]:
    """The object that an entry with these keys makes.

    The defaults differ from an entry in a file: the object starts at the origin, has no goal and follows no
    group behavior, and a list of goals means waypoints.

    Args:
        role: Robot or obstacle.
        keys: Keys of an entry, without ``number`` and ``distribution``; arrays and tuples count as lists, None as not
            given.
        world: The world that the object joins.
        object_id: The id of the object.

    Returns:
        The object, and warnings about the keys.

    Raises:
        ScenarioError: The keys cannot be used.
    """
    entry = {key: _plain(value) for key, value in keys.items() if value is not None}
    for key in ("number", "distribution"):
        entry.pop(key, None)
    goal = entry.get("goal")
    if isinstance(goal, list) and goal and isinstance(goal[0], list) and "waypoints" not in entry:
        entry["waypoints"] = entry.pop("goal")
    has_goal = "goal" in entry or "waypoints" in entry
    entry.setdefault("state", list(_ORIGIN))
    around = {key: getattr(world, key) for key in ("width", "height", "offset", "friction", "restitution")}
    scenario, diagnostics = or_raise(read({"world": around, role: entry}, name=f"create_{role}"))
    (record,) = scenario.objects
    record = replace(
        record,
        id=object_id,
        name=record.name if entry.get("name") is not None else f"{role}_{object_id}",
        goals=record.goals if has_goal else [],
        joined=False,
    )
    return record, [item for item in diagnostics if item.severity != "hint"]


def _plain(value: Any) -> Any:
    """Arrays, tuples and queues as lists, NumPy numbers as numbers."""
    if isinstance(value, np.ndarray):
        flat = value[:, 0] if value.ndim == 2 and value.shape[1] == 1 else value
        return flat.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)) or hasattr(value, "popleft"):
        return [_plain(item) for item in value]
    return value
