"""``sdf``: a run as a world of Gazebo, a folder with ``world.sdf`` and its meshes; needs no library.

Obstacles that moved are actors on the recorded paths, other obstacles and the map are static models; obstacles that
never came into the world are left out. Robots are models at their start with their lidars and the noise of these, and
listen for velocities on ``/model/<name>/cmd_vel``. Shapes are boxes, cylinders and meshes, 1 m high.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.sdf import SdfWorld
from irsim.common.arrays import Floats
from irsim.simulation.scene import SceneDescription

__all__ = ["FORMAT"]

_MAX_WAYPOINTS = 1000
"""Largest number of waypoints of an actor; longer paths are thinned out."""
_STILL = 1e-6
"""Obstacles that stay within this distance and angle of their start are static models [m, rad]."""


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the folder."""
    [episode] = episodes
    scene = recorded_scene(episode.run, episode.limits)
    every = max(1, math.ceil((episode.last_step + 1) / _MAX_WAYPOINTS))
    states = list(recorded_states(episode.run, every, episode.limits))
    time = np.array([state.time for state in states])
    pose = np.array([state.pose for state in states])
    episode.progress(episode.last_step + 1)
    there = np.isfinite(pose).all(axis=2).any(axis=0)
    absent = [agent.name for agent in scene.agents if not there[agent.index]]
    world = SdfWorld(scene, _paths(scene, time, pose), absent)
    text = world.write()
    (target / "meshes").mkdir()
    for file, mesh in world.meshes.items():
        (target / "meshes" / file).write_text(mesh, encoding="utf-8")
    (target / "world.sdf").write_text(text, encoding="utf-8")
    notes = ["robots stand at their start; publish velocities on /model/<name>/cmd_vel to move them"]
    if absent:
        notes.append(f"left out, as they were never in the world: {', '.join(absent[:10])}{' …' * (len(absent) > 10)}")
    if every > 1:
        notes.append(f"paths of actors have every {every}th step")
    return notes


def _paths(scene: SceneDescription, time: Floats, pose: Floats) -> dict[str, Floats]:
    """Waypoints of the obstacles that moved, where they were in the world."""
    result = {}
    for agent in scene.agents:
        own = pose[:, agent.index]
        there = np.isfinite(own).all(axis=1)
        if agent.role == "robot" or not there.any():
            continue
        if not there.all() or float(np.abs(own[there] - own[there][0]).max()) > _STILL:
            result[agent.name] = np.column_stack([time[there], own[there]])
    return result


FORMAT = Format("sdf", "-gazebo", _write, folder=True, ranges=False, scene=True)
