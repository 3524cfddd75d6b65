"""A recorded run among splats: bodies of its objects, their poses, and where the scene is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from irsim.bridges.base import BridgeError
from irsim.bridges.export.cameras import CameraFrame, PoseOptions, scene_of
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.splats.splats import Singles, Splats
from irsim.common.arrays import Floats
from irsim.common.outline import Line, Outline
from irsim.runs.reading import Run, open_run
from irsim.scenario.limits import Limits
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = ["Prism", "Recording", "body_of", "body_splats", "open_recording", "path_splats"]

ROBOT_HEIGHT_M, WALKER_HEIGHT_M, THING_HEIGHT_M = 0.5, 1.7, 1.0
"""Heights that objects of the plane are shown with: robots, other objects that move, and static objects."""
_LINE_WIDTH_M = 0.06
_QUARTER = 8
"""Segments of a quarter circle of a footprint."""
_PATH_WIDTH_M = 0.035
_MAX_SPLATS = 4000
"""Splats of one body."""
_UP = np.array([1.0, 0.0, 0.0, 0.0], dtype=np.float32)


@dataclass(frozen=True)
class Prism:
    """A prism over a footprint.

    Attributes:
        name: Name of the object.
        role: ``robot`` or ``obstacle``.
        shape: Its footprint, body frame [m].
        height: [m].
        color: Red, green, blue, from 0 to 1.
    """

    name: str
    role: str
    shape: Any
    height: float
    color: tuple[float, float, float]

    @property
    def outlines(self) -> list[list[tuple[float, float]]]:
        """Closed lines around the footprint, with it to their left."""
        rings = [ring for polygon in shapely.get_parts(self.shape) for ring in (polygon.exterior, *polygon.interiors)]
        return [[(float(x), float(y)) for x, y in ring.coords] for ring in rings]


def body_of(agent: SceneObject) -> Prism | None:
    """Shape and color of an object; None if it does not stand in the world.

    Args:
        agent: The object.
    """
    parts = [
        Outline([part]).shapely(_QUARTER).buffer(_LINE_WIDTH_M / 2 if isinstance(part, Line) else 0, cap_style="flat")
        for part in (agent.parts if agent.solid else ())
    ]
    shape = shapely.orient_polygons(shapely.union_all(parts))
    if shape.is_empty or shape.area <= 0:
        return None
    height = ROBOT_HEIGHT_M if agent.role == "robot" else WALKER_HEIGHT_M if agent.moves else THING_HEIGHT_M
    return Prism(agent.name, agent.role, shape, height, agent.color)


def body_splats(body: Prism, pose: Floats) -> Splats:
    """Opaque splats on the sides and the top of a body, frame of irsim.

    Args:
        body: The body.
        pose: (3,) x, y [m], yaw [rad].
    """
    length, area = body.shape.length, body.shape.area
    spacing = max(0.02, math.sqrt((length * body.height + area) / _MAX_SPLATS))
    points, normals = [], []
    heights = np.arange(spacing / 2, body.height + spacing / 2, spacing)
    for outline in body.outlines:
        for start, end in zip(np.array(outline[:-1]), np.array(outline[1:]), strict=True):
            side = float(np.linalg.norm(end - start))
            if side <= 0:
                continue
            along = (np.arange(max(1, math.ceil(side / spacing))) + 0.5) / max(1, math.ceil(side / spacing))
            flat = start + along[:, None] * (end - start)
            points.append(np.column_stack([np.tile(flat, (len(heights), 1)), np.repeat(heights, len(flat))]))
            out = np.array([end[1] - start[1], start[0] - end[0], 0.0]) / side
            normals.append(np.tile(out, (len(points[-1]), 1)))
    low, high = np.array(body.shape.bounds[:2]), np.array(body.shape.bounds[2:])
    x, y = (np.arange(a + spacing / 2, b, spacing) for a, b in zip(low, high, strict=True))
    top = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    top = top[shapely.contains_xy(body.shape, top[:, 0], top[:, 1])]
    points.append(np.column_stack([top, np.full(len(top), body.height)]))
    normals.append(np.tile([0.0, 0.0, 1.0], (len(top), 1)))
    center, normal = np.concatenate(points), np.concatenate(normals)
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    center, normal = center @ turn.T + [pose[0], pose[1], 0], normal @ turn.T
    light = np.clip(0.62 + 0.38 * normal @ (np.array([0.35, -0.25, 0.9]) / np.linalg.norm([0.35, -0.25, 0.9])), 0, 1)
    scale = np.tile([spacing * 0.5, spacing * 0.5, 0.003], (len(center), 1))
    return _splats(center, scale, _facing(normal), light[:, None] * np.array(body.color))


def path_splats(points: Floats, color: tuple[float, float, float]) -> Splats:
    """Opaque splats along a path, a little above the ground, frame of irsim.

    Args:
        points: (K, 2) x, y [m].
        color: Red, green, blue, from 0 to 1.
    """
    points = points[np.isfinite(points).all(axis=1)]
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    kept = np.concatenate([[True], steps > 1e-9]) if len(points) else np.zeros(0, dtype=bool)
    points = points[kept]
    if len(points) < 2:
        return _splats(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4)), np.zeros((0, 3)))
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    spacing = max(_PATH_WIDTH_M * 0.7, float(length[-1]) / 20_000)
    at = np.arange(0, length[-1], spacing)
    center = np.column_stack(
        [np.interp(at, length, points[:, 0]), np.interp(at, length, points[:, 1]), 0.0 * at + 0.04]
    )
    scale = np.full((len(at), 3), max(_PATH_WIDTH_M, spacing) * 0.6)
    return _splats(center, scale, np.tile(_UP, (len(at), 1)), np.tile(color, (len(at), 1)))


def _splats(center: Floats, scale: Floats, rotation: Any, color: Floats) -> Splats:
    single: list[Singles] = [np.asarray(values, dtype=np.float32) for values in (center, scale, rotation, color)]
    return Splats(single[0], single[1], single[2], np.full(len(center), 0.98, dtype=np.float32), single[3])


def _facing(normal: Floats) -> Floats:
    """(N, 4) quaternions w, x, y, z that turn z into directions (N, 3), none of which points down."""
    half = normal + np.array([0.0, 0.0, 1.0])
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return np.column_stack([half[:, 2], -half[:, 1], half[:, 0], np.zeros(len(half))])


@dataclass(frozen=True)
class Recording:
    """The content of a picture of a run.

    Attributes:
        run: The run.
        scene: The scene of the run.
        world: Where the splats are.
        bodies: Objects that are shown.
        step: (T,) steps.
        time: (T,) simulated times [s].
        pose: (T, B, 3) x, y [m], yaw [rad] of the bodies, frame of irsim.
    """

    run: Run
    scene: SceneDescription
    world: CameraFrame
    bodies: tuple[Prism, ...]
    step: np.ndarray[tuple[int], np.dtype[np.int64]]
    time: Floats
    pose: Floats

    def index_of(self, name: str | None) -> int:
        """Number of a robot among the bodies; without a name, of the first one.

        Raises:
            BridgeError: There is no such robot.
        """
        robots = [number for number, body in enumerate(self.bodies) if body.role == "robot"]
        for number in robots:
            if name in (None, self.bodies[number].name):
                return number
        known = ", ".join(self.bodies[number].name for number in robots[:8])
        known += f" and {len(robots) - 8} more" * (len(robots) > 8)
        what = f"run {self.run.id} has no robot {name!r}" if name is not None else f"run {self.run.id} has no robot"
        raise BridgeError("bridge-mismatch", what, f"its robots are {known}" if robots else "record one with a robot")


def open_recording(
    run: str | Path | Run,
    options: PoseOptions,
    *,
    every: int,
    workspace: str | Path | None = None,
    limits: Limits | None = None,
) -> Recording:
    """Read a run for pictures.

    Args:
        run: Id of the run, its folder, or ``last``.
        options: Where the scene is.
        every: Read every such step, and the last one.
        workspace: Folder whose ``.irsim/runs`` holds the run.
        limits: Limits of the reader of the scenario.

    Raises:
        RunError: There is no such run, or it cannot be read.
        BridgeError: The sidecar of the map cannot be used.
    """
    opened = run if isinstance(run, Run) else open_run(run, workspace)
    scene = recorded_scene(opened, limits)
    result = [(number, body) for number, agent in enumerate(scene.agents) if (body := body_of(agent)) is not None]
    rows = [number for number, _ in result]
    steps, times, poses = [], [], []
    for state in recorded_states(opened, every, limits):
        steps.append(state.step)
        times.append(state.time)
        poses.append(state.pose[rows])
    return Recording(
        opened,
        scene,
        scene_of(opened, options, limits, "irsim"),
        tuple(body for _, body in result),
        np.array(steps, dtype=np.int64),
        np.array(times),
        np.array(poses).reshape(len(steps), len(rows), 3),
    )
