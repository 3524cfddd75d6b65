"""A resolved scenario and its initial scene as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel

from irsim.runs.files import record_json
from irsim.scenario.resolve.resolved import ObjectRecord

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["plain_scenario", "with_options"]

_MODELS = ("kinematics", "behavior", "group_behavior", "plot", "actuation")
_EACH = ("id", "name", "group", "group_name", "path", "index", "shape")
_LIKE = tuple(field.name for field in fields(ObjectRecord) if field.name not in (*_EACH, "state", "goals"))
_each, _like = attrgetter(*_EACH), attrgetter(*_LIKE)


def plain_scenario(simulation: Simulation, outlines: Sequence[Any]) -> bytes:
    """World and objects with all defaults, and the initial pose of each object, as JSON.

    Options that successive objects share are stored once, in ``options``; each object has the index of its options.
    Numbers that JSON lacks are the words ``Infinity``, ``-Infinity`` and ``NaN``. ``built`` has what the seed may have
    decided, one entry per object: ``outlines`` (parts in the body frame [m]; a map has only its box, as its cells are
    in a file of their own), the limits ``vel_min``, ``vel_max`` and ``acce`` of its controls, and ``start_step``, until
    which it waits.

    Args:
        simulation: The simulation, at its start.
        outlines: The outlines of its objects, from :func:`irsim.common.outline.plain_outlines`.
    """
    scenario, goals = simulation.scenario, simulation.state.goals
    objects, options, state = list[dict[str, Any]](), list[dict[str, Any]](), simulation.state
    last: tuple[Any, ...] = ()
    for row, (record, pose) in enumerate(zip(scenario.objects, simulation.pose.tolist(), strict=True)):
        like = _like(record)
        if like != last:
            last = like
            models = {key: _values(getattr(record, key)) for key in _MODELS}
            options.append(dict(zip(_LIKE, like, strict=True)) | models)
        own = dict(zip(_EACH, _each(record), strict=True))
        own["shape"] = _values(record.shape) if isinstance(record.shape, BaseModel) else record.shape.model_dump()
        objects.append({**own, "state": [*pose, *record.state[3:]], "goals": goals(row), "options": len(options) - 1})
    whole = {
        "name": scenario.name,
        # A model that was only ever read as a part of another has no serializer of its own before it is asked for one.
        "world": {**_values(scenario.world), "zones": [zone.model_dump(mode="json") for zone in scenario.world.zones]},
        "radius": simulation.radius.tolist(),
        "objects": objects,
        "options": options,
        "built": {
            "outlines": outlines,
            "vel_min": state.vel_min.tolist(),
            "vel_max": state.vel_max.tolist(),
            "acce": state.acce.tolist(),
            "start_step": state.start_step.tolist(),
        },
    }
    return record_json(whole, inf_nan_mode="strings", serialize_unknown=True)


def with_options(data: Any) -> dict[str, Any]:
    """The data of :func:`plain_scenario`, with the shared options copied into each object.

    Raises:
        TypeError: The data have another structure.
        LookupError: A part of the data is missing.
    """
    options = data["options"]
    objects = [{**options[item["options"]], **item} for item in data["objects"]]
    for item in objects:
        del item["options"]
    return {**{key: value for key, value in data.items() if key != "options"}, "objects": objects}


def _values(model: Any) -> Any:
    """Fields of a model by name; the serializer of the model would take longer than a few steps of a small world."""
    return vars(model) if isinstance(model, BaseModel) else model
