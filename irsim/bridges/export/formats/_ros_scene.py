"""What does not change in a run as ROS 2 messages: bodies as markers, the map as an occupancy grid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.bridges.export.formats._ros_messages import Messages
from irsim.common.arrays import Floats
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.objects.views import views
from irsim.runs.replay.drawing import page_objects

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["body_markers", "occupancy_grid"]

_CYLINDER, _LINE_STRIP, _TEXT, _TRIANGLES = 3, 4, 9, 11
"""Types of ``visualization_msgs/Marker``."""
_HEIGHT_M = 0.02
"""Thickness of discs, which lie in the plane like all other bodies."""
_LINE_WIDTH_M = 0.05
_TEXT_HEIGHT_M = 0.25
_MAX_ASPECT_ERROR = 1e-6
"""Share by which the sides of a cell may differ for it to count as square."""


def body_markers(messages: Messages, env: Env, frames: Mapping[str, str], world: str) -> Any:
    """Markers of all bodies, and the names of the robots.

    Args:
        messages: Makes the messages.
        env: The environment at the start of the run.
        frames: Name of each object that moves -> its frame, which its marker follows.
        world: Frame of all other markers. Objects that move without a frame have no marker.

    Returns:
        A ``visualization_msgs/MarkerArray``.
    """
    shapes, objects, _ = page_objects(env)
    records = env.simulation.scenario.objects
    markers = []
    for number, (drawn, record) in enumerate(zip(objects, records, strict=True)):
        frame = frames.get(record.name)
        if drawn["shape"] < 0 or (frame is None and not record.static):
            continue
        place = (frame, (0.0, 0.0, 0.0)) if frame is not None else (world, drawn["pose"])
        markers.append(_body(messages, number, drawn, shapes[drawn["shape"]], *place))
        if record.role == "robot":
            label = _marker(messages, "names", number, _TEXT, "#000000", 1.0, *place)
            label.scale.z, label.text, label.pose.position.z = _TEXT_HEIGHT_M, record.name, 2 * _TEXT_HEIGHT_M
            markers.append(label)
    return messages("visualization_msgs", "MarkerArray")(markers)


def occupancy_grid(messages: Messages, env: Env, world: str) -> Any | None:
    """The map as a ``nav_msgs/OccupancyGrid``; None without a map, or if its cells are not square."""
    builder = SceneBuilder(env.simulation)
    for view in views(env.simulation):
        if view.shape != "map":
            continue
        grid = builder.grid(view)
        columns, rows = grid.levels.shape
        x, x_end, y, y_end = grid.extent
        side = (x_end - x) / columns
        if abs((y_end - y) / rows / side - 1) > _MAX_ASPECT_ERROR:
            return None
        info = messages("nav_msgs", "MapMetaData")(messages.time(0), side, columns, rows, messages.pose(x, y, 0.0))
        return messages("nav_msgs", "OccupancyGrid")(
            messages.header(0, world), info, grid.levels.T.astype(np.int8).ravel()
        )
    return None


def _body(
    messages: Messages, number: int, drawn: Mapping[str, Any], shape: Mapping[str, Any], frame: str, pose: Any
) -> Any:
    """The marker of one body."""
    looks = (drawn["color"], drawn["alpha"])
    if "circle" in shape:
        x, y, radius = shape["circle"]
        cosine, sine = np.cos(pose[2]), np.sin(pose[2])
        centre = (pose[0] + cosine * x - sine * y, pose[1] + sine * x + cosine * y, pose[2])
        marker = _marker(messages, "bodies", number, _CYLINDER, *looks, frame, centre)
        marker.scale.x = marker.scale.y = 2 * radius
        marker.scale.z = _HEIGHT_M
        return marker
    if "rings" in shape:
        marker = _marker(messages, "bodies", number, _TRIANGLES, *looks, frame, pose)
        marker.scale.x = marker.scale.y = marker.scale.z = 1.0
        marker.points = messages.points(_triangles([_rows(ring) for ring in shape["rings"]]))
        return marker
    marker = _marker(messages, "bodies", number, _LINE_STRIP, *looks, frame, pose)
    marker.scale.x = _LINE_WIDTH_M
    marker.points = messages.points(_rows(shape["line"]))
    return marker


def _marker(
    messages: Messages, space: str, number: int, kind: int, color: str, alpha: float, frame: str, pose: Any
) -> Any:
    """A marker that follows its frame and never expires; its scale and content are set by the caller."""
    red, green, blue = (int(color[at : at + 2], 16) / 255 for at in (1, 3, 5))
    return messages("visualization_msgs", "Marker")(
        header=messages.header(0, frame),
        ns=space,
        id=number,
        type=kind,
        action=0,
        pose=messages.pose(*pose),
        scale=messages.vector(0.0, 0.0, 0.0),
        color=messages("std_msgs", "ColorRGBA")(red, green, blue, alpha),
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


def _rows(flat: list[float]) -> Floats:
    return np.array(flat, dtype=np.float64).reshape(-1, 2)


def _triangles(rings: list[Floats]) -> Floats:
    """(3 K, 2) corners of K triangles that fill a region, whose outlines run counter-clockwise and holes clockwise."""
    import shapely

    areas = [shapely.Polygon(ring) for ring in rings]
    outlines = [area for area in areas if area.exterior.is_ccw]
    holes = [area for area in areas if not area.exterior.is_ccw]
    region = shapely.union_all(outlines).difference(shapely.union_all(holes))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
    return np.concatenate([shapely.get_coordinates(triangle)[:3] for triangle in triangles])
