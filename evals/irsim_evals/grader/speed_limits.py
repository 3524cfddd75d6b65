"""A scenario in which some bodies may go faster or slower than its file says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from irsim_evals.grader.material import Material

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["with_speeds"]


def with_speeds(
    scenario: ResolvedScenario, material: Material, seed: int, factors: Mapping[str, float]
) -> ResolvedScenario:
    """A scenario with other speed limits.

    Args:
        scenario: The scenario, perhaps with another behavior than that of the answer.
        material: The answer.
        seed: Seed of the world in which the bodies are selected.
        factors: Name of a selection → factor of every limit of its bodies.
    """
    for name, factor in factors.items():
        chosen = {body.index for body in material.bodies(material.scene(seed), name)}
        objects = [
            replace(record, vel_min=[v * factor for v in record.vel_min], vel_max=[v * factor for v in record.vel_max])
            if row in chosen
            else record
            for row, record in enumerate(scenario.objects)
        ]
        scenario = replace(scenario, objects=objects)
    return scenario
