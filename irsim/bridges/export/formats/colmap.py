"""``colmap``: cameras that look where robots go, as a text model of COLMAP in the frame of the scene.

The folder has `cameras.txt` (one pinhole camera), `images.txt` (world-to-camera pose of each picture) and an empty
`points3D.txt`. A picture is named after its step, `000120.png`; with several robots it lies in a folder for each. The
options `height`, `every`, `width`, `rows` and `fov` say where cameras are and what they see. The scene is the one that
the map of the scenario was imported from, as its sidecar says; `sidecar` names another, `frame` does without.

    irsim export last --to colmap -o cameras --set every=5 --set height=1.2
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from irsim.bridges.export.cameras import (
    CameraFrame,
    CameraOptions,
    CameraPath,
    camera_paths,
    camera_to_world,
    picture_names,
    scene_of,
)
from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.frames import inverse, quaternion_of

__all__ = ["FORMAT"]


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the three files."""
    [episode] = episodes
    options = episode.options
    assert isinstance(options, CameraOptions)
    scene = scene_of(episode.run, options, episode.limits, "irsim")
    focal, size = options.focal, (options.width, options.rows)
    pinhole = f"1 PINHOLE {size[0]} {size[1]} {focal!r} {focal!r} {size[0] / 2!r} {size[1] / 2!r}\n"
    (target / "cameras.txt").write_text("# CAMERA_ID MODEL WIDTH HEIGHT FX FY CX CY\n" + pinhole, encoding="ascii")
    with (target / "images.txt").open("w", encoding="ascii", newline="\n") as file:
        file.write("# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then a line of points\n")
        file.writelines(_images(camera_paths(episode, options.every), options, scene))
    (target / "points3D.txt").write_text("# no points\n", encoding="ascii")
    return list(scene.notes)


def _images(paths: list[CameraPath], options: CameraOptions, scene: CameraFrame) -> Iterator[str]:
    """Yield the lines of the pictures."""
    number = 0
    for path, names in zip(paths, picture_names(paths), strict=True):
        view = inverse(camera_to_world(path, "colmap", options.height, scene))
        turned = np.roll(quaternion_of(view[:, :3, :3]), 1, axis=1)
        for quaternion, shift, name in zip(turned.tolist(), view[:, :3, 3].tolist(), names, strict=True):
            number += 1
            yield " ".join([str(number), *map(repr, [*quaternion, *shift]), "1", name]) + "\n\n"


FORMAT = Format("colmap", "-colmap", _write, folder=True, ranges=False, objects="robots", options=CameraOptions)
