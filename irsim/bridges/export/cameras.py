"""Cameras that look where robots go: what the formats ``colmap``, ``nerfstudio`` and ``poses`` share."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.frames import FrameName, camera_pose
from irsim.bridges.maps.sidecar import MapSidecar, read_sidecar, scene_transform, sidecar_path
from irsim.common.arrays import Floats
from irsim.common.text import clean
from irsim.options.base import Options
from irsim.options.units import Count, Degrees, Meters
from irsim.runs.files import RunError
from irsim.runs.reading import Run
from irsim.scenario.limits import Limits
from irsim.scenario.locate import why_outside

__all__ = [
    "CameraFrame",
    "CameraOptions",
    "CameraPath",
    "PoseOptions",
    "camera_paths",
    "camera_to_world",
    "picture_names",
    "run_sidecar",
    "scene_of",
]

_MAX_CAMERAS = 1_000_000


class PoseOptions(Options):
    """Where cameras are on robots, and in which frame."""

    height: Annotated[Meters, Field(ge=0, le=1000)] = 1.5
    """Height of the camera above the floor."""
    every: Annotated[Count, Field(ge=1)] = 1
    """A camera in every such step, beginning with the first one."""
    frame: FrameName | None = None
    """Convention of the axes of the scene, whose floor is at height 0; null is what the sidecar of the map says."""
    sidecar: str | None = None
    """File `.bridge.json` of the map that was made from the scene; null looks beside the scenario and its map."""


class CameraOptions(PoseOptions):
    """Cameras on robots, and their pictures."""

    width: Annotated[Count, Field(ge=1, le=65536)] = 1280
    """Pixels of a picture from left to right."""
    rows: Annotated[Count, Field(ge=1, le=65536)] = 720
    """Pixels of a picture from top to bottom."""
    fov: Annotated[Degrees, Field(gt=0, lt=180)] = 70.0
    """Angle that a picture covers from left to right."""

    @property
    def focal(self) -> float:
        """Focal length [px]."""
        return self.width / 2 / math.tan(math.radians(self.fov) / 2)


@dataclass(frozen=True)
class CameraFrame:
    """The world in which the cameras are.

    Attributes:
        transform: (4, 4) ``T_scene_from_irsim``.
        frame: Convention of its axes.
        notes: Remarks for the user.
    """

    transform: Floats
    frame: str
    notes: tuple[str, ...] = ()

    @property
    def scale(self) -> float:
        """Units of length of the scene in a metre."""
        return float(np.cbrt(abs(np.linalg.det(self.transform[:3, :3]))))


@dataclass(frozen=True)
class CameraPath:
    """The cameras of one robot.

    Attributes:
        name: Name of the robot.
        step: (T,) steps.
        time: (T,) simulated times [s].
        pose: (T, 3) x, y [m], yaw [rad], frame of irsim.
    """

    name: str
    step: np.ndarray[tuple[int], np.dtype[np.int64]]
    time: Floats
    pose: Floats


def scene_of(run: Run, options: PoseOptions, limits: Limits | None, default: str) -> CameraFrame:
    """The world of the cameras: the one that the map of the scenario was imported from, if there is one.

    Args:
        run: The run.
        options: The user's choices.
        limits: Limits of the reader of the scenario.
        default: Convention of the axes without a sidecar.

    Raises:
        RunError: Both a frame and a sidecar are given, or the sidecar lies outside the folder of the limits.
        BridgeError: The sidecar cannot be used.
    """
    if options.frame is not None:
        if options.sidecar is not None:
            what = "both frame and sidecar are given"
            raise RunError("bad-argument", what, "give one of them: the sidecar says the frame", where="options")
        return CameraFrame(scene_transform(options.frame), options.frame)
    if options.sidecar is not None:
        if limits is not None and limits.root is not None:
            wrong = why_outside(options.sidecar, Path(limits.root))
            if wrong is not None:
                what = f"the sidecar '{clean(options.sidecar, 200)}' {wrong}"
                raise RunError("path-outside-workspace", what, "give a file inside the workspace", where="options")
            result: MapSidecar | None = read_sidecar(Path(limits.root) / options.sidecar)
        else:
            result = read_sidecar(options.sidecar)
    else:
        result = run_sidecar(run, limits)
    if result is None:
        note = f"the map of the run has no sidecar: cameras are in the frame {default}, whose floor is at height 0"
        return CameraFrame(scene_transform(default), default, (note,))
    return CameraFrame(result.T_scene_from_irsim, result.frame)


def run_sidecar(run: Run, limits: Limits | None = None) -> MapSidecar | None:
    """The sidecar beside the scenario of a run, or beside the map of the scenario; None without a sidecar.

    Raises:
        BridgeError: The sidecar cannot be used.
    """
    scenario, folder = run.meta.get("scenario"), run.meta.get("folder")
    home = Path(folder) if isinstance(folder, str) else None
    if limits is not None and limits.root is not None:
        if not isinstance(scenario, str):
            return None
        home = (Path(limits.root) / scenario).parent
        if not home.resolve().is_relative_to(Path(limits.root).resolve()):
            return None
    if home is None:
        return None
    names = [Path(scenario).name] if isinstance(scenario, str) else []
    names += [str(entry[0]) for entry in run.meta.get("maps", []) if isinstance(entry, list) and entry]
    for name in names:
        path = sidecar_path(home / name)
        inside = limits is None or limits.root is None or path.resolve().is_relative_to(Path(limits.root).resolve())
        if inside and path.is_file():
            return read_sidecar(path)
    return None


def camera_paths(episode: ExportedEpisode, every: int) -> list[CameraPath]:
    """The chosen objects of a run as carriers of cameras, each in the steps in which it is in the world.

    Raises:
        RunError: There would be too many cameras, or no camera.
    """
    count = (episode.last_step // every + 1) * len(episode.actors)
    if count > _MAX_CAMERAS:
        what = f"there would be {count:,} cameras; at most {_MAX_CAMERAS:,} are written"
        raise RunError("bad-argument", what, "give a larger every, or choose fewer objects", where="options")
    steps, times, poses = [], [], []
    for trace in (block.trace for block in episode.blocks(scans=False)):
        chosen = trace.step % every == 0
        steps.append(trace.step[chosen])
        times.append(trace.time[chosen])
        poses.append(trace.pose[chosen])
    step, time, pose = np.concatenate(steps), np.concatenate(times), np.concatenate(poses)
    result = []
    for row, actor in enumerate(episode.actors):
        there = np.isfinite(pose[:, row]).all(axis=1)
        if there.any():
            result.append(CameraPath(actor.name, step[there], time[there], pose[there, row]))
    if not result:
        what = "none of the chosen objects is in the world in any of the chosen steps"
        raise RunError("bad-argument", what, "choose other objects, or a smaller every", where="objects")
    return result


def camera_to_world(path: CameraPath, axes: str, height: float, scene: CameraFrame) -> Floats:
    """(T, 4, 4) rigid camera-to-world matrices in the scene; positions are in its unit of length.

    Args:
        path: Poses of the robot.
        axes: Axes of a camera, ``opengl`` or ``colmap``.
        height: Height of the camera above the floor [m].
        scene: The world.
    """
    result = camera_pose(path.pose, axes, height, transform=scene.transform)
    result[:, :3, :3] /= scene.scale
    return result


def picture_names(paths: list[CameraPath]) -> Iterator[list[str]]:
    """Names of the pictures of each robot: ``<robot>/<step>.png``, or ``<step>.png`` of a single one."""
    for number, path in enumerate(paths):
        safe = "".join(letter if letter.isalnum() and letter.isascii() else "_" for letter in path.name)[:40]
        folder = "" if len(paths) == 1 else f"{number:03d}_{safe}/"
        yield [f"{folder}{step:06d}.png" for step in path.step.tolist()]
