"""``nerfstudio``: cameras that look where robots go, as files of nerfstudio in the frame of the scene.

The folder has `transforms.json`, a dataset whose pictures are still to be made (`images/000120.png` of step 120), and
`camera_path.json`, the path that `ns-render camera-path` renders, at the speed of the simulation; with several robots
`camera_path_1.json` and so on belong to the other ones. It has the same options as the format `colmap`.

nerfstudio usually turns, centers and scales a scene while it trains. Paths fit a scene that was trained without:
`ns-train splatfacto nerfstudio-data --orientation-method none --center-method none --auto-scale-poses False`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path

from irsim.bridges.export.cameras import CameraOptions, camera_paths, camera_to_world, picture_names, scene_of
from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format

__all__ = ["FORMAT"]


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the dataset and the paths."""
    [episode] = episodes
    options = episode.options
    assert isinstance(options, CameraOptions)
    scene = scene_of(episode.run, options, episode.limits, "irsim")
    paths = camera_paths(episode, options.every)
    width, rows = options.width, options.rows
    upright = math.degrees(2 * math.atan(rows / 2 / options.focal))
    frames = []
    for number, (path, names) in enumerate(zip(paths, picture_names(paths), strict=True)):
        matrices = camera_to_world(path, "opengl", options.height, scene).tolist()
        frames += [
            {"file_path": f"images/{name}", "transform_matrix": matrix, "time": time}
            for name, matrix, time in zip(names, matrices, path.time.tolist(), strict=True)
        ]
        period = episode.run.step_time * options.every
        shown = {
            "camera_type": "perspective", "render_width": width, "render_height": rows, "fps": 1 / period,
            "seconds": len(matrices) * period, "smoothness_value": 0.0, "is_cycle": False, "crop": None,
            "keyframes": [],
            "camera_path": [
                {"camera_to_world": [value for row in matrix for value in row], "fov": upright, "aspect": width / rows}
                for matrix in matrices
            ],
        }  # fmt: skip
        file = target / ("camera_path.json" if number == 0 else f"camera_path_{number}.json")
        file.write_text(json.dumps(shown, allow_nan=False) + "\n", encoding="ascii")
    dataset = {
        "camera_model": "OPENCV", "w": width, "h": rows, "fl_x": options.focal, "fl_y": options.focal,
        "cx": width / 2, "cy": rows / 2, "k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0, "frames": frames,
    }  # fmt: skip
    (target / "transforms.json").write_text(json.dumps(dataset, allow_nan=False) + "\n", encoding="ascii")
    return list(scene.notes)


FORMAT = Format("nerfstudio", "-nerfstudio", _write, folder=True, ranges=False, objects="robots", options=CameraOptions)
