"""A resolved scenario with the scene that was drawn, as plain data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel
from pydantic_core import to_json

from irsim.scenario.objects import ObjectRecord

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["plain_scenario"]

_MODELS = ("kinematics", "shape", "behavior", "group_behavior", "plot")
"""Options models: the objects of an entry have them in common, so each is put into words once."""
_EACH = ("id", "name", "group", "group_name", "path", "index")
_LIKE = tuple(field.name for field in fields(ObjectRecord) if field.name not in (*_MODELS, *_EACH, "state", "goals"))
_OBJECT = b"%%b,%%b%b}" % b"".join(b',"%b":%%b' % key.encode() for key in _MODELS)
_each, _like, _models = attrgetter(*_EACH), attrgetter(*_LIKE), attrgetter(*_MODELS)
_json: Callable[[Any], bytes] = partial(to_json, inf_nan_mode="strings", serialize_unknown=True)


def plain_scenario(simulation: Simulation) -> bytes:
    """World and objects with all defaults, and where each object starts in the scene at hand, as JSON.

    Numbers that JSON lacks are the words ``Infinity``, ``-Infinity`` and ``NaN``. Outlines of random shapes and cells
    of maps are left out: the scenario and the seed give them again.
    """
    scenario, goals = simulation.scenario, simulation.state.goals
    told: dict[int, bytes] = {}  # by identity of the model
    objects = []
    last, rest = None, b""
    for row, (record, pose) in enumerate(zip(scenario.objects, simulation.pose.tolist(), strict=True)):
        own = dict(zip(_EACH, _each(record), strict=True))
        own["state"], own["goals"] = [*pose, *record.state[3:]], goals(row)
        like = _like(record)
        if like != last:
            last, rest = like, _json(dict(zip(_LIKE, like, strict=True)))[1:-1]
        models = _models(record)
        for model in models:
            if id(model) not in told:
                told[id(model)] = _json(_values(model))
        objects.append(_OBJECT % (_json(own)[:-1], rest, *[told[id(model)] for model in models]))
    whole = {"name": scenario.name, "world": _values(scenario.world), "radius": simulation.radius.tolist()}
    return b'%b,"objects":[%b]}' % (_json(whole)[:-1], b",".join(objects))


def _values(model: Any) -> Any:
    """Fields of a model by their names: its own way to JSON looks up each serializer, which a short run would feel."""
    return vars(model) if isinstance(model, BaseModel) else model
