"""Bodies of a scene as markers of RViz."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import shapely

from irsim.bridges.ros.messages import Messages
from irsim.common.arrays import Floats
from irsim.common.outline import BodyPart, Circle, Polygon
from irsim.graphics.scene.bodies import geometry_of
from irsim.graphics.scene.scene import Region
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = ["body_markers"]

CYLINDER, LINE_STRIP, _TEXT, TRIANGLES = 3, 4, 9, 11
"""Types of ``visualization_msgs/Marker``."""
HEIGHT_M = 0.02
"""Thickness of discs, which lie in the plane like all other bodies."""
LINE_WIDTH_M = 0.05
_TEXT_HEIGHT_M = 0.25
RGB = tuple[float, float, float]


def body_markers(
    messages: Messages, scene: SceneDescription, frames: Mapping[str, str], world: str, *, united: bool = False
) -> Any:
    """Markers of all bodies, and the names of the robots.

    Args:
        messages: Makes the messages.
        scene: The scene.
        frames: Name of each object that moves -> its frame, which its marker follows.
        world: Frame of all other markers.
        united: Each body is one marker, so that none of its parts shows through another, numbered by its row and as
            opaque as it is drawn; objects that move without a frame are left out.

    Returns:
        A ``visualization_msgs/MarkerArray``.
    """
    markers: list[Any] = []
    for agent in scene.agents:
        frame = frames.get(agent.name)
        if united and frame is None and not agent.static:
            continue
        place = (world, agent.pose) if frame is None else (frame, (0.0, 0.0, 0.0))
        if united:
            markers.append(_united_marker(messages, agent, *place))
        else:
            looks = agent.color, 1.0
            for part in agent.parts:
                markers.append(part_marker(messages, len(markers), part, looks, *place))
        if agent.role == "robot":
            markers.append(label_marker(messages, agent.row if united else agent.index, agent.name, *place))
    return messages("visualization_msgs", "MarkerArray")(markers)


def _united_marker(messages: Messages, agent: SceneObject, frame: str, pose: Any) -> Any:
    assert agent.look is not None
    looks = agent.look.color, agent.look.alpha
    if len(agent.parts) == 1:
        return part_marker(messages, agent.row, agent.parts[0], looks, frame, pose)
    region = geometry_of(agent.parts)
    assert isinstance(region, Region)
    return triangles_marker(messages, agent.row, region.rings, looks, frame, pose)


def label_marker(messages: Messages, number: int, text: str, frame: str, pose: Any) -> Any:
    """The name of a robot above it."""
    label = make_marker(messages, "names", number, _TEXT, (0.0, 0.0, 0.0), 1.0, frame, pose)
    label.scale.z, label.text, label.pose.position.z = _TEXT_HEIGHT_M, text, 2 * _TEXT_HEIGHT_M
    return label


def make_marker(
    messages: Messages, space: str, number: int, kind: int, color: RGB, alpha: float, frame: str, pose: Any
) -> Any:
    """A marker that follows its frame and never expires; its scale and content are set by the caller."""
    return messages("visualization_msgs", "Marker")(
        header=messages.header(0, frame),
        ns=space,
        id=number,
        type=kind,
        action=0,
        pose=messages.pose(*pose),
        scale=messages.vector(0.0, 0.0, 0.0),
        color=messages("std_msgs", "ColorRGBA")(*color, alpha),
        lifetime=messages("builtin_interfaces", "Duration")(0, 0),
        frame_locked=True,
        points=[],
        colors=[],
        texture_resource="",
        texture=messages("sensor_msgs", "CompressedImage")(messages.header(0, ""), "", np.zeros(0, dtype=np.uint8)),
        uv_coordinates=[],
        text="",
        mesh_resource="",
        mesh_file=messages("visualization_msgs", "MeshFile")("", np.zeros(0, dtype=np.uint8)),
        mesh_use_embedded_materials=False,
    )


def triangles_marker(
    messages: Messages, number: int, rings: list[Floats], looks: tuple[RGB, float], frame: str, pose: Any
) -> Any:
    """A region that is filled with triangles."""
    marker = make_marker(messages, "bodies", number, TRIANGLES, *looks, frame, pose)
    marker.scale.x = marker.scale.y = marker.scale.z = 1.0
    marker.points = messages.points(triangles(rings))
    return marker


def part_marker(
    messages: Messages, number: int, part: BodyPart, looks: tuple[RGB, float], frame: str, pose: Any
) -> Any:
    """The marker of a part of a body: a flat cylinder, triangles, or a polyline."""
    if isinstance(part, Polygon):
        return triangles_marker(messages, number, [part.corners], looks, frame, pose)
    if isinstance(part, Circle):
        cosine, sine = np.cos(pose[2]), np.sin(pose[2])
        x, y = part.center  # in the frame of the body
        placed = (pose[0] + cosine * x - sine * y, pose[1] + sine * x + cosine * y, pose[2])
        marker = make_marker(messages, "bodies", number, CYLINDER, *looks, frame, placed)
        marker.scale.x = marker.scale.y = 2 * part.radius
        marker.scale.z = HEIGHT_M
        return marker
    marker = make_marker(messages, "bodies", number, LINE_STRIP, *looks, frame, pose)
    marker.scale.x, marker.points = LINE_WIDTH_M, messages.points(part.path)
    return marker


def triangles(rings: list[Floats]) -> Floats:
    """(3 K, 2) corners of K triangles that fill a region, whose outlines run counter-clockwise and holes clockwise."""
    areas = [shapely.Polygon(ring) for ring in rings]
    outlines = [area for area in areas if area.exterior.is_ccw]
    holes = [area for area in areas if not area.exterior.is_ccw]
    region = shapely.union_all(outlines).difference(shapely.union_all(holes))
    parts = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
    return np.concatenate([shapely.get_coordinates(triangle)[:3] for triangle in parts])
