"""``mjcf``: the scene at the start of a run as a model of MuJoCo, with actuators for the robots; needs no library.

Walls, obstacles and the map are boxes, cylinders and prisms. Robots stand on wheels with velocity actuators, or move
along planar joints; obstacles that moved in irsim are mocap bodies. The bridge ``mujoco`` uses the same model.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.mujoco.mjcf import is_mocap, write_mjcf
from irsim.bridges.mujoco.robots import default_agents
from irsim.bridges.recorded import recorded_scene
from irsim.components.bridges.mujoco import Mujoco

__all__ = ["FORMAT"]


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the model."""
    [episode] = episodes
    scene = recorded_scene(episode.run, episode.limits)
    moved = default_agents(scene)
    target.write_text(write_mjcf(scene, moved, Mujoco()), encoding="utf-8")
    episode.progress(episode.last_step + 1)
    still = [agent.name for agent in scene.robots if agent.name not in moved]
    notes = ["the model has the start of the run; what follows from it is up to MuJoCo"]
    if still:
        notes.append(f"MuJoCo has no drive for {', '.join(still[:5])}: mocap bodies, or standing still")
    if any(is_mocap(agent, moved) for agent in scene.agents):
        notes.append("obstacles that move are mocap bodies, which stay where they are unless a program moves them")
    return notes


FORMAT = Format("mjcf", ".xml", _write, ranges=False, scene=True)
