"""A resolved scenario with the scene that was drawn, as plain data."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from pydantic_core import to_json

if TYPE_CHECKING:
    from irsim.simulation import Simulation

__all__ = ["plain_scenario"]


def plain_scenario(simulation: Simulation) -> bytes:
    """World and objects with all defaults, and where each object starts in the scene at hand, as JSON.

    Numbers that JSON lacks are the words ``Infinity``, ``-Infinity`` and ``NaN``. Outlines of random shapes and cells
    of maps are left out: the scenario and the seed give them again.
    """
    scenario = simulation.scenario
    objects = [
        replace(
            record,
            state=[*simulation.pose[row].tolist(), *record.state[3:]],
            goals=[list(goal) for goal in simulation.state.goals(row)],
        )
        for row, record in enumerate(scenario.objects)
    ]
    data = {"name": scenario.name, "world": scenario.world, "objects": objects, "radius": simulation.radius.tolist()}
    return to_json(data, inf_nan_mode="strings", serialize_unknown=True)
