"""A scene as a stage of OpenUSD: z up, metres, static things as solids, what moves as prims with a child ``body``.

- ``/World/Ground``, ``/World/Map``, ``/World/Obstacles/<name>``: static, with collisions
- ``/World/Robots/<name>``, ``/World/Pedestrians/<name>``: kinematic rigid bodies, moved by ``xformOp:translate`` and
  ``xformOp:rotateZ``; their child ``body`` holds what is seen and can be exchanged for a character
- ``/World/Cameras``, ``/World/Lights``, ``/World/Looks``, ``/World/Physics``

A prim of an object has its index and name as custom data ``irsim:id`` and ``irsim:name``. Discs collide
as cylinders, convex solids as their hulls, others as a convex decomposition, and the map with its triangles.
"""

# ruff: noqa: E402  # the library is asked for first
from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.bridges.state import WorldState
from irsim.bridges.usd.solids import (
    Solid,
    arrow,
    disc_solid,
    grid_solid,
    line_solid,
    plane,
    polygon_solid,
    prim_names,
)
from irsim.common.angles import wrap
from irsim.common.arrays import Floats
from irsim.common.extras import require
from irsim.common.outline import Circle, Line
from irsim.simulation.scene import SceneDescription, SceneObject

require("usd", "pxr")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade, Vt

__all__ = ["Heights", "Mover", "animate", "author_scene", "new_stage", "paint"]

_ROUGHNESS = 0.6


def paint(stage: Any, prim: Any, color: tuple[float, float, float]) -> None:
    """Give a prim a color, as ``displayColor`` and as a material under ``/World/Looks``.

    Args:
        stage: The stage.
        prim: A mesh or another solid.
        color: Red, green, blue, from 0 to 1, as on a screen (sRGB).
    """
    linear = Gf.Vec3f(*(_linear(min(1.0, max(0.0, part))) for part in color))
    UsdGeom.Gprim(prim).CreateDisplayColorAttr(Vt.Vec3fArray([linear]))
    name = "color_" + "".join(f"{round(255 * min(1.0, max(0.0, part))):02x}" for part in color)
    UsdGeom.Scope.Define(stage, "/World/Looks")
    path = f"/World/Looks/{name}"
    made = stage.GetPrimAtPath(path)
    material = UsdShade.Material(made) if made else UsdShade.Material.Define(stage, path)
    if not made:
        shader = UsdShade.Shader.Define(stage, f"{path}/surface")
        shader.CreateIdAttr("UsdPreviewSurface")
        shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(linear)
        shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(_ROUGHNESS)
        shader.CreateOutput("surface", Sdf.ValueTypeNames.Token)
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)


def _linear(part: float) -> float:
    """A part of a color without the gamma of sRGB, as OpenUSD has it (IEC 61966-2-1)."""
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


_GROUND_COLOR = (0.78, 0.78, 0.76)
_MAP_COLOR = (0.35, 0.37, 0.4)
_ARROW_COLOR = (0.95, 0.95, 0.95)
_MARGIN = 1.0
"""Width of the ground around the world [m]."""


@dataclass(frozen=True)
class Heights:
    """Heights of what the plane does not give [m].

    Attributes:
        obstacle: Static obstacles, walls and the map.
        robot: Robots.
        pedestrian: Obstacles that move.
    """

    obstacle: float = 1.0
    robot: float = 0.5
    pedestrian: float = 1.75


@dataclass(frozen=True)
class Mover:
    """An object that moves in a stage.

    Attributes:
        index: Its row in states.
        name: Its name.
        path: Path of its prim.
    """

    index: int
    name: str
    path: str


def new_stage(scene: SceneDescription) -> Any:
    """An empty stage in memory with units, axes and clock: one time code is one step."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdPhysics.SetStageKilogramsPerUnit(stage, 1.0)
    rate = 1.0 / scene.step_time
    stage.SetTimeCodesPerSecond(rate)
    stage.SetFramesPerSecond(rate)
    world = UsdGeom.Xform.Define(stage, "/World")
    stage.SetDefaultPrim(world.GetPrim())
    stage.GetRootLayer().customLayerData = {
        "irsim": {"scene": scene.name, "seed": str(scene.seed), "step_time": scene.step_time, "version": scene.version}
    }
    physics = UsdPhysics.Scene.Define(stage, "/World/Physics")
    physics.CreateGravityDirectionAttr(Gf.Vec3f(0, 0, -1))
    physics.CreateGravityMagnitudeAttr(9.81)
    return stage


def author_scene(stage: Any, scene: SceneDescription, heights: Heights | None = None) -> list[Mover]:
    """Write the scene at its start, and return the objects that can move.

    Args:
        stage: The stage from :func:`new_stage`.
        scene: The scene.
        heights: Heights of solids.
    """
    heights = heights or Heights()
    _mesh(stage, "/World/Ground", _ground(scene), _GROUND_COLOR, solid=True, approximation="none")
    solid = None if scene.grid is None else grid_solid(scene.grid, heights.obstacle)
    if solid is not None:
        _mesh(stage, "/World/Map", solid, _MAP_COLOR, solid=True, approximation="none")
    movers: list[Mover] = []
    for agent, name in zip(scene.agents, prim_names(scene.names), strict=True):
        room = "Robots" if agent.role == "robot" else "Pedestrians" if agent.moves else "Obstacles"
        UsdGeom.Scope.Define(stage, f"/World/{room}")
        path = f"/World/{room}/{name}"
        pushable = math.isfinite(agent.mass)
        if room == "Obstacles":
            _author_agent(stage, path, agent, heights.obstacle, rigid=pushable)
            if pushable:
                movers.append(Mover(agent.index, agent.name, path))
            continue
        _author_agent(stage, path, agent, heights.robot if room == "Robots" else heights.pedestrian, rigid=True)
        movers.append(Mover(agent.index, agent.name, path))
    _author_lights(stage)
    _author_cameras(stage, scene)
    return movers


def _ground(scene: SceneDescription) -> Solid:
    low = scene.low[0] - _MARGIN, scene.low[1] - _MARGIN
    return plane(low, (scene.high[0] + _MARGIN, scene.high[1] + _MARGIN))


def _author_agent(stage: Any, path: str, agent: SceneObject, height: float, *, rigid: bool) -> None:
    """Write one object at its start: its place, and its body as a child."""
    placed = UsdGeom.Xform.Define(stage, path)
    prim = placed.GetPrim()
    prim.SetCustomDataByKey("irsim:id", agent.index)
    prim.SetCustomDataByKey("irsim:name", agent.name)
    x, y, yaw = agent.pose
    placed.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(x, y, 0.0))
    placed.AddRotateZOp(UsdGeom.XformOp.PrecisionDouble).Set(math.degrees(yaw))
    if rigid:
        UsdPhysics.RigidBodyAPI.Apply(prim).CreateKinematicEnabledAttr(True)
    body = UsdGeom.Xform.Define(stage, f"{path}/body").GetPath()
    for number, part in enumerate(agent.parts):
        below = f"{body}/part_{number}"
        if isinstance(part, Circle):
            _disc(stage, below, part, height, agent)
            continue
        solid = line_solid(part, height) if isinstance(part, Line) else polygon_solid(part, height)
        if solid is not None:
            approximation = "convexHull" if solid.convex else "convexDecomposition"
            _mesh(stage, below, solid, agent.color, solid=agent.solid, approximation=approximation)
    if agent.role == "robot" or agent.moves:
        wedge = arrow(max(agent.radius, 0.05), height, height + 0.02)
        _mesh(stage, f"{body}/front", wedge, _ARROW_COLOR, solid=False)


def _disc(stage: Any, path: str, circle: Circle, height: float, agent: SceneObject) -> None:
    """Write a disc: a mesh that is seen, and a hidden cylinder that collides, which is rounder than the mesh."""
    _mesh(stage, path, disc_solid(circle, height), agent.color, solid=False)
    if not agent.solid:
        return
    radius, half = circle.radius, height / 2
    hull = UsdGeom.Cylinder.Define(stage, f"{path}_collision")
    hull.CreateAxisAttr(UsdGeom.Tokens.z)
    hull.CreateRadiusAttr(radius)
    hull.CreateHeightAttr(height)
    hull.CreateExtentAttr(Vt.Vec3fArray([Gf.Vec3f(-radius, -radius, -half), Gf.Vec3f(radius, radius, half)]))
    hull.CreatePurposeAttr(UsdGeom.Tokens.guide)
    hull.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*circle.center, half))
    UsdPhysics.CollisionAPI.Apply(hull.GetPrim())


def _mesh(
    stage: Any, path: str, shape: Solid, color: tuple[float, float, float], *, solid: bool, approximation: str = "none"
) -> None:
    """Write a mesh with flat faces; ``solid`` says whether it collides."""
    points = shape.points.astype(np.float32)
    drawn = UsdGeom.Mesh.Define(stage, path)
    drawn.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    drawn.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(shape.counts.astype(np.int32)))
    drawn.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(shape.indices.astype(np.int32)))
    drawn.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(shape.normals.astype(np.float32)))
    drawn.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    drawn.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    drawn.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(axis=0), points.max(axis=0)])))
    paint(stage, drawn.GetPrim(), color)
    if solid:
        UsdPhysics.CollisionAPI.Apply(drawn.GetPrim())
        UsdPhysics.MeshCollisionAPI.Apply(drawn.GetPrim()).CreateApproximationAttr(approximation)


def _author_lights(stage: Any) -> None:
    UsdGeom.Scope.Define(stage, "/World/Lights")
    sun = UsdLux.DistantLight.Define(stage, "/World/Lights/Sun")
    sun.CreateIntensityAttr(2500.0)
    sun.CreateAngleAttr(0.53)
    sun.AddRotateXYZOp().Set(Gf.Vec3f(35.0, 20.0, 0.0))
    UsdLux.DomeLight.Define(stage, "/World/Lights/Sky").CreateIntensityAttr(400.0)


def _author_cameras(stage: Any, scene: SceneDescription) -> None:
    """A camera that looks down at the whole world, and one that looks at it from the front."""
    UsdGeom.Scope.Define(stage, "/World/Cameras")
    low, high = np.array(scene.low), np.array(scene.high)
    middle, size = (low + high) / 2, float(max(1.0, *(high - low)))
    above = np.array([*middle, 1.6 * size])
    _camera(stage, "Top", _looking(above, np.array([*middle, 0.0]), np.array([0.0, 1.0, 0.0])), size)
    front = np.array([middle[0], low[1] - 0.35 * size, 0.75 * size])
    _camera(stage, "Overview", _looking(front, np.array([*middle, 0.0]), np.array([0.0, 0.0, 1.0])), size)


def _camera(stage: Any, name: str, pose: Floats, size: float) -> None:
    camera = UsdGeom.Camera.Define(stage, f"/World/Cameras/{name}")
    camera.CreateFocalLengthAttr(24.0)
    camera.CreateHorizontalApertureAttr(36.0)
    camera.CreateVerticalApertureAttr(27.0)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.01 * size, 100 * size))
    camera.AddTransformOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Matrix4d(*pose.T.ravel().tolist()))


def _looking(at: Floats, target: Floats, up: Floats) -> Floats:
    """(4, 4) pose of a camera, which looks along its -z with y up."""
    back = (at - target) / np.linalg.norm(at - target)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, np.cross(back, right), back, at
    return pose


class _Track:
    """Samples of one prim: one for each step, as interpolation would round; a value that never changes has one."""

    def __init__(self, layer: Any, mover: Mover, height: float = 0.0) -> None:
        self._layer, self._height = layer, height
        self._translate = f"{mover.path}.xformOp:translate"
        self._rotate = f"{mover.path}.xformOp:rotateZ"
        self._visibility = f"{mover.path}.visibility"
        self._yaw: float | None = None
        self._present: bool | None = None
        self._same: dict[str, tuple[Any, list[float]]] = {}
        self._changed: set[str] = set()

    def add(self, step: float, pose: Sequence[float]) -> None:
        """Add where the object is after a step; NaN while it is not in the world."""
        x, y, yaw = pose
        present = math.isfinite(x)
        if present != self._present:
            self._present = present
            self._layer.SetTimeSample(self._visibility, step, "inherited" if present else "invisible")
        if not present:
            return
        before = self._yaw
        self._yaw = yaw if before is None else before + float(wrap(yaw - before))
        self._sample(self._translate, step, (x, y))
        self._sample(self._rotate, step, self._yaw)

    def _sample(self, path: str, step: float, value: Any) -> None:
        if path not in self._changed:
            first, steps = self._same.setdefault(path, (value, []))
            if value == first:
                steps.append(step)
                if len(steps) > 1:
                    return
            else:
                self._changed.add(path)
                for earlier in self._same.pop(path)[1][1:]:
                    self._write(path, earlier, first)
        self._write(path, step, value)

    def _write(self, path: str, step: float, value: Any) -> None:
        is_place = path is self._translate
        written = Gf.Vec3d(*value, self._height) if is_place else math.degrees(value)
        self._layer.SetTimeSample(path, step, written)


def animate(stage: Any, movers: Iterable[Mover], states: Iterable[WorldState]) -> int:
    """Write time samples; one time code is one step.

    Args:
        stage: A stage with the prims of the movers.
        movers: The objects.
        states: States in the order of their steps.

    Returns:
        The number of states.
    """
    movers, layer = list(movers), stage.GetRootLayer()
    for mover in movers:
        UsdGeom.Imageable(stage.GetPrimAtPath(mover.path)).CreateVisibilityAttr()
    tracks = [_Track(layer, mover) for mover in movers]
    first = last = None
    count = 0
    with Sdf.ChangeBlock():
        for state in states:
            first = state.step if first is None else first
            last, count = state.step, count + 1
            poses = np.asarray(state.pose).tolist()
            for mover, track in zip(movers, tracks, strict=True):
                track.add(float(state.step), poses[mover.index])
    if first is not None and last is not None:
        stage.SetStartTimeCode(first)
        stage.SetEndTimeCode(last)
    return count
