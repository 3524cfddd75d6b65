"""Finds the parts of a scenario that are random."""

from __future__ import annotations

from typing import Any

from irsim.components.behaviors._options import BehaviorOptions, CustomOptions
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["random_parts"]

_SAMPLING_PLANNERS = ("rrt", "rrt_star", "informed_rrt_star", "prm")


def random_parts(scenario: ResolvedScenario) -> list[str]:
    """The parts of a run that depend on the seed, in words; empty if every seed gives the same run."""
    names: dict[str, None] = {}
    if scenario.placements:
        names["placement"] = None
    generator: Any = scenario.world.obstacle_map
    if getattr(generator, "seed", 0) is None:
        names["map"] = None
    for record in scenario.objects:
        names.update(dict.fromkeys(_of_object(record)))
    return list(names)


def _of_object(record: ObjectRecord) -> list[str]:
    shape: Any = record.shape
    drive: Any = record.kinematics
    parts = shape.parts if shape.name == "compound" else [shape]
    behaviors: list[Any] = [record.behavior, record.group_behavior]
    planners = [getattr(behavior, "planner", None) for behavior in behaviors]
    chances = {
        "shapes": any(getattr(part, "random_shape", False) for part in parts),
        "wander goals": record.wander and not record.static,
        "motion noise": getattr(drive, "noise", False) and not record.static,
        "sensor noise": any(
            getattr(sensor, "noise", False) or getattr(sensor, "velocity_noise_std", 0.0) for sensor in record.sensors
        ),
        "decisions": any(isinstance(behavior, BehaviorOptions) and behavior.draws() for behavior in behaviors)
        and not record.static,
        "planners": any(getattr(planner, "name", planner) in _SAMPLING_PLANNERS for planner in planners),
        "user code": any(isinstance(behavior, CustomOptions) for behavior in behaviors),
    }
    return [name for name, chance in chances.items() if chance] + _perturbed_parts(record)


def _perturbed_parts(record: ObjectRecord) -> list[str]:
    spreads = record.spreads
    if spreads is None:
        return []
    names = {"position": "start positions", "heading": "start headings", "speed": "speeds", "delay": "start delays"}
    return [text for key, text in names.items() if getattr(spreads, key)]
