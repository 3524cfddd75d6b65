"""From states to messages: what each topic of the table says after a step."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from irsim.bridges.ros.markers import body_markers
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.topics import (
    Mode,
    Topic,
    frame_of,
    laser_frame,
    nanoseconds,
    pedestrian_names,
    pedestrians,
    ros_names,
)
from irsim.bridges.state import WorldState
from irsim.common.arrays import Floats
from irsim.simulation.scene import Lidar, SceneDescription

__all__ = ["Outgoing", "body_velocity"]

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
        self, messages: Messages, scene: SceneDescription, topics: Sequence[Topic], frame: str, mode: Mode
    ) -> None:
        self.messages, self.scene, self.frame, self.mode = messages, scene, frame, mode
        self._topics = [topic for topic in topics if topic.outgoing]
        self._names = dict(zip(scene.names, ros_names(scene.names), strict=True))
        self._row = {agent.name: agent.index for agent in scene.agents}
        self._lidars = {lidar.key: lidar for agent in scene.agents for lidar in agent.lidars}
        self._walkers = [agent.index for agent in pedestrians(scene)]
        self._movers = [agent for agent in scene.agents if agent.moves]
        self._paths: dict[str, Floats] = {}

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
        for topic in self._topics:
            message = self._message(topic, state, stamp, simulated)
            if message is not None:
                yield topic, message

    def _message(self, topic: Topic, state: WorldState, stamp: int, simulated: int) -> Any | None:
        make = self.messages
        if topic.key == "clock":
            return make("rosgraph_msgs", "Clock")(make.time(simulated))
        if topic.key == "tf":
            placed = [(self.frame_of(agent.name), state.pose[agent.index]) for agent in self._movers]
            moved = [
                make.transform(stamp, self.frame, child, pose.tolist())
                for child, pose in placed
                if np.isfinite(pose).all()
            ]
            return make("tf2_msgs", "TFMessage")(moved)
        if topic.key == "pedestrians":
            return make.pose_array(stamp, self.frame, state.pose[self._walkers].tolist())
        if topic.lidar is not None and topic.key == "scan":
            return self._scan(self._lidars[topic.lidar], topic, state, stamp)
        if topic.robot is None:
            return None
        pose = state.pose[self._row[topic.robot]]
        if topic.key == "reference_path":
            return self._path(topic.robot, state, stamp)
        if not np.isfinite(pose).all():
            return None
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
        return self.messages.scan(stamp, frame, angles, limits, lidar.period, np.asarray(ranges, dtype=np.float32))

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
        return make("tf2_msgs", "TFMessage")(mounts) if mounts else None

    def _map(self, stamp: int) -> Any | None:
        """The map; of a scene without one, nothing, and of one whose cells are not square, nothing either."""
        grid = self.scene.grid
        if grid is None or abs(grid.cell[1] / grid.cell[0] - 1) > _MAX_ASPECT_ERROR:
            return None
        levels = np.where(grid.occupied, 100, 0).astype(np.int8)
        return self.messages.grid(stamp, self.frame, grid.cell[0], grid.origin, levels)

    def _markers(self, stamp: int) -> Any:
        frames = {agent.name: self.frame_of(agent.name) for agent in self._movers}
        return body_markers(self.messages, self.scene, frames, self.frame)

    def _ids(self, stamp: int) -> Any:
        return self.messages("std_msgs", "String")(pedestrian_names(self.scene))


def _with_headings(path: Floats) -> Floats:
    """(K, 3) a path with headings: its own, or along it."""
    if path.shape[1] > 2:
        return np.nan_to_num(path[:, :3])
    if len(path) < 2:
        return np.column_stack([path, np.zeros(len(path))])
    steps = np.diff(path, axis=0)
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    return np.column_stack([path, np.append(headings, headings[-1])])
