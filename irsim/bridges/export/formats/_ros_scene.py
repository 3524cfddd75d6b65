"""What does not change in a run as ROS 2 messages: bodies as markers, the map as an occupancy grid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.bridges.ros.markers import circle_marker, label_marker, line_marker, triangles_marker
from irsim.bridges.ros.messages import Messages
from irsim.common.arrays import Floats
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.objects.views import views
from irsim.runs.replay.drawing import page_objects

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["body_markers", "occupancy_grid"]

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
            markers.append(label_marker(messages, number, record.name, *place))
    return messages("visualization_msgs", "MarkerArray")(markers)


def occupancy_grid(messages: Messages, env: Env, world: str) -> Any | None:
    """The map as a ``nav_msgs/OccupancyGrid``; None without a map, or if its cells are not square."""
    builder = SceneBuilder(env.simulation)
    for view in views(env.simulation):
        if not view.record.is_map:
            continue
        grid = builder.grid(view)
        columns, rows = grid.levels.shape
        x, x_end, y, y_end = grid.extent
        side = (x_end - x) / columns
        if abs((y_end - y) / rows / side - 1) > _MAX_ASPECT_ERROR:
            return None
        return messages.grid(0, world, side, (x, y), grid.levels.astype(np.int8))
    return None


def _body(
    messages: Messages, number: int, drawn: Mapping[str, Any], shape: Mapping[str, Any], frame: str, pose: Any
) -> Any:
    """The marker of one body."""
    color = drawn["color"]
    red, green, blue = (int(color[at : at + 2], 16) / 255 for at in (1, 3, 5))
    looks = ((red, green, blue), drawn["alpha"])
    if "circle" in shape:
        x, y, radius = shape["circle"]
        return circle_marker(messages, number, (x, y), radius, looks, frame, pose)
    if "rings" in shape:
        return triangles_marker(messages, number, [_rows(ring) for ring in shape["rings"]], looks, frame, pose)
    return line_marker(messages, number, _rows(shape["line"]), looks, frame, pose)


def _rows(flat: list[float]) -> Floats:
    return np.array(flat, dtype=np.float64).reshape(-1, 2)
