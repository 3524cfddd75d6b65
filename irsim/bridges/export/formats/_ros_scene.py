"""What does not change in a run as ROS 2 messages: bodies as markers, the map as an occupancy grid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irsim.bridges.ros.markers import label_marker, part_marker, triangles_marker
from irsim.bridges.ros.messages import Messages
from irsim.graphics.scene.bodies import geometry_of
from irsim.graphics.scene.scene import Region
from irsim.simulation.scene import SceneDescription, SceneObject

__all__ = ["body_markers", "occupancy_grid"]

_MAX_ASPECT_ERROR = 1e-6
"""Share by which the sides of a cell may differ for it to count as square."""


def body_markers(messages: Messages, scene: SceneDescription, frames: Mapping[str, str], world: str) -> Any:
    """Markers of all bodies, each one marker, and the names of the robots.

    Args:
        messages: Makes the messages.
        scene: The scene at the start of the run.
        frames: Name of each object that moves -> its frame, which its marker follows.
        world: Frame of all other markers. Objects that move without a frame have no marker.

    Returns:
        A ``visualization_msgs/MarkerArray``.
    """
    markers = []
    for one in scene.agents:
        frame = frames.get(one.name)
        if frame is None and not one.static:
            continue
        place = (world, one.pose) if frame is None else (frame, (0.0, 0.0, 0.0))
        markers.append(_body(messages, one, *place))
        if one.role == "robot":
            markers.append(label_marker(messages, one.row, one.name, *place))
    return messages("visualization_msgs", "MarkerArray")(markers)


def occupancy_grid(messages: Messages, scene: SceneDescription, world: str) -> Any | None:
    """The map as a ``nav_msgs/OccupancyGrid``; None without a map, or if its cells are not square."""
    if scene.grid is None or scene.grid.levels is None:
        return None
    side, other = scene.grid.cell
    if abs(other / side - 1) > _MAX_ASPECT_ERROR:
        return None
    return messages.grid(0, world, side, scene.grid.origin, scene.grid.levels.astype(np.int8))


def _body(messages: Messages, one: SceneObject, frame: str, pose: Any) -> Any:
    """The marker of one body; several parts are united, so that none shows through another."""
    assert one.look is not None
    looks = one.look.color, one.look.alpha
    if len(one.parts) == 1:
        return part_marker(messages, one.row, one.parts[0], looks, frame, pose)
    region = geometry_of(one.parts)
    assert isinstance(region, Region)
    return triangles_marker(messages, one.row, region.rings, looks, frame, pose)
