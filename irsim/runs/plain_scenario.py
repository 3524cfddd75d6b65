"""A resolved scenario with the scene that was drawn, as plain data."""

from __future__ import annotations

from dataclasses import fields
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel
from pydantic_core import to_json

from irsim.scenario.resolve.resolved import ObjectRecord

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["plain_scenario", "with_options"]

_MODELS = ("kinematics", "behavior", "group_behavior", "plot")
_EACH = ("id", "name", "group", "group_name", "path", "index", "shape")
_LIKE = tuple(field.name for field in fields(ObjectRecord) if field.name not in (*_EACH, "state", "goals"))
_each, _like = attrgetter(*_EACH), attrgetter(*_LIKE)


def plain_scenario(simulation: Simulation) -> bytes:
    """World and objects with all defaults, and where each object starts in the scene at hand, as JSON.

    What objects have in common stands once, in ``options``, and each object says which of these it has. Numbers that
    JSON lacks are the words ``Infinity``, ``-Infinity`` and ``NaN``. Outlines of random shapes and cells of maps are
    left out: the scenario and the seed give them again.
    """
    scenario, goals = simulation.scenario, simulation.state.goals
    objects, options = list[dict[str, Any]](), list[dict[str, Any]]()
    last: tuple[Any, ...] = ()
    for row, (record, pose) in enumerate(zip(scenario.objects, simulation.pose.tolist(), strict=True)):
        like = _like(record)
        if like != last:
            last = like
            models = {key: _values(getattr(record, key)) for key in _MODELS}
            options.append(dict(zip(_LIKE, like, strict=True)) | models)
        own = dict(zip(_EACH, _each(record), strict=True))
        own["shape"] = _values(record.shape)
        objects.append({**own, "state": [*pose, *record.state[3:]], "goals": goals(row), "options": len(options) - 1})
    whole = {
        "name": scenario.name,
        "world": _values(scenario.world),
        "radius": simulation.radius.tolist(),
        "objects": objects,
        "options": options,
    }
    return to_json(whole, inf_nan_mode="strings", serialize_unknown=True)


def with_options(data: Any) -> dict[str, Any]:
    """What :func:`plain_scenario` tells, read and with its options in each object.

    Raises:
        TypeError: It is something else.
        LookupError: It lacks a part.
    """
    options = data["options"]
    objects = [{**options[item["options"]], **item} for item in data["objects"]]
    for item in objects:
        del item["options"]
    return {**{key: value for key, value in data.items() if key != "options"}, "objects": objects}


def _values(model: Any) -> Any:
    """Fields of a model by their names: its own way to JSON looks up each serializer, which a short run would feel."""
    return vars(model) if isinstance(model, BaseModel) else model
