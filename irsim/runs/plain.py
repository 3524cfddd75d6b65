"""A resolved scenario with the scene that was drawn, as plain data."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

if TYPE_CHECKING:
    from irsim.scenario.objects import ObjectRecord
    from irsim.simulation import Simulation

__all__ = ["plain_scenario"]


def plain_scenario(simulation: Simulation) -> dict[str, Any]:
    """World and objects with all defaults, and where each object starts in the scene at hand; JSON-able.

    Numbers that JSON lacks are the words ``inf``, ``-inf`` and ``nan``. Outlines of random shapes and cells of maps are
    left out: the scenario and the seed give them again.
    """
    scenario = simulation.scenario
    objects = []
    for row, record in enumerate(scenario.objects):
        data = _record(record)
        data["state"] = [*simulation.pose[row].tolist(), *record.state[3:]]
        data["radius"] = float(simulation.radius[row])
        goals = simulation.state.goals(row)
        data["goals"] = [list(goal) for goal in goals]
        objects.append(data)
    return {"name": scenario.name, "world": _plain(scenario.world), "objects": _plain(objects)}


def _record(record: ObjectRecord) -> dict[str, Any]:
    return {entry.name: getattr(record, entry.name) for entry in fields(record)}


def _plain(value: Any) -> Any:
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, BaseModel):
        return {name: _plain(getattr(value, name)) for name in type(value).model_fields}
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    return str(value)
