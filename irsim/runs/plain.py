"""A resolved scenario with the scene that was drawn, as plain data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from pydantic_core import to_json

from irsim.scenario.objects import ObjectRecord

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["plain_scenario"]

_KEYS = tuple(field.name for field in fields(ObjectRecord))
_MODELS = ("kinematics", "shape", "behavior", "group_behavior", "plot")
"""Options models: the objects of an entry have them in common, so each is put into words once."""
_OWN = tuple(key for key in _KEYS if key not in _MODELS)
_own_values = attrgetter(*_OWN)
_json: Callable[[Any], bytes] = partial(to_json, inf_nan_mode="strings", serialize_unknown=True)


def plain_scenario(simulation: Simulation) -> bytes:
    """World and objects with all defaults, and where each object starts in the scene at hand, as JSON.

    Numbers that JSON lacks are the words ``Infinity``, ``-Infinity`` and ``NaN``. Outlines of random shapes and cells
    of maps are left out: the scenario and the seed give them again.
    """
    scenario = simulation.scenario
    models: dict[int, bytes] = {}
    starts = zip(scenario.objects, simulation.pose.tolist(), strict=True)
    objects = [
        _object(record, [*pose, *record.state[3:]], simulation.state.goals(row), models)
        for row, (record, pose) in enumerate(starts)
    ]
    whole = {"name": scenario.name, "world": scenario.world, "radius": simulation.radius.tolist()}
    return b'%s,"objects":[%s]}' % (_json(whole)[:-1], b",".join(objects))


def _object(record: ObjectRecord, state: list[float], goals: Sequence[Any], models: dict[int, bytes]) -> bytes:
    """One object as JSON; ``models`` holds the words for each model, by its identity."""
    own = {**dict(zip(_OWN, _own_values(record), strict=True)), "state": state, "goals": goals}
    parts = [_json(own)[:-1]]
    for key in _MODELS:
        model = getattr(record, key)
        text = models.get(id(model))
        if text is None:
            text = models[id(model)] = _json(model)
        parts.append(b'"%s":%s' % (key.encode(), text))
    return b",".join(parts) + b"}"
