"""A recorded run as ROS 2 messages, which formats write to their files."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.bridges.export.episode import Block, ExportedEpisode
from irsim.bridges.ros.instruments import Instruments
from irsim.bridges.ros.messages import Messages
from irsim.bridges.ros.outgoing import body_markers
from irsim.bridges.ros.topics import TABLE, nanoseconds, numbered, ros_names, sensor_frame
from irsim.common.arrays import Floats
from irsim.objects.describe import describe_scene
from irsim.runs.resimulation import initial_scene
from irsim.simulation.events import BETWEEN_STEPS, Event
from irsim.simulation.scene import Gauge, SceneDescription
from irsim.simulation.trace import Trace

__all__ = ["Bag", "occupancy_grid", "write_run"]

_MAX_ASPECT_ERROR = 1e-6
"""Share by which the sides of a cell may differ for it to count as square."""
_WORLD = "world"
_INFO, _WARN = 20, 30
"""Severities of ``rcl_interfaces/Log``."""
Topic: TypeAlias = tuple[Any, str]
Flags: TypeAlias = NDArray[np.bool_]


class Bag(Protocol):
    """A file of messages."""

    def topic(self, name: str, kind: str, *, latched: bool = False, **about: str) -> Topic:
        """Add a topic of messages of a type, and say what :meth:`add` takes."""

    def add(self, topic: Topic, stamp: int, message: Any) -> None:
        """Add a message at a simulated time [ns]."""

    def describe(self, facts: dict[str, str], files: dict[str, bytes]) -> None:
        """Add facts and files."""


def write_run(episode: ExportedEpisode, bag: Bag, messages: Messages) -> list[str]:
    """Write the messages of a run in the order of their stamps; returns notes on what was left out."""
    notes = []
    facts = episode.facts
    text = facts.pop("scenario_text")
    plain = {key: value if isinstance(value, str) else json.dumps(value) for key, value in facts.items()}
    bag.describe(plain, {"scenario.yaml": text.encode()})
    writer = _Writer(episode, bag, messages)
    if not writer.add_scene():
        notes.append("the map was left out: its cells are not square")
    writer.add_mounts()
    goal: Floats | None = None
    for block in episode.blocks():
        changed = _goal_changes(block.trace.goal, goal)
        goal = block.trace.goal[-1:].copy()
        writer.add_block(block, changed)
    if (episode.lidars or episode.gauges) and episode.last_scan < episode.last_step:
        notes.append(f"scans end at step {episode.last_scan} of {episode.last_step}, as they do in the record")
    return notes


class _Writer:
    """Topics and frames of a run; actors and lidars in their order, None for obstacles."""

    def __init__(self, episode: ExportedEpisode, bag: Bag, messages: Messages) -> None:
        self.episode, self.bag, self.messages = episode, bag, messages
        with initial_scene(episode.run, episode.limits) as env:
            self.scene = describe_scene(env.simulation)
        self.events = deque(episode.run.events)
        names = ros_names(actor.name for actor in episode.actors)
        self.frames = [f"{name}/base_link" for name in names]
        self.clock = bag.topic("/clock", "rosgraph_msgs/msg/Clock")
        self.tf = bag.topic("/tf", "tf2_msgs/msg/TFMessage")
        self.log = bag.topic("/rosout", "rcl_interfaces/msg/Log")
        obstacles = [actor.name for actor in episode.actors if actor.role == "obstacle"]
        self.obstacles: Topic | None = None
        if obstacles:
            self.obstacles = bag.topic("/obstacles", "geometry_msgs/msg/PoseArray", names=json.dumps(obstacles))
            self.obstacle_ids = bag.topic("/obstacles/ids", "std_msgs/msg/String", latched=True)
        self.markers = bag.topic("/markers", "visualization_msgs/msg/MarkerArray", latched=True)
        self.absent: frozenset[int] | None = None
        self.odometry = self._robot_topics(names, "odom", "nav_msgs/msg/Odometry")
        self.goals = self._robot_topics(names, "goal", "geometry_msgs/msg/PoseStamped")
        mounted = [(names[lidar.actor], f"_{lidar.number}" if lidar.number else "") for lidar in episode.lidars]
        self.laser_frames = [f"{owner}/laser{end}" for owner, end in mounted]
        self.instruments = Instruments(messages, _WORLD, self.scene.step_time)
        self.measured = dict[str, int]()  # step in which each sensor measured what was added last
        self.gauges = self._gauges(names)
        self.scans = [bag.topic(f"/{owner}/scan{end}", "sensor_msgs/msg/LaserScan") for owner, end in mounted]

    def _gauges(self, names: Sequence[str]) -> list[tuple[int, Gauge, str, Topic]]:
        """Actor, sensor, frame and topic of each sensor that a message is for."""
        gauges, rows = [], [row for row in TABLE.values() if row.per == "sensor"]
        for number, (name, actor) in enumerate(zip(names, self.episode.actors, strict=True)):
            for gauge in self.scene.objects[actor.index].gauges:
                for row in rows:
                    if row.sensor == gauge.name:
                        called = row.name.replace("{robot}", name).replace("{n}", numbered(gauge.number))
                        frame = sensor_frame(name, gauge.name, gauge.number)
                        gauges.append((number, gauge, frame, self.bag.topic(called, row.kind)))
        return gauges

    def _robot_topics(self, names: Sequence[str], topic: str, kind: str) -> list[Topic | None]:
        pairs = zip(names, self.episode.actors, strict=True)
        return [self.bag.topic(f"/{name}/{topic}", kind) if actor.role == "robot" else None for name, actor in pairs]

    def add_scene(self) -> bool:
        """Add the map; whether the map, if there is one, could be added."""
        bag, scene = self.bag, self.scene
        grid = occupancy_grid(self.messages, scene, _WORLD)
        if grid is not None:
            bag.add(bag.topic("/map", "nav_msgs/msg/OccupancyGrid", latched=True), 0, grid)
        return grid is not None or scene.grid is None

    def add_mounts(self) -> None:
        """Add where the sensors are on their robots."""
        mounts = [
            self.messages.transform(0, self.frames[lidar.actor], frame, [float(v) for v in lidar.options["offset"]])
            for lidar, frame in zip(self.episode.lidars, self.laser_frames, strict=True)
        ]
        mounts += [
            self.messages.transform(0, self.frames[number], frame, gauge.mount)
            for number, gauge, frame, _ in self.gauges
        ]
        if mounts:
            topic = self.bag.topic("/tf_static", "tf2_msgs/msg/TFMessage", latched=True)
            self.bag.add(topic, 0, self.messages("tf2_msgs", "TFMessage")(mounts))

    def add_block(self, block: Block, changed: Flags) -> None:
        """Add what happened in some steps, one step after the other; ``changed`` (T, M) says which goals are new."""
        trace, bag, messages = block.trace, self.bag, self.messages
        clock, transforms = messages("rosgraph_msgs", "Clock"), messages("tf2_msgs", "TFMessage")
        array = messages("geometry_msgs", "PoseArray")
        robots = [(number, topic) for number, topic in enumerate(self.odometry) if topic is not None]
        others = [number for number, topic in enumerate(self.odometry) if topic is None]
        columns = trace.step, trace.time, trace.pose, block.body_velocity
        for row, (step, time, poses, velocities) in enumerate(zip(*(c.tolist() for c in columns), strict=True)):
            stamp = nanoseconds(time)
            bag.add(self.clock, stamp, clock(messages.time(stamp)))
            absent = frozenset(np.flatnonzero(~np.isfinite(trace.pose[row]).all(axis=1)).tolist())
            if absent != self.absent:
                self._add_bodies(absent, stamp)
            moved = [(self.frames[number], pose) for number, pose in enumerate(poses) if number not in absent]
            bag.add(self.tf, stamp, transforms([messages.transform(stamp, _WORLD, *placed) for placed in moved]))
            for number, topic in robots:
                if number in absent:
                    continue
                frame = self.frames[number]
                bag.add(topic, stamp, messages.odometry(stamp, _WORLD, frame, poses[number], velocities[number]))
            if self.obstacles is not None:
                placed = [messages.pose(*poses[number]) for number in others if number not in absent]
                bag.add(self.obstacles, stamp, array(messages.header(stamp, _WORLD), placed))
            for number in np.flatnonzero(changed[row]).tolist():
                self._add_goal(self.goals[number], stamp, trace.goal[row, number].tolist())
            self._add_scans(trace, row, stamp, absent)
            self._add_readings(trace, row, stamp, absent)
            while self.events and self.events[0].step <= step:
                bag.add(self.log, stamp, _log(messages, stamp, self.events.popleft()))

    def _add_bodies(self, absent: frozenset[int], stamp: int) -> None:
        """Add the markers of who is there from now on, and the names of the obstacles among them."""
        self.absent, actors = absent, self.episode.actors
        gone = {actors[number].name for number in absent}
        follows = {actor.name: frame for actor, frame in zip(actors, self.frames, strict=True)}
        markers = body_markers(self.messages, self.scene, follows, _WORLD, absent=gone, united=True)
        self.bag.add(self.markers, stamp, markers)
        if self.obstacles is not None:
            names = [actor.name for actor in actors if actor.role == "obstacle" and actor.name not in gone]
            self.bag.add(self.obstacle_ids, stamp, self.messages("std_msgs", "String")(json.dumps(names)))

    def _add_scans(self, trace: Trace, row: int, stamp: int, absent: frozenset[int]) -> None:
        """Add the scans of one step, as far as scans were recorded and their robots are there."""
        for lidar, topic, frame in zip(self.episode.lidars, self.scans, self.laser_frames, strict=True):
            ranges = trace.ranges[lidar.key]
            measured = self._measured(lidar.key, lidar.options, int(trace.step[row]))
            if row < len(ranges) and lidar.actor not in absent and measured is not None:
                duration = float(lidar.options["scan_time"])
                mounted = self.scene.objects[self.episode.actors[lidar.actor].index].lidars[lidar.number]
                shape = lidar.angles, lidar.limits, duration
                scan = self.messages.scan(measured, frame, *shape, ranges[row], mounted.beam_time)
                self.bag.add(topic, stamp, scan)

    def _add_readings(self, trace: Trace, row: int, stamp: int, absent: frozenset[int]) -> None:
        """Add what other sensors report in one step."""
        for number, gauge, frame, topic in self.gauges:
            readings = trace.readings.get(gauge.key, ())
            measured = self._measured(gauge.key, gauge.settings, int(trace.step[row]))
            if row < len(readings) and number not in absent and measured is not None:
                message = self.instruments.message(gauge, readings[row], measured, frame, self.frames[number])
                self.bag.add(topic, stamp, message)

    def _measured(self, key: str, options: Mapping[str, Any], step: int) -> int | None:
        """When a sensor measured what it shows after a step [ns]; None before the first data, and for old ones."""
        step_time = self.scene.step_time
        timing = core.SensorTiming(rate=options.get("rate") or 0.0, latency=options.get("latency") or 0.0)
        shown = core.shown_step(timing, step_time, step)
        if shown < 0 or self.measured.get(key) == shown:
            return None
        self.measured[key] = shown
        return nanoseconds(shown * step_time)

    def _add_goal(self, topic: Topic | None, stamp: int, goal: list[float]) -> None:
        """Add a goal, if the object is a robot and has one."""
        x, y, heading = goal
        if topic is not None and x == x:
            pose = x, y, heading if heading == heading else 0.0
            self.bag.add(topic, stamp, self.messages.stamped_pose(stamp, _WORLD, pose))


def _goal_changes(goal: Floats, previous: Floats | None) -> Flags:
    """(T, M) whether a goal is another one than in the row before; True in the first row of a run."""
    before = np.concatenate([np.full_like(goal[:1], np.inf) if previous is None else previous, goal[:-1]])
    same = (goal == before) | (np.isnan(goal) & np.isnan(before))
    return np.asarray(~same.all(axis=2))


def _log(messages: Messages, stamp: int, event: Event) -> Any:
    """An event as a log message."""
    partner = "" if event.partner is None else f" with {event.partner}"
    zone = "" if event.zone is None else f" of {event.zone}"
    way = "" if event.direction is None else f" {event.direction.replace('_', ' ')}"
    text = f"{event.kind}{partner}{zone}{way} at x {event.x:.3f} y {event.y:.3f}"
    level = _WARN if event.kind in ("collision", "no_path", *BETWEEN_STEPS) else _INFO
    return messages("rcl_interfaces", "Log")(messages.time(stamp), level, event.object, text, "", "", 0)


def occupancy_grid(messages: Messages, scene: SceneDescription, world: str) -> Any | None:
    """The map as a ``nav_msgs/OccupancyGrid``; None without a map, or if its cells are not square."""
    if scene.grid is None or scene.grid.levels is None:
        return None
    side, other = scene.grid.cell
    if abs(other / side - 1) > _MAX_ASPECT_ERROR:
        return None
    return messages.grid(0, world, side, scene.grid.origin, scene.grid.levels.astype(np.int8))
