"""``poses``: lines of JSON with the camera of a robot in a world with y up, as renderers of Habitat scenes read them.

A line is `{"frame": 0, "t": 0.0, "position": [x, y, z], "yaw": 0.0, "robot": "robot"}`: the step, the simulated time
[s], the position of the camera with y up, and the angle [rad] by which a camera that looks along -z is turned about y.
With several robots their lines follow one after the other. The options are `height`, `every`, `frame` and `sidecar`, as
for the format `colmap`. The positions are in the scene that the map was imported from. A scene whose axes have
another convention than y up is turned, as files of glTF turn it: x stays, and y points up.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from irsim.bridges.export.cameras import PoseOptions, camera_paths, camera_to_world, scene_of
from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.frames import axes_of

__all__ = ["FORMAT"]

_FRAME = "habitat_yup"


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the lines."""
    [episode] = episodes
    options = episode.options
    assert isinstance(options, PoseOptions)
    scene = scene_of(episode.run, options, episode.limits, _FRAME)
    turn = axes_of(_FRAME) @ axes_of(scene.frame).T
    with target.open("w", encoding="utf-8", newline="\n") as file:
        for path in camera_paths(episode, options.every):
            matrices = camera_to_world(path, "opengl", options.height, scene)
            position = matrices[:, :3, 3] @ turn.T
            forward = -matrices[:, :3, 2] @ turn.T
            yaw = np.arctan2(-forward[:, 0], -forward[:, 2])
            for row, step in enumerate(path.step.tolist()):
                line = {
                    "frame": step,
                    "t": round(float(path.time[row]), 9),
                    "position": position[row].tolist(),
                    "yaw": float(yaw[row]),
                    "robot": path.name,
                }
                file.write(json.dumps(line, ensure_ascii=False, allow_nan=False) + "\n")
    return list(scene.notes)


FORMAT = Format("poses", ".jsonl", _write, ranges=False, objects="robots", options=PoseOptions)
