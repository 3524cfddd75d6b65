"""What the sensors of an object are, in words, and whom the beams of its lidars hit at the start."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import irsim._core as core
from irsim.episodes.scene_summary import called
from irsim.results.scene import LidarHits
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.simulation.build import build_world

__all__ = ["MAX_LIDARS", "lidar_hits", "sensors_in_words"]

MAX_LIDARS = 6
"""Number of lidars whose beams are counted."""
_MAX_BEAMS = 200_000
"""Number of beams of a scenario beyond which none are counted."""


def sensors_in_words(sensors: Sequence[Any]) -> list[str]:
    """Describe sensors: ``fmcw_lidar2d 120 deg, 10 m, 241 beams, motion_compensate, velocity noise 0.05``."""
    return [_sensor(sensor) for sensor in sensors]


def _sensor(sensor: Any) -> str:
    if not getattr(sensor, "is_lidar", False):
        return str(sensor.name)
    facts = [f"{sensor.name} {np.degrees(sensor.angle_range):.3g} deg", f"{sensor.range_max:g} m"]
    facts.append(f"{sensor.number} beam{'s' * (sensor.number != 1)}")
    if getattr(sensor, "motion_compensate", False):
        facts.append("motion_compensate")
    if sensor.noise:
        facts.append(f"range noise {sensor.std:g}")
    if getattr(sensor, "velocity_noise_std", 0.0):
        facts.append(f"velocity noise {sensor.velocity_noise_std:g}")
    return ", ".join(facts)


def lidar_hits(scenario: ResolvedScenario, seed: int) -> list[LidarHits]:
    """Count the beams of the first lidars that hit each object at the start; empty if there are very many beams.

    Args:
        scenario: The scenario, in which there is room for every object.
        seed: Seed of the places.
    """
    carriers = [k for k, record in enumerate(scenario.objects) if _lidars(record.sensors)][:MAX_LIDARS]
    records = [
        replace(
            record, sensors=_lidars(record.sensors)[:1] if k in carriers else [], behavior=None, group_behavior=None
        )
        for k, record in enumerate(scenario.objects)
    ]
    if not carriers or sum(sensor.number for record in records for sensor in _lidars(record.sensors)) > _MAX_BEAMS:
        return []
    world = scenario.world.model_copy(update={"fog_map": False})
    built = build_world(replace(scenario, objects=records, world=world), 1)
    state = core.State(built, np.array([seed], dtype=np.uint64), False)
    state.look()
    found = []
    for row, first, count in built.scans():
        hits = Counter(state.hits[first : first + count].tolist())
        missed = hits.pop(-1, 0)
        names = [(called(scenario, scenario.objects[k].name).strip("'"), beams) for k, beams in hits.most_common()]
        found.append(LidarHits(name=records[row].name, beams=count, hit=count - missed, hits=dict(names)))
    return found


def _lidars(sensors: Iterable[Any]) -> list[Any]:
    return [sensor for sensor in sensors if getattr(sensor, "is_lidar", False)]
