"""From scenes and states to messages: what each topic of the table says after a step, and bodies as markers of RViz."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from irsim.bridges.ros.instruments import Instruments
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import (
    Mode,
    Topic,
    frame_of,
    laser_frame,
    nanoseconds,
    pedestrians,
    ros_names,
    sensor_frame,
)
from irsim.bridges.state import WorldState
from irsim.common.arrays import Floats
from irsim.common.outline import BodyPart, Circle, Polygon, triangles_of
from irsim.graphics.scene.bodies import area_of, geometry_of
from irsim.graphics.scene.scene import Region
from irsim.simulation.scene import Gauge, Lidar, SceneDescription, SceneObject

__all__ = ["Outgoing", "body_markers", "body_velocity"]

CYLINDER, LINE_STRIP, _TEXT, TRIANGLES = 3, 4, 9, 11
"""Types of ``visualization_msgs/Marker``."""
_DELETE_ALL = 3
"""Action of a marker after which RViz shows none of those before."""
HEIGHT_M = 0.02
"""Thickness of discs, which lie in the plane like all other bodies."""
LINE_WIDTH_M = 0.05
_TEXT_HEIGHT_M = 0.25
RGB = tuple[float, float, float]


def body_markers(
    messages: Messages,
    scene: SceneDescription,
    frames: Mapping[str, str],
    world: str,
    *,
    absent: Collection[str] = (),
    united: bool = False,
) -> Any:
    """Markers of all bodies that are there, and the names of the robots, in place of all markers before.

    Args:
        messages: Makes the messages.
        scene: The scene.
        frames: Name of each object that moves -> its frame, which its marker follows.
        world: Frame of all other markers.
        absent: Names of objects that are not in the world.
        united: Each body is one marker, so that none of its parts shows through another, numbered by its row and as
            opaque as it is drawn; objects that move without a frame are left out.

    Returns:
        A ``visualization_msgs/MarkerArray``.
    """
    clear = make_marker(messages, "", 0, CYLINDER, (0.0, 0.0, 0.0), 0.0, world, (0.0, 0.0, 0.0))
    clear.action = _DELETE_ALL
    markers: list[Any] = [clear]
    for agent in scene.agents:
        if agent.name in absent:
            continue
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
    marker.points = messages.points(triangles_of(area_of(Region(rings))).reshape(-1, 2))
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


_MAX_ASPECT_ERROR = 1e-6
"""Share by which the sides of a cell may differ for it to count as square."""


def body_velocity(twist: Floats, yaw: float) -> tuple[float, float, float]:
    """Forward and leftward speed [m/s] and yaw rate [rad/s] of a velocity (3,) in the world frame."""
    cosine, sine = math.cos(yaw), math.sin(yaw)
    x, y, rate = twist.tolist()
    return cosine * x + sine * y, cosine * y - sine * x, rate


class Outgoing:
    """Makes the messages of a scene.

    Args:
        messages: Makes messages from numbers.
        scene: The scene.
        topics: Topics of the scene; incoming ones are left out.
        frame: The fixed frame, in which irsim's coordinates are.
        mode: Whether irsim moves the robots.
    """

    def __init__(
        self,
        messages: Messages,
        scene: SceneDescription,
        topics: Sequence[Topic],
        frame: str,
        mode: Mode,
    ) -> None:
        self.messages, self.scene, self.frame, self.mode = messages, scene, frame, mode
        self._topics = [topic for topic in topics if topic.outgoing]
        self._names = dict(zip(scene.names, ros_names(scene.names), strict=True))
        self._row = {agent.name: agent.index for agent in scene.agents}
        self._lidars = {lidar.key: lidar for agent in scene.agents for lidar in agent.lidars}
        self._gauges = {gauge.key: gauge for agent in scene.agents for gauge in agent.gauges}
        self._instruments = Instruments(messages, frame, scene.step_time)
        self._movers = [agent for agent in scene.agents if agent.moves]
        self._paths: dict[str, Floats] = {}
        self._absent: frozenset[str] = frozenset()
        self._shown: dict[str, float] = {}  # when each sensor measured what was sent last [s]

    def frame_of(self, name: str) -> str:
        """Frame of an object."""
        return frame_of(self._names[name], self.mode)

    def once(self, stamp: int) -> Iterator[tuple[Topic, Any]]:
        """Messages about what does not change, for latched topics."""
        makers = {"tf_static": self._mounts, "map": self._map, "markers": self._markers, "pedestrian_ids": self._ids}
        for topic in self._topics:
            if topic.key in makers:
                message = makers[topic.key](stamp)
                if message is not None:
                    yield topic, message

    def step(self, state: WorldState, stamp: int | None = None) -> Iterator[tuple[Topic, Any]]:
        """Messages after a step.

        Args:
            state: The state.
            stamp: Time of the headers [ns]. Default: the simulated time.
        """
        simulated = nanoseconds(state.time)
        stamp = simulated if stamp is None else stamp
        absent = frozenset(agent.name for agent in self.scene.agents if np.isnan(state.pose[agent.index]).any())
        makers = {} if absent == self._absent else {"markers": self._markers, "pedestrian_ids": self._ids}
        self._absent = absent
        for topic in self._topics:
            if topic.key in makers:
                yield topic, makers[topic.key](stamp)
                continue
            message = self._message(topic, state, stamp, simulated)
            if message is not None:
                yield topic, message

    def _message(self, topic: Topic, state: WorldState, stamp: int, simulated: int) -> Any | None:
        make = self.messages
        if topic.key == "clock":
            return make("rosgraph_msgs", "Clock")(make.time(simulated))
        if topic.key == "tf":
            moved = [
                make.transform(stamp, self.frame, self.frame_of(agent.name), state.pose[agent.index].tolist())
                for agent in self._movers
                if agent.name not in self._absent
            ]
            return make("tf2_msgs", "TFMessage")(moved)
        if topic.key == "pedestrians":
            walkers = [agent.index for agent in self._present_pedestrians()]
            return make.pose_array(stamp, self.frame, state.pose[walkers].tolist())
        if topic.robot in self._absent:
            return None
        sensor = topic.gauge or (topic.lidar if topic.key == "scan" else None)
        if sensor is not None:
            time = state.stamps.get(sensor, state.time)
            if math.isnan(time) or self._shown.get(sensor) == time:
                return None
            self._shown[sensor] = time
            stamp -= simulated - nanoseconds(time)
        if topic.lidar is not None and topic.key == "scan":
            return self._scan(self._lidars[topic.lidar], topic, state, stamp)
        if topic.robot is None:
            return None
        if topic.gauge is not None:
            return self._reading(self._gauges[topic.gauge], topic.robot, state, stamp)
        pose = state.pose[self._row[topic.robot]]
        if topic.key == "reference_path":
            return self._path(topic.robot, state, stamp)
        if topic.key == "pose":
            return make.stamped_pose(stamp, self.frame, pose.tolist())
        if topic.key == "odom":
            velocity = body_velocity(state.twist[self._row[topic.robot]], float(pose[2]))
            return make.odometry(stamp, self.frame, self.frame_of(topic.robot), pose.tolist(), velocity)
        return None

    def _scan(self, lidar: Lidar, topic: Topic, state: WorldState, stamp: int) -> Any | None:
        ranges = state.ranges.get(lidar.key)
        if ranges is None or topic.robot is None:
            return None
        spread = lidar.angle_max - lidar.angle_min
        angles = (lidar.angle_min, lidar.angle_max, spread / (lidar.beams - 1) if lidar.beams > 1 else 0.0)
        frame = laser_frame(self._names[topic.robot], lidar.number)
        limits = (lidar.range_min, lidar.range_max)
        measured = np.asarray(ranges, dtype=np.float32)
        return self.messages.scan(stamp, frame, angles, limits, lidar.period, measured, lidar.beam_time)

    def _reading(self, gauge: Gauge, robot: str, state: WorldState, stamp: int) -> Any | None:
        reading = state.readings.get(gauge.key)
        if reading is None:
            return None
        frame = sensor_frame(self._names[robot], gauge.name, gauge.number)
        return self._instruments.message(gauge, reading, stamp, frame, self.frame_of(robot))

    def _path(self, robot: str, state: WorldState, stamp: int) -> Any | None:
        """The path of a robot whenever it is another one than before."""
        path = state.paths.get(robot)
        before = self._paths.get(robot)
        if path is None or (before is not None and np.array_equal(path, before, equal_nan=True)):
            return None
        self._paths[robot] = path.copy()
        return self.messages.path(stamp, self.frame, _with_headings(path).tolist())

    def _mounts(self, stamp: int) -> Any | None:
        make = self.messages
        mounts = [
            make.transform(stamp, self.frame_of(agent.name), laser_frame(self._names[agent.name], lidar.number),
                           lidar.mount)
            for agent in self.scene.agents
            for lidar in agent.lidars
        ]  # fmt: skip
        for agent in self.scene.agents:
            name, body = self._names[agent.name], self.frame_of(agent.name)
            frames = [(sensor_frame(name, one.name, one.number), one.mount) for one in agent.gauges]
            mounts += [make.transform(stamp, body, frame, mount) for frame, mount in frames]
        return make("tf2_msgs", "TFMessage")(mounts) if mounts else None

    def _map(self, stamp: int) -> Any | None:
        """The map; of a scene without one, nothing, and of one whose cells are not square, nothing either."""
        grid = self.scene.grid
        if grid is None or abs(grid.cell[1] / grid.cell[0] - 1) > _MAX_ASPECT_ERROR:
            return None
        levels = np.where(grid.occupied, 100, np.where(grid.unknown, -1, 0)).astype(np.int8)
        return self.messages.grid(stamp, self.frame, grid.cell[0], grid.origin, levels)

    def _markers(self, stamp: int) -> Any:
        frames = {agent.name: self.frame_of(agent.name) for agent in self._movers}
        return body_markers(self.messages, self.scene, frames, self.frame, absent=self._absent)

    def _ids(self, stamp: int) -> Any:
        names = [agent.name for agent in self._present_pedestrians()]
        return self.messages("std_msgs", "String")(json.dumps(names))

    def _present_pedestrians(self) -> list[SceneObject]:
        return [agent for agent in pedestrians(self.scene) if agent.name not in self._absent]


def _with_headings(path: Floats) -> Floats:
    """(K, 3) a path with headings: its own, or along it."""
    if path.shape[1] > 2:
        return np.nan_to_num(path[:, :3])
    if len(path) < 2:
        return np.column_stack([path, np.zeros(len(path))])
    steps = np.diff(path, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    return np.column_stack([path, np.append(headings, headings[-1])])
